#include "robomill/base/cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"

namespace robomill {
namespace {

constexpr double operations_per_s = 1e9;

// Two of them: a limit that is read while it is set may be half of each, which is a limit too.
std::atomic<double> most_operations{CostLimit{}.operations};
std::atomic<double> most_bytes{CostLimit{}.bytes};

std::string time_text(double operations) {
  const double seconds = operations / operations_per_s;
  if (seconds < 100.0) return fmt::format("{:.2g} s", seconds);
  if (seconds < 100.0 * 60.0) return fmt::format("{:.2g} min", seconds / 60.0);
  if (seconds < 100.0 * 3600.0) return fmt::format("{:.2g} h", seconds / 3600.0);
  const double days = seconds / 86400.0;
  return days < 36500.0 ? fmt::format("{:.0f} days", days) : "over a hundred years";
}

std::string size_text(double bytes) {
  if (bytes < 1e9) return fmt::format("{:.0f} MB", std::max(1.0, bytes / 1e6));
  return bytes < 1e12 ? fmt::format("{:.3g} GB", bytes / 1e9) : fmt::format("{:.3g} TB", bytes / 1e12);
}

}  // namespace

CostDriver dominant_of(std::initializer_list<CostDriver> drivers) {
  CostDriver most;
  for (const CostDriver& driver : drivers) {
    if (driver.field.empty()) continue;
    if (most.field.empty() || driver.times_usual > most.times_usual) most = driver;
  }
  return most;
}

void set_cost_limit(const CostLimit& limit) {
  most_operations = limit.operations;
  most_bytes = limit.bytes;
}

CostLimit cost_limit() {
  return {.operations = most_operations, .bytes = most_bytes};
}

void require_affordable(const Cost& cost) {
  const CostLimit limit = cost_limit();
  std::vector<std::string> over;
  // The negated comparison rejects what is not a number too.
  if (!(cost.operations <= limit.operations)) {
    over.push_back(
        fmt::format("about {} of one core, more than {}", time_text(cost.operations), time_text(limit.operations)));
  }
  if (!(cost.bytes <= limit.bytes)) {
    over.push_back(fmt::format("about {} of memory, more than {}", size_text(cost.bytes), size_text(limit.bytes)));
  }
  if (over.empty()) return;
  throw InvalidInput(cost.dominant.field, cost.dominant.value, cost.dominant.unit,
                     fmt::format("would take {}", fmt::join(over, " and ")),
                     "Change this number; if it is meant, --allow-large of the command line takes it");
}

}  // namespace robomill
