#include "robomill/jobs/init/template_lines.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robomill/io/toml_edit.hpp"

namespace robomill::jobs {
namespace {

std::string_view last_of(std::string_view key) {
  return key.substr(key.find_last_of('.') + 1);
}

}  // namespace

std::string template_line(std::string_view key, std::string_view value, std::string_view remark) {
  const std::string line = fmt::format("{} = {}", key, value);
  if (remark.empty()) return line + "\n";
  return fmt::format("{:<35} # {}\n", line, remark);
}

std::string with_remark(std::string_view document, const std::string& key, const std::string& value,
                        std::string_view remark) {
  std::string text = io::with_setting(document, {.key = key, .value = value});
  const std::string begin = fmt::format("\n{} = {}", last_of(key), value);
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return text;
  const std::size_t end = std::min(text.find('\n', at + 1), text.size() - 1) + 1;
  return fmt::format("{}{}{}", text.substr(0, at + 1), template_line(last_of(key), value, remark), text.substr(end));
}

std::string commented_out(std::string document, std::string_view key) {
  const std::size_t at = document.find(fmt::format("\n{} = ", last_of(key)));
  if (at != std::string::npos) document.insert(at + 1, "# ");
  return document;
}

}  // namespace robomill::jobs
