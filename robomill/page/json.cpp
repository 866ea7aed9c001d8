#include "robomill/page/json.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace robomill::page {

using io::Json;

Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 5).ptr;
  double rounded = 0.0;
  std::from_chars(text.data(), end, rounded);
  return rounded;
}

Json text(const std::string& raw) {
  const Json quoted = raw;
  return io::parsed(io::plain_text(quoted));
}

}  // namespace robomill::page
