#pragma once
#include <string>
#include <vector>

#include "robomill/base/export.hpp"

// Method: robomill/base/README.md, "Method"

namespace robomill {

/// What was taken because nobody said it.
struct Assumption {
  std::string what = {};   ///< "Stock"
  std::string taken = {};  ///< in words, numbers in shop units: "a box from (-6, -6, -3) to (56, 36, 0) mm"
  std::string key = {};    ///< what to give instead: "stock.kind", "--teeth"
  std::string file = {};   ///< the name of the file that it belongs in; empty: it is an option
  [[nodiscard]] bool operator==(const Assumption&) const = default;
};

/// Adds what the list does not hold yet: two stages may read one file.
ROBOMILL_API void add_assumed(std::vector<Assumption>& to, const std::vector<Assumption>& more);

/// "Teeth of the cutter: 4 (--teeth)"
[[nodiscard]] ROBOMILL_API std::string assumption_text(const Assumption& one);

/// A heading and a line each, as a terminal may have them; empty for an empty list.
[[nodiscard]] ROBOMILL_API std::string assumed_text(const std::vector<Assumption>& assumed);

}  // namespace robomill
