#include "robomill/base/assumption.hpp"

#include <algorithm>

#include "robomill/base/printable.hpp"

namespace robomill {

void add_assumed(std::vector<Assumption>& to, const std::vector<Assumption>& more) {
  for (const Assumption& one : more) {
    if (std::ranges::find(to, one) == to.end()) to.push_back(one);
  }
}

std::string assumption_text(const Assumption& one) {
  std::string line = one.what + ": " + one.taken;
  if (!one.key.empty()) line += " (" + one.key + (one.file.empty() ? "" : " of " + one.file) + ")";
  return line;
}

std::string assumed_text(const std::vector<Assumption>& assumed) {
  if (assumed.empty()) return {};
  std::string out = "Assumed, because not given:\n";
  for (const Assumption& one : assumed) out += "  " + printable(assumption_text(one)) + "\n";
  return out;
}

}  // namespace robomill
