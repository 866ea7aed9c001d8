#include "robomill/io/records/text/text_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/text/maker_text.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

/// The number behind a word of a header's line, where the line has that word; in lower case.
std::optional<double> number_behind(std::string_view line, std::string_view word, std::string_view& unit) {
  const std::size_t at = line.find(word);
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; };
  if (at == std::string_view::npos || (at > 0 && is_letter(line[at - 1]))) return std::nullopt;
  std::string_view rest = line.substr(at + word.size());
  if (!rest.empty() && is_letter(rest.front())) return std::nullopt;
  const auto skip_blanks = [&] { rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r:=;,\""), rest.size())); };
  skip_blanks();
  unit = {};
  if (!rest.empty() && (rest.front() == '[' || rest.front() == '(')) {  // "sample rate [kHz]: 25.6"
    const std::size_t close = rest.find_first_of("])");
    if (close == std::string_view::npos) return std::nullopt;
    unit = trimmed(rest.substr(1, close - 1));
    rest.remove_prefix(close + 1);
    skip_blanks();
  }
  const std::size_t end = std::min(rest.find_first_not_of("0123456789.,e+-"), rest.size());
  const std::string_view number = rest.substr(0, end);
  // "51,200" is 51200 to some and 51.2 to others.
  if (number.empty() || (number.find(',') != std::string_view::npos && number.size() - number.find(',') == 4)) {
    return std::nullopt;
  }
  const std::string_view behind = trimmed(rest.substr(end));
  if (unit.empty()) unit = behind.substr(0, std::min(behind.find_first_of(" \t;,)]"), behind.size()));
  return parse_cell(number);
}

/// The rate that the lines above the numbers state; 0: none.
double stated_rate_hz(std::string_view content) {
  constexpr int most_lines = 100;
  constexpr std::string_view rates[] = {
      "sample rate",        "sampling rate",    "sample_rate_hz", "sample_rate",    "samplerate", "sampling frequency",
      "sampling_frequency", "sample frequency", "abtastrate",     "abtastfrequenz", "fs"};
  constexpr std::string_view steps[] = {"delta_x",           "delta x",   "delta_t",       "sample interval",
                                        "sampling interval", "time step", "time interval", "dt"};
  for (int i = 0; i < most_lines && !content.empty(); ++i) {
    const std::string line = lowered(content.substr(0, content.find('\n')));
    content.remove_prefix(std::min(line.size() + 1, content.size()));
    std::string_view unit;
    for (const std::string_view word : rates) {
      const std::optional<double> value = number_behind(line, word, unit);
      if (value && *value > 0.0) return unit == "khz" ? 1e3 * *value : *value;
    }
    for (const std::string_view word : steps) {
      const std::optional<double> value = number_behind(line, word, unit);
      const bool ms = unit == "ms", us = unit == "us";
      if (value && *value > 0.0) return (ms ? 1e3 : us ? 1e6 : 1.0) / *value;
    }
  }
  return 0.0;
}

/// DynoWare (Kistler) writes a header of keys, names, a row of units and the samples.
bool is_dynoware(std::string_view content) {
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  return trimmed(content.substr(0, 40)).starts_with("DynoWare") || content.starts_with("\"DynoWare");
}

/// The number behind a key at the begin of a line; 0: there is none.
double number_at_key(std::string_view head, std::string_view key) {
  for (std::size_t at = head.find(key); at != std::string_view::npos; at = head.find(key, at + 1)) {
    if (at > 0 && head[at - 1] != '\n' && head[at - 1] != '"') continue;
    std::string_view rest = head.substr(at + key.size(), 60);
    rest.remove_prefix(std::min(rest.find_first_not_of(":;,\t \""), rest.size()));
    return parse_number(rest.substr(0, rest.find_first_not_of("0123456789"))).value_or(0.0);
  }
  return 0.0;
}

/// Before the table is read, in which further cycles would be lines that are no numbers.
void require_one_cycle(std::string_view content, const std::string& file) {
  constexpr std::string_view key = "Cycle No";
  const std::size_t first = content.find(key);
  const std::size_t second = first == std::string_view::npos ? first : content.find(key, first + 1);
  if (second == std::string_view::npos) return;
  const auto line = 1 + std::ranges::count(content.substr(0, second), '\n');
  throw InvalidInput(fmt::format("{}:{}", file, line), "holds several cycles of DynoWare",
                     "Export each into a file of its own");
}

}  // namespace

Record read_text_record(const std::filesystem::path& path) {
  const std::string content = read_file(path), file = path.string();
  if (const TextMaker maker = text_maker_of(std::string_view(content)); maker != TextMaker::none) {
    return read_maker_text(path, content, maker);
  }
  const bool of_dynoware = is_dynoware(content);
  if (of_dynoware) require_one_cycle(content, file);
  Record record{.file = path, .names = {}, .columns = {}};
  Table table = parse_table(content, file, record.notes);
  const std::string_view head = std::string_view(content).substr(0, table.begin);
  record.names = table.names;
  record.sample_rate_hz = stated_rate_hz(head);
  record.rate_is_stated = record.sample_rate_hz > 0.0;
  record.names.resize(table.columns.size());
  record.units = table.units;
  record.units.resize(table.columns.size());
  for (std::vector<double>& column : table.columns) {
    record.columns.emplace_back(
        Eigen::Map<const Eigen::VectorXd>(column.data(), static_cast<Eigen::Index>(column.size())));
    column = std::vector<double>();
  }
  const double stated = of_dynoware ? number_at_key(head, "Samples per channel") : 0.0;
  const auto there = static_cast<double>(record.columns.front().size());
  if (there < stated) {
    record.notes.push_back(fmt::format("{}{} holds {} of the {:.0f} samples a channel that its header states",
                                       warning_label, file, there, stated));
  }
  return record;
}

}  // namespace robomill::io
