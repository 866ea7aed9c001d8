#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/frequency_domain/contact_basis.hpp"
#include "robomill/stability/frequency_domain/crossings.hpp"
#include "robomill/stability/frequency_domain/frequency_domain.hpp"
#include "robomill/stability/gauss.hpp"

namespace robomill::stability {
namespace {

using namespace detail;
using std::numbers::pi;
using Complex = std::complex<double>;

/// Σ_j (1 - exp(-iω τ_j)) K̄_j + iω C̄, per axial depth.
class MeanCut {
 public:
  MeanCut(const cutting::Milling& milling, double spindle_speed_rad_per_s) {
    for (int j = 0; j < milling.tool.teeth; ++j) {
      const double delay_s = milling.tool.pitch(j) / spindle_speed_rad_per_s;
      delays_.push_back({cutting::mean_cutting_stiffness(milling, j, 0.0, 2.0 * pi, 1.0), delay_s});
    }
    if (!milling.process_damping.active()) return;
    cutting::Milling straight = milling;
    straight.tool.helix_rad = 0.0;
    straight.tool.tooth_helix_rad.clear();
    const GaussRule& rule = gauss_rule(24);
    const double entry = milling.immersion.entry_rad;
    const double arc = milling.immersion.exit_rad - entry;
    for (std::size_t q = 0; q < rule.node.size(); ++q) {
      damping_ += (milling.tool.teeth * arc * rule.weight[q] / (2.0 * pi)) *
                  cutting::cutting_damping(straight, 0, entry + arc * rule.node[q], 0.0, 1.0, spindle_speed_rad_per_s);
    }
  }
  [[nodiscard]] Eigen::Matrix2cd at(double omega) const {
    Eigen::Matrix2cd sum = Complex(0.0, omega) * damping_.cast<Complex>();
    for (const Tooth& t : delays_) sum += (1.0 - std::polar(1.0, -omega * t.delay_s)) * t.stiffness.cast<Complex>();
    return sum;
  }

 private:
  struct Tooth {
    Eigen::Matrix2d stiffness;
    double delay_s;
  };
  std::vector<Tooth> delays_;
  Eigen::Matrix2d damping_ = Eigen::Matrix2d::Zero();
};

Sweep sweep_of(const FrequencyResponse& response, double tooth_frequency, double largest_depth_m) {
  Sweep sweep;
  sweep.largest_gain = largest_depth_m;
  const std::vector<Resonance>& resonances = response.resonances();
  sweep.from = response.measured() ? response.low_rad_per_s() : 1e-3 * resonances.front().frequency_rad_per_s;
  sweep.to = response.measured() ? response.high_rad_per_s() : 4.0 * resonances.back().frequency_rad_per_s;
  const int turns = static_cast<int>(std::min(6.0 * (sweep.to - sweep.from) / tooth_frequency, 20000.0)) + 16;
  for (int i = 1; i < turns; ++i) sweep.nodes.push_back(sweep.from + (sweep.to - sweep.from) * i / turns);
  for (const Resonance& r : resonances) {
    for (const double widths : {-8.0, -3.0, -1.0, 0.0, 1.0, 3.0, 8.0}) {
      sweep.nodes.push_back(r.frequency_rad_per_s + widths * r.half_width_rad_per_s);
    }
  }
  return sweep;
}

FrequencyLimit limit_at(const cutting::Milling& milling, const FrequencyResponse& response, double speed,
                        const FrequencyOptions& options) {
  const MeanCut cut(milling, speed);
  const MatrixAt matrix = [&](double omega, Eigen::MatrixXcd& out) { out = cut.at(omega) * response.at(omega); };
  const Sweep sweep = sweep_of(response, speed * milling.tool.teeth, options.largest_depth_m);
  FrequencyLimit limit;
  limit.spindle_speed_rad_per_s = speed;
  const std::vector<GainCrossing> crossings = find_crossings(matrix, sweep);
  for (const GainCrossing& c : crossings) {
    limit.crossings.push_back({c.gain, c.frequency / (2.0 * pi), BifurcationType::hopf, c.opens});
  }
  if (crossings.empty()) return limit;
  const GainCrossing& lowest = crossings.front();
  limit.status = FrequencyLimit::Status::found;
  limit.axial_depth_m = lowest.gain;
  limit.chatter_frequency_hz = lowest.frequency / (2.0 * pi);
  Eigen::MatrixXcd work;
  matrix(lowest.frequency, work);
  Eigen::VectorXcd force;
  nearest_eigenvalue(work, 1.0 / lowest.gain, force);
  limit.mode = response.mode_of(lowest.frequency, force).id;
  return limit;
}

}  // namespace

std::vector<FrequencyLimit> zeroth_order_limits(const cutting::Milling& milling, const FrequencyResponse& response,
                                                const std::vector<double>& spindle_speeds_rad_per_s,
                                                const FrequencyOptions& options, Progress& progress) {
  require_frequency_domain(milling);
  options.validate();
  for (const double speed : spindle_speeds_rad_per_s) cutting::require_spindle_speed("spindle_speed_rad_per_s", speed);
  std::vector<FrequencyLimit> limits(spindle_speeds_rad_per_s.size());
  if (response.resonances().empty()) return limits;
  progress.start("zeroth-order limits", limits.size());
  parallel_for(limits.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      limits[i] = limit_at(milling, response, spindle_speeds_rad_per_s[i], options);
      progress.advance();
    }
  });
  return limits;
}

}  // namespace robomill::stability
