#include "robomill/modal/impact/hits_pulse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "robomill/base/statistics.hpp"

namespace robomill::modal {
namespace {

using Eigen::Index;

// For normal noise the median of |x| is 0.6745 standard deviations.
double robust_deviation(const Eigen::VectorXd& x) {
  return median(x.cwiseAbs()) / 0.6745;
}

// Distance from the peak to where the flank has fallen to half, going by `step`.
double half_width(const Eigen::VectorXd& f, Index peak, Index step) {
  const double half = 0.5 * f(peak);
  Index j = peak;
  while (j + step >= 0 && j + step < f.size() && f(j + step) > half) j += step;
  const double so_far = std::abs(static_cast<double>(j - peak));
  if (j + step < 0 || j + step >= f.size()) return so_far;
  return so_far + (f(j) - half) / (f(j) - f(j + step));
}

Index pulse_end(const Eigen::VectorXd& f, Index peak, Index step, double floor) {
  Index j = peak;
  while (j + step >= 0 && j + step < f.size() && f(j + step) > floor) j += step;
  return j;
}

// Running sums answer means over any stretch; stretches are cut at the record's ends.
class Means {
 public:
  explicit Means(const Eigen::VectorXd& f) : sums_(Eigen::VectorXd::Zero(f.size() + 1)) {
    for (Index j = 0; j < f.size(); ++j) sums_(j + 1) = sums_(j) + f(j);
  }
  [[nodiscard]] double over(Index begin, Index end) const {
    begin = std::clamp<Index>(begin, 0, sums_.size() - 1);
    end = std::clamp<Index>(end, 0, sums_.size() - 1);
    return begin < end ? (sums_(end) - sums_(begin)) / static_cast<double>(end - begin) : 0.0;
  }

