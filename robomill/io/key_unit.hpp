#pragma once
#include <string>
#include <string_view>

namespace robomill::io {

/// "N/mm^2" of "tangential_n_per_mm2": what the tokens at the end of a key say; empty where they name no unit.
[[nodiscard]] std::string unit_of_key(std::string_view key);

/// What the end of a key says of its number: "feed_mm_per_min" is in mm/min, and fills feed_m_per_s.
struct KeyUnit {
  std::string name = {};    ///< of the key without its unit: "feed"
  std::string text = {};    ///< "mm/min"; empty: none
  double factor = 1.0;      ///< SI value = factor * value
  std::string member = {};  ///< the key's name in SI: "feed_m_per_s"
};
[[nodiscard]] KeyUnit key_unit(std::string_view key);

}  // namespace robomill::io
