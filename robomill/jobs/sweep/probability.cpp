#include "robomill/jobs/sweep/probability.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace robomill::jobs {

Estimate wilson_interval(std::size_t holding, std::size_t points) {
  if (points == 0) return {};
  constexpr double z = 1.959963984540054;  // 97.5 % quantile of the normal distribution
  const auto n = static_cast<double>(points);
  const double p = static_cast<double>(holding) / n, scale = 1.0 + z * z / n;
  const double middle = (p + z * z / (2.0 * n)) / scale;
  const double half = z * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n)) / scale;
  return {.value = p,
          .low = holding == 0 ? 0.0 : std::max(0.0, middle - half),
          .high = holding == points ? 1.0 : std::min(1.0, middle + half)};
}

ConditionShare share_of(std::span<const double> values, const Condition& condition, double worst_share) {
  ConditionShare out;
  std::vector<double> known;
  known.reserve(values.size());
  for (const double value : values) {
    if (std::isnan(value)) {
      ++out.left_out;
      continue;
    }
    known.push_back(value);
    out.holding += condition.holds(value) ? 1 : 0;
    out.infinite += std::isinf(value) ? 1 : 0;
  }
  out.points = known.size();
  out.share = wilson_interval(out.holding, out.points);
  if (known.empty()) return out;
  const auto place = static_cast<std::ptrdiff_t>(worst_share * static_cast<double>(known.size()));
  const auto worst = known.begin() + place;
  if (condition.at_least) {
    std::ranges::nth_element(known, worst);
  } else {
    std::ranges::nth_element(known, worst, std::greater());
  }
  out.worst = *worst;
  return out;
}

}  // namespace robomill::jobs