 private:
  Eigen::VectorXd sums_;
};

// How far a stretch as long as the pulse stands above both of its neighbourhoods. Drift, steps and slow swings of the
// hammer have no contrast; another pulse, up to twice as wide, has nearly its height.
double contrast(const Means& means, Index j, Index width, double sign) {
  const Index begin = j - width / 2;
  const double centre = sign * means.over(begin, begin + width);
  const double before = sign * means.over(begin - 2 * width, begin - width);
  const double after = sign * means.over(begin + 2 * width, begin + 3 * width);
  return centre - std::max(before, after);
}

// Away from the pulse: the highest contrast that pulls of the same size do not match. Ringing swings both ways, a hit
// only pushes.
double second_far(const Eigen::VectorXd& f, const Pulse& pulse, Index width) {
  const Means means(f);
  const Index reach = 3 * width;
  Eigen::VectorXd push(f.size());
  Eigen::VectorXd pull(f.size());
  for (Index j = 0; j < f.size(); ++j) {
    push(j) = contrast(means, j, width, 1.0);
    pull(j) = contrast(means, j, width, -1.0);
  }
  const double noise = robust_deviation(push);
  double highest = 0.0;
  for (Index j = 0; j < f.size(); ++j) {
    const bool near = j > pulse.first - reach && j < pulse.last + reach;
    if (near || push(j) <= std::max(highest, 6.0 * noise)) continue;
    const Index begin = std::max<Index>(0, j - 4 * width);
    const Index end = std::min(f.size(), j + 4 * width + 1);
    double swing = 0.0;
    for (Index i = begin; i < end; ++i) {
      // The pulse's own foot looks like a pull from beside it.
      if (i <= pulse.first - reach || i >= pulse.last + reach) swing = std::max(swing, pull(i));
    }
    highest = std::max(highest, push(j) - swing);
  }
  const double first = contrast(means, pulse.peak, width, 1.0);
  return first > 0.0 ? highest / first : 0.0;
}

// Standard deviation of white noise under whatever slow motion: from the differences of neighbours.
double white_noise(const Eigen::VectorXd& f) {
  return robust_deviation(f.tail(f.size() - 1) - f.head(f.size() - 1)) / std::sqrt(2.0);
}

// Beside the pulse: a rise after a valley, less what swings below the level there.
double second_near(const Eigen::VectorXd& f, const Pulse& pulse, Index width, Index step) {
  const Means means(f);
  const Index smooth = std::max<Index>(1, width / 4);
  const Index foot = step > 0 ? pulse.last : pulse.first;
  const Index beyond = std::clamp<Index>(foot + step * 8 * width, 0, f.size() - 1);
  const double level = median(f.segment(std::min(foot, beyond), std::abs(beyond - foot) + 1));
  const Index limit = foot + step * 3 * width;
  double valley = pulse.peak_n;
  double lowest = level;
  double rise = 0.0;
  for (Index j = pulse.peak; j != limit && j >= 0 && j < f.size(); j += step) {
    const double value = means.over(j - smooth / 2, j - smooth / 2 + smooth);
    valley = std::min(valley, value);
    lowest = std::min(lowest, value);
    rise = std::max(rise, value - std::max(valley, level));
  }
  const double height = rise - (level - lowest);
  const double noise = white_noise(f) / std::sqrt(static_cast<double>(smooth));
  return height > 6.0 * noise ? height / pulse.peak_n : 0.0;
}

// Enough samples before the pulse give the offset; else the record's median, since a pulse is short.
double refined_offset(const Eigen::VectorXd& force_n, const Pulse& pulse) {
  const Index margin = static_cast<Index>(std::ceil(pulse.width));
  const Index count = std::min<Index>(pulse.first - margin, 200 * margin);
  return count >= 32 ? force_n.segment(pulse.first - margin - count, count).mean() : pulse.offset_n;
}

}  // namespace

Pulse find_pulse(const Eigen::VectorXd& force_n) {
  Pulse pulse;
  pulse.offset_n = median(force_n);
  Eigen::VectorXd f = force_n.array() - pulse.offset_n;
  pulse.noise_n = robust_deviation(f);
  f.cwiseAbs().maxCoeff(&pulse.peak);
  pulse.peak_n = f(pulse.peak);
  if (pulse.peak_n <= 0.0) return pulse;
  const double floor = std::max(0.01 * pulse.peak_n, 3.0 * pulse.noise_n);
  pulse.width = half_width(f, pulse.peak, 1) + half_width(f, pulse.peak, -1);
  pulse.first = pulse_end(f, pulse.peak, -1, floor);
  pulse.last = pulse_end(f, pulse.peak, 1, floor);

  const double offset_n = refined_offset(force_n, pulse);
  f = force_n.array() - offset_n;
  pulse.peak_n += pulse.offset_n - offset_n;
  pulse.offset_n = offset_n;
  const Index width = std::max<Index>(1, std::lround(pulse.width));
  pulse.second_ratio =
      std::max({0.0, second_far(f, pulse, width), second_near(f, pulse, width, 1), second_near(f, pulse, width, -1)});
  return pulse;
}

namespace {

// A stretch of at least three samples that stays at `value` and is entered or left by more than `corner` in one sample.
bool has_plateau(const Eigen::VectorXd& x, double value, double corner) {
  Index j = 0;
  while (j < x.size()) {
    if (x(j) != value) {
      ++j;
      continue;
    }
    Index end = j;
    while (end < x.size() && x(end) == value) ++end;
    const double in = j > 0 ? std::abs(x(j) - x(j - 1)) : 0.0;
    const double out = end < x.size() ? std::abs(x(end) - x(end - 1)) : 0.0;
    if (end - j >= 3 && std::max(in, out) > corner) return true;
    j = end;
  }
  return false;
}

}  // namespace

bool has_flat_top(const Eigen::VectorXd& samples) {
  // The converter's step: the smallest change that occurs. The top of a slow wave may rest within one step without
  // being clipped.
  double step = std::numeric_limits<double>::infinity();
  for (Index j = 1; j < samples.size(); ++j) {
    const double change = std::abs(samples(j) - samples(j - 1));
    if (change > 0.0) step = std::min(step, change);
  }
  const double highest = samples.maxCoeff();
  const double lowest = samples.minCoeff();
  for (const double extreme : {highest, lowest}) {
    // A record that only ever goes one way rests at its other extreme.
    if (std::abs(extreme) < 0.2 * std::max(std::abs(highest), std::abs(lowest))) continue;
    // Files round to some digits: what differs less than 1e-4 of the extreme may have been rounded together. No
    // converter that is used to 0.2 % of its range needs judging.
    const double size = std::abs(extreme);
    if (has_plateau(samples, extreme, 4.0 * std::clamp(step, 1e-4 * size, 2e-3 * size))) return true;
  }
  return false;
}

}  // namespace robomill::modal
