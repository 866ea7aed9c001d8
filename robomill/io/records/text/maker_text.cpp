#include "robomill/io/records/text/maker_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/channels.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

constexpr std::string_view header_size_key = "header size", class_key = "function class";
constexpr std::size_t most_looked_at = 4096;
constexpr std::size_t longest_block_header = 400;  ///< lines

/// A line of a header: a key and what stands behind its colon or tab. Both empty: it is none.
struct KeyLine {
  std::string key = {};
  std::string_view value = {};
};

KeyLine key_line(std::string_view line) {
  const std::size_t end = line.find_first_of(":\t");
  if (end == std::string_view::npos) return {};
  std::string_view value = trimmed(line.substr(end + 1));
  while (value.starts_with(':')) value = trimmed(value.substr(1));
  std::string key = lowered(trimmed(line.substr(0, end)));
  if (!key.empty() && (parse_cell(key) || key.size() > 60)) return {};
  return {.key = std::move(key), .value = value};
}

std::string_view take_text_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// A block: what its header says, and where its numbers begin.
struct TextBlock {
  std::string name = {}, unit = {}, x_unit = {}, function = {};
  bool is_complex = false;
  double stated_samples = 0.0;  ///< 0: the header does not say it
  std::size_t header_lines = 0;
  std::size_t begin_line = 0;     ///< of the numbers, from 0
  std::string_view numbers = {};  ///< from the line there on, up to the next block
};

void take_key(const KeyLine& said, TextBlock& block) {
  const std::string& key = said.key;
  const std::string value(said.value.substr(0, 200));
  if (key.empty() || value.empty()) return;
  const bool is_unit = key.find("unit") != std::string::npos;
  const auto begins = [&key](std::string_view word) { return key.starts_with(word); };
  if (is_unit && (begins("x") || begins("abscissa"))) {
    block.x_unit = value;
  } else if (is_unit && (begins("y") || begins("ordinate") || begins("amplitude"))) {
    block.unit = value;
  } else if (key == class_key || key == "type of function" || key == "function") {
    block.function = lowered(value);
  } else if (key == "x-axis size") {
    block.stated_samples = parse_number(value).value_or(0.0);
  } else if (key == "data type") {
    block.is_complex = lowered(value).find("complex") != std::string::npos;
  } else if (key == header_size_key) {
    std::size_t lines = 0;
    const std::from_chars_result read = std::from_chars(value.data(), value.data() + value.size(), lines);
    if (read.ec == std::errc() && lines <= longest_block_header) block.header_lines = lines;
  } else if (block.name.empty() && (key == "signal" || key == "channel" || key == "channel name" || key == "point id" ||
                                    key == "dof id" || key == "point" || key == "original title 1" ||
                                    key == "title 1" || key == "title1" || key == "title" || key == "name")) {
    block.name = value;
  }
}

/// Whether a line begins the header of a block.
bool begins_block(const KeyLine& said, TextMaker maker) {
  return maker == TextMaker::pulse && said.key == header_size_key;
}

bool is_numbers(std::string_view line) {
  const std::vector<std::string> fields = split_texts(line, separator_of(line) == '\t' ? ' ' : separator_of(line));
  return fields.size() >= 2 &&
         std::ranges::all_of(fields, [](const std::string& f) { return parse_cell(f).has_value(); });
}

class BlockReader {
 public:
  BlockReader(const std::filesystem::path& path, std::string_view content, TextMaker maker)
      : path_(path), content_(content), maker_(maker) {
    if (content_.starts_with("\xEF\xBB\xBF")) content_.remove_prefix(3);
  }

  Record read() {
    split();
    Record out{.file = path_, .names = {}, .units_by = "the header", .columns = {}};
    for (const TextBlock& block : blocks_) take(block, out.notes);
    const ChannelsTogether taken = channels_together(channels_, path_.string());
    take_channels(out, channels_, taken);
    for (const std::size_t place : taken.places) {
      out.columns.emplace_back(
          Eigen::Map<const Eigen::VectorXd>(columns_[place].data(), static_cast<Eigen::Index>(taken.samples)));
      columns_[place] = std::vector<double>();
    }
    out.notes.push_back(
        fmt::format("{}: read as a text of {}, by its published description, which is untried on a "
                    "real file: compare rate and units with those of the measurement",
                    path_.string(), maker_ == TextMaker::pulse ? "PULSE" : "Testlab"));
    return out;
  }

