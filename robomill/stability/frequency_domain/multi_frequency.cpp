#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/frequency_domain/contact_basis.hpp"
#include "robomill/stability/frequency_domain/crossings.hpp"
#include "robomill/stability/frequency_domain/frequency_domain.hpp"

namespace robomill::stability {
namespace {

using namespace detail;
using std::numbers::pi;
constexpr int first_level = 0, last_level = 6;

/// One spindle speed.
class Solver {
 public:
  Solver(const cutting::Milling& milling, const FrequencyResponse& response, double speed,
         const FrequencyOptions& options)
      : milling_(milling), response_(response), speed_(speed), options_(options) {
    const double least = 1e-3 * response.highest_peak();
    for (const Resonance& r : response.resonances()) {
      if (response.at(r.frequency_rad_per_s).norm() < least) continue;
      counting_.push_back(r);
      highest_ = std::max(highest_, r.frequency_rad_per_s);
    }
    for (int j = 0; j < milling.tool.teeth; ++j) helix_ = helix_ || milling.tool.lag_rad_per_m(j) != 0.0;
  }

  FrequencyLimit run() {
    FrequencyLimit limit;
    limit.spindle_speed_rad_per_s = speed_;
    const std::optional<Found> first = helix_ ? first_by_depth() : first_crossing(limit);
    if (!first) return limit;
    Found found = *first;
    limit.status = FrequencyLimit::Status::not_converged;
    for (int level = first_level + 1; level <= last_level; ++level) {
      const std::optional<Found> finer = refined(found, level);
      if (!finer) break;
      limit.error_estimate_m = std::abs(finer->depth_m - found.depth_m);
      found = *finer;
      if (limit.error_estimate_m > options_.tolerance * found.depth_m) continue;
      limit.status = FrequencyLimit::Status::found;
      break;
    }
    describe(found, limit);
    return limit;
  }

 private:
  struct Found {
    double depth_m = 0.0;
    GainCrossing crossing;
    std::shared_ptr<const ContactBasis> basis;
  };

  [[nodiscard]] std::shared_ptr<const ContactBasis> basis(double depth_m, int level) const {
    ContactBasis::Size size;
    size.highest_rad_per_s = highest_;
    size.extra = 4 + 3 * level;
    size.harmonics = 80 << level;
    size.interpolated = level == first_level;
    return std::make_shared<const ContactBasis>(milling_, response_, speed_, depth_m, size);
  }
  [[nodiscard]] static MatrixAt matrix_of(const ContactBasis& basis) {
    return [&basis](double omega, Eigen::MatrixXcd& out) { basis.matrix(omega, out); };
  }

  /// Resonances stand at ω where ω + n ω_P is their frequency.
  [[nodiscard]] std::vector<GainCrossing> crossings(const ContactBasis& basis, double largest_depth_m) const {
    Sweep sweep;
    const double period = basis.period_frequency_rad_per_s();
    sweep.to = 0.5 * period;
    sweep.largest_gain = largest_depth_m;
    sweep.real_from = sweep.real_to = true;
    for (int i = 1; i < 12; ++i) sweep.nodes.push_back(sweep.to * i / 12.0);
    for (const Resonance& r : counting_) {
      for (const double widths : {-10.0, -4.0, -1.5, -0.5, 0.5, 1.5, 4.0, 10.0}) {
        const double away = widths * r.half_width_rad_per_s;
        if (std::abs(away) > sweep.to) continue;
        double folded = std::fmod(std::abs(r.frequency_rad_per_s + away), period);
        if (folded > sweep.to) folded = period - folded;
        sweep.nodes.push_back(folded);
      }
    }
    return find_crossings(matrix_of(basis), sweep);
  }

  std::optional<Found> first_crossing(FrequencyLimit& limit) const {
    const auto level0 = basis(options_.largest_depth_m, first_level);
    // Fewer eigenvalues count for a small depth: the first crossing is looked for from there.
    std::vector<GainCrossing> all;
    for (double share = options_.all_crossings ? 1.0 : 1.0 / 64.0; share <= 1.0 && all.empty(); share *= 4.0) {
      all = crossings(*level0, share * options_.largest_depth_m);
    }
    for (const GainCrossing& c : all) {
      const Motion motion = motion_of({c.gain, c, level0});
      limit.crossings.push_back({c.gain, motion.frequency_hz, kind_of(c), c.opens});
    }
    if (all.empty()) return std::nullopt;
    return Found{all.front().gain, all.front(), level0};
  }

