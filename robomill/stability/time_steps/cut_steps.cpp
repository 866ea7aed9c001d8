#include "robomill/stability/time_steps/cut_steps.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"

namespace robomill::stability::detail {
namespace {

Delay delay_of(double steps) {
  // A whole number of steps but for rounding is taken as one.
  if (std::abs(steps - std::round(steps)) < 1e-9) return {.whole = static_cast<int>(std::lround(steps))};
  const double whole = std::ceil(steps);
  return {.whole = static_cast<int>(whole), .fraction = whole - steps};
}

}  // namespace

CutSteps::CutSteps(const cutting::Milling& milling, int intervals) : milling_(milling) {
  const int teeth = milling.tool.teeth;
  if (milling.tool.has_equal_pitch()) {
    milling_.tool.pitch_rad.clear();
    period_ = Period::tooth;
    steps_ = intervals;
    step_rad_ = units::revolution / teeth / intervals;
    delays_ = {Delay{.whole = intervals}};
    delay_of_tooth_.assign(static_cast<std::size_t>(teeth), 0);
  } else {
    period_ = Period::revolution;
    constexpr int most_steps = 20000;
    if (intervals > most_steps / teeth) {
      throw InvalidInput("intervals", intervals, "", "are too many for a revolution of this cutter");
    }
    steps_ = intervals * teeth;
    step_rad_ = units::revolution / steps_;
    for (int j = 0; j < teeth; ++j) {
      const Delay delay = delay_of(milling.tool.pitch(j) / step_rad_);
      if (delay.whole < 2) {
        throw InvalidInput("intervals", intervals, "", "are too few for the smallest pitch",
                           "A pitch must be at least two time steps long");
      }
      const auto same = std::ranges::find_if(delays_, [&](const Delay& other) {
        return other.whole == delay.whole && std::abs(other.fraction - delay.fraction) < 1e-9;
      });
      delay_of_tooth_.push_back(static_cast<int>(same - delays_.begin()));
      if (same == delays_.end()) delays_.push_back(delay);
    }
  }
  if (milling_.tool.lag_rad_per_m(0) == 0.0) fill(1.0, per_depth_);
}

void CutSteps::fill(double axial_depth_m, std::vector<Eigen::Matrix2d>& stiffness) const {
  const std::size_t steps = static_cast<std::size_t>(steps_);
  stiffness.assign(delays_.size() * steps, Eigen::Matrix2d::Zero());
  for (int j = 0; j < milling_.tool.teeth; ++j) {
    const std::size_t row = static_cast<std::size_t>(delay_of_tooth_[static_cast<std::size_t>(j)]) * steps;
    for (int i = 0; i < steps_; ++i) {
      stiffness[row + static_cast<std::size_t>(i)] +=
          cutting::mean_cutting_stiffness(milling_, j, i * step_rad_, (i + 1) * step_rad_, axial_depth_m);
    }
  }
}

void CutSteps::at_depth(double axial_depth_m, DepthPlan& out) const {
  out.axial_depth_m = axial_depth_m;
  const std::size_t steps = static_cast<std::size_t>(steps_);
  if (per_depth_.empty()) {
    fill(axial_depth_m, out.stiffness);
  } else {
    out.stiffness.resize(per_depth_.size());
    std::ranges::transform(per_depth_, out.stiffness.begin(),
                           [&](const Eigen::Matrix2d& k) -> Eigen::Matrix2d { return k * axial_depth_m; });
  }
  out.cuts.resize(out.stiffness.size());
  out.largest_n_per_m = 0.0;
  for (std::size_t i = 0; i < steps; ++i) {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (std::size_t g = 0; g < delays_.size(); ++g) {
      const Eigen::Matrix2d& k = out.stiffness[g * steps + i];
      out.cuts[g * steps + i] = k.isZero(0.0) ? 0 : 1;
      sum += k;
    }
    out.largest_n_per_m = std::max(out.largest_n_per_m, sum.norm());
  }
}

void KnownDepths::expect(const CutSteps& cut, std::span<const double> depths_m) {
  const std::size_t matrices = depths_m.size() * static_cast<std::size_t>(cut.steps()) * cut.delays().size();
  if (cut.grows_with_depth() || matrices > 4'000'000) return;
  plans_.resize(depths_m.size());
  parallel_for(depths_m.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) cut.at_depth(depths_m[j], plans_[j]);
  });
}

const DepthPlan* KnownDepths::find(double axial_depth_m) const {
  const auto plan = std::ranges::lower_bound(plans_, axial_depth_m, {}, &DepthPlan::axial_depth_m);
  return plan != plans_.end() && plan->axial_depth_m == axial_depth_m ? &*plan : nullptr;
}

}  // namespace robomill::stability::detail
