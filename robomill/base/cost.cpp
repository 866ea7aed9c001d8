#include "robomill/base/cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"

namespace robomill {
namespace {

constexpr double operations_per_s = 1e9;

// One by one: a limit that is read while it is set may be half of each, which is a limit too.
std::atomic<double> most_operations{CostLimit{}.operations};
std::atomic<double> most_bytes{CostLimit{}.bytes};
std::atomic<const char*> way_out{CostLimit{}.way_out};

std::string time_text(double operations) {
  // Two digits, and none as a power of ten: 99.6 is the next unit's.
  constexpr double rounded_up = 99.5;
  const double seconds = operations / operations_per_s;
  if (seconds < rounded_up) return fmt::format("{:.2g} s", seconds);
  if (seconds < rounded_up * 60.0) return fmt::format("{:.2g} min", seconds / 60.0);
  if (seconds < rounded_up * 3600.0) return fmt::format("{:.2g} h", seconds / 3600.0);
  const double days = seconds / 86400.0;
  return days < 36500.0 ? fmt::format("{:.0f} days", days) : "over a hundred years";
}

std::string size_text(double bytes) {
  if (bytes < 999.5e6) return fmt::format("{:.0f} MB", std::max(1.0, bytes / 1e6));
  return bytes < 999.5e9 ? fmt::format("{:.3g} GB", bytes / 1e9) : fmt::format("{:.3g} TB", bytes / 1e12);
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
  way_out = limit.way_out;
}

CostLimit cost_limit() {
  return {.operations = most_operations, .bytes = most_bytes, .way_out = way_out};
}

std::string above_limit(const Cost& cost) {
  const CostLimit limit = cost_limit();
  std::vector<std::string> over;
  // The negated comparison rejects what is not a number too.
  if (!(cost.operations <= limit.operations)) {
    over.push_back(
        fmt::format("about {} of one core, more than {}", time_text(cost.operations), time_text(limit.operations)));
  }
  const double least = cost.least_bytes();
  if (!(least <= limit.bytes)) {
    over.push_back(fmt::format("about {} of memory, more than {}", size_text(least), size_text(limit.bytes)));
  }
  return fmt::format("{}", fmt::join(over, " and "));
}

int require_affordable(const Cost& cost) {
  const CostLimit limit = cost_limit();
  if (const std::string over = above_limit(cost); !over.empty()) {
    throw InvalidInput(
        cost.dominant.field, cost.dominant.value, cost.dominant.unit, "would take " + over,
        fmt::format("Change this number{}{}", *limit.way_out != '\0' ? "; if it is meant, " : "", limit.way_out));
  }
  const int all = thread_count();
  if (!(cost.bytes + all * cost.bytes_a_thread > limit.bytes)) return all;
  return std::max(1, static_cast<int>((limit.bytes - cost.bytes) / cost.bytes_a_thread));
}

}  // namespace robomill
