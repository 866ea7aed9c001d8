#include "robomill/jobs/init/template_lines.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robomill/io/text.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/samples.hpp"

namespace robomill::jobs {
namespace {

std::string_view last_of(std::string_view key) {
  return key.substr(key.find_last_of('.') + 1);
}

constexpr std::string_view of_blank =
    "# Keys marked \"needed\" stand behind a #: write your own value there and take the # away. What is shown is an "
    "example.\n"
    "# Other lines behind a # are defaults, or other ways to say the same.";
constexpr std::string_view of_example =
    "# An example that runs as it is: its values are made up. Those marked \"sample\" are listed as assumed until they "
    "are\n"
    "# changed. Lines behind a # are defaults, or other ways to say the same.";

std::string rendered_line(std::string_view line, bool example) {
  if (line == "#~") return std::string(example ? of_example : of_blank);
  const std::size_t at = line.find(" #") + 1;
  const char mark = at > 0 && at + 1 < line.size() ? line[at + 1] : '\0';
  if (mark != '!' && mark != '?' && mark != '=') return std::string(line);
  if (line.starts_with('#')) return fmt::format("{}# {}", line.substr(0, at), io::trimmed(line.substr(at + 2)));
  const std::string_view setting = io::trimmed(line.substr(0, at)), remark = io::trimmed(line.substr(at + 2));
  const auto with = [&](const std::string& begin, const std::string& said) {
    const std::string text = fmt::format("{:<35} {}{}", begin, said.empty() ? "" : "# ", said);
    return std::string(io::trimmed(text));
  };
  if (!example && mark != '=') {
    const std::string needed = fmt::format("needed{}{}", remark.empty() ? "" : ": ", remark);
    return with(fmt::format("# {}", setting), mark == '!' ? needed : std::string(remark));
  }
  const std::string sample = io::sample_mark(setting.substr(setting.find('=') + 1));
  return with(std::string(setting), fmt::format("{}{}{}", sample, remark.empty() ? "" : ": ", remark));
}

constexpr std::string_view table_of = "#+ ";

/// Calls f with each line, without its end.
template <class F>
void each_line(std::string_view text, const F& f) {
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    f(line);
  }
}

/// The lines of a table up to the first that is empty.
std::string table_lines(std::string_view raw, std::string_view header, bool with_header) {
  std::string out;
  bool inside = false;
  each_line(raw, [&](std::string_view line) {
    const bool begins = line.starts_with(header);
    if (begins || line.empty()) inside = begins;
    if (inside && (!begins || with_header)) out += fmt::format("{}\n", line);
  });
  return out;
}

}  // namespace

std::string with_tables(std::string_view raw, std::string_view other) {
  std::string out;
  each_line(raw, [&](std::string_view line) {
    if (!line.starts_with(table_of)) {
      out += fmt::format("{}\n", line);
    } else if (const std::string_view table = line.substr(table_of.size()); table.starts_with('[')) {
      out += table_lines(other, table, true) + "\n";
    } else {
      out += table_lines(other, fmt::format("[{}]", table), false);
    }
  });
  return out;
}

std::string without_tables(std::string_view raw) {
  std::string out;
  each_line(raw, [&](std::string_view line) {
    if (!line.starts_with(table_of)) out += fmt::format("{}\n", line);
  });
  return out;
}

std::string template_line(std::string_view key, std::string_view value, std::string_view remark,
                          std::string_view mark) {
  const std::string line = fmt::format("{} = {}", key, value);
  if (remark.empty() && mark == "#") return line + "\n";
  return fmt::format("{:<35} {}{}{}\n", line, mark, remark.empty() ? "" : " ", remark);
}

std::string rendered(std::string_view raw, bool example) {
  std::string out;
  each_line(raw, [&](std::string_view line) { out += rendered_line(line, example) + "\n"; });
  return out;
}

std::string with_remark(std::string_view document, const std::string& key, const std::string& value,
                        std::string_view remark, std::string_view mark) {
  std::string text = io::with_setting(document, {.key = key, .value = value});
  const std::string begin = fmt::format("\n{} = {}", last_of(key), value);
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return text;
  const std::size_t end = std::min(text.find('\n', at + 1), text.size() - 1) + 1;
  return fmt::format("{}{}{}", text.substr(0, at + 1), template_line(last_of(key), value, remark, mark),
                     text.substr(end));
}

std::string commented_out(std::string document, std::string_view key) {
  const std::size_t at = document.find(fmt::format("\n{} = ", last_of(key)));
  if (at != std::string::npos) document.insert(at + 1, "# ");
  return document;
}

}  // namespace robomill::jobs