  /// With helix the matrix itself depends on the depth: at a depth the cut is unstable where, with that lag, more roots
  /// have crossed to the right than to the left below it.
  struct Look {
    double depth_m = 0.0;
    bool unstable = false;
    double nearest_ratio = 1e300;  ///< least crossing above the depth, over the depth
    std::optional<Found> lowest = {};
  };
  [[nodiscard]] Look look(double depth_m) const {
    Look out{.depth_m = depth_m};
    const auto level0 = basis(depth_m, first_level);
    int count = 0;
    for (const GainCrossing& c : crossings(*level0, 1.5 * depth_m)) {
      if (c.gain > depth_m) {
        out.nearest_ratio = std::min(out.nearest_ratio, c.gain / depth_m);
        continue;
      }
      count += c.opens ? 1 : -1;
      if (c.opens) out.lowest = Found{depth_m, c, level0};  // the last that opened: the one nearest to the depth
    }
    out.unstable = count > 0;
    return out;
  }

  std::optional<Found> first_by_depth() const {
    // What the helix changes repeats with the height on which it passes a pitch.
    const double pitch_rad = 2.0 * pi / milling_.tool.teeth;
    const double passes = std::abs(milling_.tool.lag_rad_per_m(0)) * options_.largest_depth_m / pitch_rad;
    const int depths = static_cast<int>(std::clamp(std::ceil(12.0 * passes), 6.0, 400.0));
    std::vector<Look> looks = {Look{}};
    for (int i = 1; i <= depths; ++i) {
      looks.push_back(look(options_.largest_depth_m * i / depths));
      const std::size_t n = looks.size();
      if (looks.back().unstable) return between(looks[n - 2].depth_m, looks.back());
      // An island may hide where the crossings come near and go away again.
      if (n < 4) continue;
      const Look hidden = closest(looks[n - 3], looks[n - 2], looks[n - 1]);
      if (hidden.unstable) return between(looks[n - 3].depth_m, hidden);
    }
    return std::nullopt;
  }

  [[nodiscard]] Look closest(Look low, Look middle, Look high) const {
    for (int step = 0; step < 5; ++step) {
      const bool minimum = middle.nearest_ratio <= low.nearest_ratio && middle.nearest_ratio <= high.nearest_ratio;
      if (!minimum || middle.nearest_ratio > 1.2) break;
      Look left = look(0.5 * (low.depth_m + middle.depth_m));
      if (left.unstable) return left;
      Look right = look(0.5 * (middle.depth_m + high.depth_m));
      if (right.unstable) return right;
      if (left.nearest_ratio < middle.nearest_ratio && left.nearest_ratio <= right.nearest_ratio) {
        high = middle;
        middle = left;
      } else if (right.nearest_ratio < middle.nearest_ratio) {
        low = middle;
        middle = right;
      } else {
        low = left;
        high = right;
      }
    }
    return middle;
  }

  /// Halves until the crossing that opens can be followed to its own depth.
  std::optional<Found> between(double stable_m, Look unstable) const {
    for (int step = 0; step < 40 && unstable.depth_m - stable_m > 1e-9 * unstable.depth_m; ++step) {
      if (step >= 3) {
        std::optional<Found> found = refined(*unstable.lowest, first_level);
        if (found && found->depth_m > stable_m && found->depth_m <= unstable.depth_m) return found;
      }
      Look middle = look(0.5 * (stable_m + unstable.depth_m));
      if (middle.unstable && middle.lowest) {
        unstable = middle;
      } else {
        stable_m = middle.depth_m;
      }
    }
    return unstable.lowest;
  }

