#include "robomill/stability/vibration/steady_vibration.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/stability/vibration/motion.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

/// (1/P) ∫ F e^{-iwθ} dθ over a period.
Eigen::Vector3cd harmonic_of(const SteadyForce& force, double w) {
  Eigen::Vector3cd sum = Eigen::Vector3cd::Zero();
  for (const ForceStretch& f : force.stretches) {
    const auto over = [&](double h) { return turned(h - w, f.from_rad, f.to_rad); };
    sum += f.mean.cast<Complex>() * over(0.0);
    sum += 0.5 * (f.first * over(1.0) + f.first.conjugate() * over(-1.0));
    sum += 0.5 * (f.second * over(2.0) + f.second.conjugate() * over(-2.0));
  }
  return sum / force.period_rad;
}

/// Of samples over a period the j-th harmonic, q = Σ_j q_j e^{ijt}.
Eigen::Vector3cd harmonic_of(const Eigen::Matrix3Xd& path, int j) {
  const Complex turn = std::polar(1.0, -units::revolution * j / static_cast<double>(path.cols()));
  Eigen::Vector3cd sum = Eigen::Vector3cd::Zero();
  Complex now = 1.0;
  for (Eigen::Index i = 0; i < path.cols(); ++i) {
    sum += path.col(i).cast<Complex>() * now;
    now *= turn;
  }
  return sum / static_cast<double>(path.cols());
}

}  // namespace

Complex turned(double w, double from_rad, double to_rad) {
  const double length = to_rad - from_rad;
  const double half = 0.5 * w * length;
  const double sinc = std::abs(half) < 1e-8 ? 1.0 : std::sin(half) / half;
  return length * sinc * std::polar(1.0, 0.5 * w * (from_rad + to_rad));
}

double greatest(const Eigen::Vector3cd& q) {
  const double squares = q.squaredNorm();
  const double turning = std::abs((q.transpose() * q).value());
  return 2.0 * std::sqrt(0.5 * (squares + turning));
}

double half_extent(const Eigen::Matrix3Xd& path) {
  constexpr int most_turns = 20;
  double widest = 0.0;
  for (int code = 14; code < 27; ++code) {  // of the 26 neighbours of a cube's middle one of each opposite pair
    Eigen::Vector3d along = Eigen::Vector3i(code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1).cast<double>();
    double width = 0.0;
    for (int turn = 0; turn < most_turns; ++turn) {
      Eigen::Index low = 0, high = 0;
      const Eigen::RowVectorXd reach = along.transpose() * path;
      reach.minCoeff(&low);
      reach.maxCoeff(&high);
      const Eigen::Vector3d apart = path.col(high) - path.col(low);
      if (!(apart.norm() > width)) break;
      width = apart.norm();
      along = apart;
    }
    widest = std::max(widest, width);
  }
  return 0.5 * widest;
}

void set_mode(ForcedVibration& vibration, const MovedMode& mode) {
  vibration.mode = mode.id;
  vibration.mode_frequency_hz = mode.frequency_hz;
  vibration.mode_m = 2.0 * mode.displacement_m;
}

ForcedVibration vibration_of(const TipDynamicsIn<3>& tip, const SteadyPath& steady) {
  const double base = units::revolution / steady.force.period_rad * steady.spindle_speed_rad_per_s;
  // Above the fastest mode a structure moves less and less.
  const double fastest = tip.pole.cwiseAbs().maxCoeff();
  const int samples = static_cast<int>(steady.path.cols());
  const int last = std::min(static_cast<int>(std::min(1.5 * fastest / base, 1e6)) + 4, samples / 2);
  ForcedVibration out;
  if (!steady.path.allFinite()) return out;  // there is no periodic motion
  out.harmonic_m = 0.0;
  for (int j = 1; j <= last; ++j) {
    const double moved_m = greatest(harmonic_of(steady.path, j));
    if (moved_m <= out.harmonic_m) continue;
    out.harmonic_m = moved_m;
    out.harmonic = j;
  }
  out.amplitude_m = half_extent(steady.path);
  out.of_tooth_passing = steady.force.equal_teeth;
  if (out.harmonic == 0) return out;
  out.frequency_hz = base * out.harmonic / units::revolution;
  const double per_rad = units::revolution / steady.force.period_rad * out.harmonic;
  set_mode(out, most_moved<3>(tip, Complex(0.0, base * out.harmonic), harmonic_of(steady.force, per_rad)));
  return out;
}

}  // namespace robomill::stability::detail
