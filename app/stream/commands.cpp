#include "commands.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "robomill/base/printable.hpp"
#include "robomill/io/text.hpp"

namespace robomill::app {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";
constexpr std::string_view known = "hold, resume, override SHARE, stop, status";
constexpr double most_override = 1.5;

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(blanks) - begin + 1);
}

ParsedCommand rejected(std::string error) {
  return {.command = {}, .error = std::move(error)};
}

ParsedCommand parse_override(std::string_view value) {
  const std::optional<double> share = io::parse_number(value);
  if (share && std::isfinite(*share) && *share >= 0.0 && *share <= most_override) {
    return {.command = StreamCommand{.kind = StreamCommand::Kind::feed_override, .share = *share}, .error = {}};
  }
  return rejected(fmt::format("override must be a share of the programmed feed from 0 to {}, not \"{}\"; 0.5 is half",
                              most_override, printable(value)));
}

}  // namespace

ParsedCommand parse_command(std::string_view line) {
  using Kind = StreamCommand::Kind;
  constexpr std::array<std::pair<std::string_view, Kind>, 4> plain = {
      {{"hold", Kind::hold}, {"resume", Kind::resume}, {"stop", Kind::stop}, {"status", Kind::status}}};
  const std::string_view text = trimmed(line);
  if (text.empty()) return {};
  const std::size_t word_end = std::min(text.find_first_of(blanks), text.size());
  const std::string_view word = text.substr(0, word_end), rest = trimmed(text.substr(word_end));
  if (word == "override") return parse_override(rest);
  for (const auto& [name, kind] : plain) {
    if (word != name) continue;
    if (!rest.empty()) return rejected(fmt::format("{} takes no value, not \"{}\"", name, printable(rest)));
    return {.command = StreamCommand{.kind = kind}, .error = {}};
  }
  return rejected(fmt::format("\"{}\" is no command; known are {}", printable(text), known));
}

void CommandLines::add(std::string_view bytes, const std::function<void(std::optional<std::string_view>)>& take) {
  while (!bytes.empty()) {
    const std::size_t line_end = bytes.find('\n');
    const std::string_view part = bytes.substr(0, line_end);
    if (!skipping_ && line_.size() + part.size() > longest) {
      skipping_ = true;
      line_.clear();
      take(std::nullopt);
    }
    if (!skipping_) line_ += part;
    if (line_end == std::string_view::npos) return;
    if (!skipping_) take(line_);
    line_.clear();
    skipping_ = false;
    bytes.remove_prefix(line_end + 1);
  }
}

void CommandLines::end(const std::function<void(std::optional<std::string_view>)>& take) {
  if (!skipping_ && !line_.empty()) take(line_);
  line_.clear();
  skipping_ = false;
}

}  // namespace robomill::app
