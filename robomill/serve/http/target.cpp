#include "robomill/serve/http/target.hpp"

#include <charconv>
#include <optional>
#include <system_error>

namespace robomill::serve {
namespace {

int digit(char letter) {
  if (letter >= '0' && letter <= '9') return letter - '0';
  if (letter >= 'a' && letter <= 'f') return letter - 'a' + 10;
  if (letter >= 'A' && letter <= 'F') return letter - 'A' + 10;
  return -1;
}

std::optional<std::string> decoded(std::string_view text, bool plus_is_space) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char letter = text[i];
    if (letter == '%') {
      const int high = i + 2 < text.size() ? digit(text[i + 1]) : -1;
      const int low = high >= 0 ? digit(text[i + 2]) : -1;
      if (low < 0) return std::nullopt;
      letter = static_cast<char>(16 * high + low);
      i += 2;
    } else if (letter == '+' && plus_is_space) {
      letter = ' ';
    }
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f) return std::nullopt;
    out += letter;
  }
  return out;
}

}  // namespace

bool split_target(std::string_view target, std::string& path, std::map<std::string, std::string, std::less<>>& query) {
  query.clear();
  if (target.empty() || target.front() != '/') return false;
  target = target.substr(0, target.find('#'));
  const std::size_t mark = target.find('?');
  const std::optional<std::string> before = decoded(target.substr(0, mark), false);
  if (!before) return false;
  path = *before;
  if (mark == std::string_view::npos) return true;
  for (std::string_view rest = target.substr(mark + 1); !rest.empty();) {
    const std::size_t end = rest.find('&');
    const std::string_view pair = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (pair.empty()) continue;
    const std::size_t equals = pair.find('=');
    const std::optional<std::string> key = decoded(pair.substr(0, equals), true);
    const std::optional<std::string> value =
        equals == std::string_view::npos ? std::string() : decoded(pair.substr(equals + 1), true);
    if (!key || !value || !query.emplace(*key, *value).second) return false;
  }
  return true;
}

int number_of(std::string_view path, std::string_view prefix) {
  if (!path.starts_with(prefix)) return 0;
  path.remove_prefix(prefix.size());
  if (path.empty() || path.front() < '1' || path.front() > '9') return 0;
  int number = 0;
  const std::from_chars_result read = std::from_chars(path.data(), path.data() + path.size(), number);
  return read.ec == std::errc() && read.ptr == path.data() + path.size() ? number : 0;
}

}  // namespace robomill::serve
