#include "robomill/path/check/check_account.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace robomill::path {

void ViolationBook::add(const Place& place, int order, double ratio) {
  const double reported = std::isfinite(ratio) ? ratio : std::numeric_limits<double>::max();
  const auto cell = std::isfinite(path_m_) ? static_cast<std::int64_t>(std::floor(path_m_ * violation_cells_per_m)) : 0;
  const std::uint64_t key = (static_cast<std::uint64_t>(cell) * 1'000'003U + std::uint64_t{place.block}) * 5U +
                            static_cast<std::uint64_t>(order + 1);
  const auto known = index_.find(key);
  if (known != index_.end()) {
    Violation& violation = violations_[known->second];
    if (reported > violation.ratio) {
      violation.ratio = reported;
      violation.time_s = place.time_s;
      violation.path_m = path_m_;
    }
    return;
  }
  if (violations_.size() == room) return;
  index_.emplace(key, violations_.size());
  violations_.push_back(
      {.block = place.block, .time_s = place.time_s, .path_m = path_m_, .ratio = reported, .order = order});
}

std::vector<Violation> ViolationBook::take() {
  std::stable_sort(violations_.begin(), violations_.end(),
                   [](const Violation& a, const Violation& b) { return a.time_s < b.time_s; });
  index_.clear();
  return std::exchange(violations_, {});
}

Watch::Watch(Usage& usage, double limit, double relative_tolerance, int order)
    : usage_(&usage),
      bound_(limit > 0.0 ? limit * (1.0 + relative_tolerance) : std::numeric_limits<double>::infinity()),
      order_(order) {
  usage.limit = limit;
}

void Watch::raise(double value, const Place& place, ViolationBook& book) {
  if (value > usage_->max) {
    usage_->max = value;
    usage_->at_s = place.time_s;
    usage_->block = place.block;
    quiet_ = std::min(value, bound_);
  }
  if (value > bound_) {
    ++usage_->violations;
    book.add(place, order_, value / usage_->limit);
  }
}

}  // namespace robomill::path