 private:
  void split() {
    std::string_view rest = content_;
    std::size_t line_number = 0, in_header = 0;
    bool is_header = true;
    blocks_.emplace_back();
    const char* begin = nullptr;
    while (!rest.empty()) {
      const std::string_view before = rest;
      const std::string_view line = take_text_line(rest);
      const KeyLine said = key_line(line);
      if (!is_header && begins_block(said, maker_)) {
        blocks_.back().numbers = std::string_view(begin, static_cast<std::size_t>(before.data() - begin));
        blocks_.emplace_back();
        if (blocks_.size() > most_channels) throw InvalidInput(path_.string(), "holds too many blocks");
        is_header = true;
        in_header = 0;
      }
      TextBlock& block = blocks_.back();
      if (is_header && (in_header++ < block.header_lines || !is_numbers(line))) {
        take_key(said, block);
        if (in_header > longest_block_header) {
          throw InvalidInput(fmt::format("{}:{}", path_.string(), line_number + 1), "the header has no end",
                             "Is it a text of " + std::string(maker_ == TextMaker::pulse ? "PULSE?" : "Testlab?"));
        }
      } else if (is_header) {
        is_header = false;
        block.begin_line = line_number;
        begin = before.data();
      }
      ++line_number;
    }
    if (is_header) throw InvalidInput(path_.string(), "holds no line of numbers behind a header", "Was it cut off?");
    blocks_.back().numbers =
        std::string_view(begin, static_cast<std::size_t>(content_.data() + content_.size() - begin));
  }

  void take(const TextBlock& block, std::vector<std::string>& notes) {
    FileChannel channel{.name = block.name, .unit = block.unit};
    if (channel.name.empty()) channel.name = fmt::format("block {}", channels_.size() + 1);
    const double s = block.x_unit.empty() ? 1.0 : seconds_in(block.x_unit);
    const bool over_frequency = block.function.find("frf") != std::string::npos ||
                                block.function.find("spectr") != std::string::npos ||
                                block.function.find("frequency") != std::string::npos;
    if (s == 0.0) channel.fault = "over " + block.x_unit;
    if (over_frequency) channel.fault = "is no time signal: " + block.function;
    if (block.is_complex) channel.fault = "complex numbers";
    columns_.emplace_back();
    if (channel.fault.empty()) {
      Table table = table_of(block, notes);
      const std::size_t expected = maker_ == TextMaker::pulse ? 3 : 2;
      if (table.columns.size() != expected) {
        throw InvalidInput(fmt::format("{}:{}", path_.string(), block.begin_line + 1),
                           fmt::format("has {} columns, where a time signal has {}", table.columns.size(), expected),
                           "Export time signals, real, each in a block of its own");
      }
      const std::vector<double>& x = table.columns[expected - 2];
      const Eigen::Map<const Eigen::VectorXd> times(x.data(), static_cast<Eigen::Index>(x.size()));
      channel.sample_rate_hz =
          round_15(sample_rate_of(times, fmt::format("{}:{}", path_.string(), block.begin_line + 1)) / s);
      channel.start = {.is_known = true, .s = s * x.front()};
      channel.samples = x.size();
      if (static_cast<double>(x.size()) < block.stated_samples) {
        notes.push_back(fmt::format("{}{} holds {} of the {:.0f} samples that its header states", warning_label,
                                    channel.name, x.size(), block.stated_samples));
      }
      columns_.back() = std::move(table.columns[expected - 1]);
    }
    channels_.push_back(std::move(channel));
  }

  [[nodiscard]] Table table_of(const TextBlock& block, std::vector<std::string>& notes) const {
    const std::string numbers(block.numbers);
    try {
      return parse_table(numbers, path_.string(), notes);
    } catch (const InvalidInput&) {
      // Lines before it set errors at their place.
      return parse_table(std::string(block.begin_line, '\n') + numbers, path_.string(), notes);
    }
  }

  std::filesystem::path path_;
  std::string_view content_;
  TextMaker maker_;
  std::vector<TextBlock> blocks_;
  std::vector<FileChannel> channels_;
  std::vector<std::vector<double>> columns_;
};

}  // namespace

TextMaker text_maker_of(std::string_view content) {
  constexpr int first_lines = 40;
  if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
  content = content.substr(0, most_looked_at);
  bool has_size = false;
  for (int i = 0; i < first_lines && !content.empty(); ++i) {
    const KeyLine said = key_line(take_text_line(content));
    if (said.key == class_key) return TextMaker::testlab;
    if (said.key == header_size_key && i < 3) has_size = true;
    if (has_size && (said.key == "x-axis size" || said.key == "data type" || said.key == "z-axis size")) {
      return TextMaker::pulse;
    }
  }
  return TextMaker::none;
}

TextMaker text_maker_of(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return TextMaker::none;
  std::string head(most_looked_at, '\0');
  std::ifstream file = open_file(path);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return text_maker_of(std::string_view(head));
}

Record read_maker_text(const std::filesystem::path& path, std::string_view content, TextMaker maker) {
  return BlockReader(path, content, maker).read();
}

}  // namespace robomill::io