  /// The same crossing with more polynomials and harmonics; with helix the depth at which it is its own lag's.
  std::optional<Found> refined(const Found& from, int level) const {
    Found now = from;
    double before_m = 0.0, miss_before_m = 0.0;
    for (int step = 0; step < 40; ++step) {
      now.basis = basis(now.depth_m, level);
      now.crossing = follow(matrix_of(*now.basis), now.crossing);
      if (now.crossing.gain == 0.0) return std::nullopt;
      const double miss_m = now.crossing.gain - now.depth_m;
      if (!helix_ || std::abs(miss_m) <= 1e-11 * now.depth_m) {
        now.depth_m = now.crossing.gain;
        return now;
      }
      double next_m = now.crossing.gain;
      if (step > 0 && miss_m != miss_before_m) {
        next_m = now.depth_m - miss_m * (now.depth_m - before_m) / (miss_m - miss_before_m);
      }
      before_m = now.depth_m;
      miss_before_m = miss_m;
      now.depth_m = std::clamp(next_m, 0.8 * before_m, 1.25 * before_m);
    }
    return std::nullopt;
  }

  struct Motion {
    double frequency_hz = 0.0;
    modal::ModeId mode;
  };
  [[nodiscard]] Motion motion_of(const Found& found) const {
    Eigen::MatrixXcd work;
    found.basis->matrix(found.crossing.frequency, work);
    Eigen::VectorXcd force;
    nearest_eigenvalue(work, 1.0 / found.crossing.gain, force);
    Motion motion;
    double largest = 0.0, largest_share = 0.0;
    for (int n = -found.basis->near(); n <= found.basis->near(); ++n) {
      const double omega = found.crossing.frequency + n * found.basis->period_frequency_rad_per_s();
      const Eigen::Vector2cd harmonic = found.basis->harmonic(force, found.crossing.frequency, n);
      const double displacement = (response_.at(omega) * harmonic).norm();
      if (displacement > largest * (1.0 + 1e-9)) {
        largest = displacement;
        motion.frequency_hz = std::abs(omega) / (2.0 * pi);
      }
      const MovedMode moved = response_.mode_of(omega, harmonic);
      if (moved.displacement_m > largest_share) {
        largest_share = moved.displacement_m;
        motion.mode = moved.id;
      }
    }
    return motion;
  }

  static BifurcationType kind_of(const GainCrossing& crossing) {
    switch (crossing.at) {
      case GainCrossing::At::from:
        return BifurcationType::fold;
      case GainCrossing::At::to:
        return BifurcationType::flip;
      default:
        return BifurcationType::hopf;
    }
  }

  void describe(const Found& found, FrequencyLimit& limit) const {
    const Motion motion = motion_of(found);
    limit.axial_depth_m = found.depth_m;
    limit.chatter_frequency_hz = motion.frequency_hz;
    limit.mode = motion.mode;
    limit.kind = kind_of(found.crossing);
    const DepthCrossing lowest = {found.depth_m, motion.frequency_hz, limit.kind, true};
    if (limit.crossings.empty()) {
      limit.crossings = {lowest};
    } else {
      limit.crossings.front() = lowest;
    }
    if (!response_.measured()) return;
    Eigen::MatrixXcd covered;
    found.basis->matrix(found.crossing.frequency, covered, true);
    Eigen::VectorXcd unused;
    const std::complex<double> value = nearest_eigenvalue(covered, 1.0 / found.crossing.gain, unused);
    limit.uncovered_ratio = std::abs(value * found.crossing.gain - 1.0);
  }

  const cutting::Milling& milling_;
  const FrequencyResponse& response_;
  double speed_, highest_ = 0.0;
  const FrequencyOptions& options_;
  bool helix_ = false;
  std::vector<Resonance> counting_;  ///< the others are below a thousandth of the highest
};

}  // namespace

std::vector<FrequencyLimit> multi_frequency_limits(const cutting::Milling& milling, const FrequencyResponse& response,
                                                   const std::vector<double>& spindle_speeds_rad_per_s,
                                                   const FrequencyOptions& options, Progress& progress) {
  require_frequency_domain(milling);
  options.validate();
  for (const double speed : spindle_speeds_rad_per_s) cutting::require_spindle_speed("spindle_speed_rad_per_s", speed);
  std::vector<FrequencyLimit> limits(spindle_speeds_rad_per_s.size());
  progress.start("multi-frequency limits", limits.size());
  parallel_for(limits.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      limits[i] = Solver(milling, response, spindle_speeds_rad_per_s[i], options).run();
      progress.advance();
    }
  });
  return limits;
}

}  // namespace robomill::stability
