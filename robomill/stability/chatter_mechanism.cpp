#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/stability/frequency_domain/contact_basis.hpp"
#include "robomill/stability/peak_classification.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

/// dz/dt = λ z + Lᵀ F with F = K(t) q + C(t) dq/dt, q = 2 Re R z + S F, one column of z a start vector.
class WithoutDelay {
 public:
  WithoutDelay(const LobesProblem& problem, const OperatingPoint& point)
      : milling_(problem.milling), tip_(detail::tip_dynamics(problem)), point_(point) {
    direct_ = 2.0 * (tip_.right * tip_.left.transpose()).real();
    equal_ = milling_.tool.has_equal_pitch() && milling_.tool.has_equal_helix();
  }

  double spectral_radius() const {
    const Eigen::Index n = tip_.pole.size();
    const double period_rad = equal_ ? 2.0 * pi / milling_.tool.teeth : 2.0 * pi;
    Eigen::MatrixXcd z(n, 2 * n);
    z << Eigen::MatrixXcd::Identity(n, n), Complex(0.0, 1.0) * Eigen::MatrixXcd::Identity(n, n);
    std::vector<double> edges = detail::contact_angles(milling_, point_.axial_depth_m, period_rad);
    if (edges.empty() || edges.front() > 0.0) edges.insert(edges.begin(), 0.0);
    edges.push_back(period_rad);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) advance(z, edges[i], edges[i + 1]);
    Eigen::MatrixXd whole(2 * n, 2 * n);
    whole << z.real(), z.imag();
    if (!whole.allFinite()) return 1e100;
    return std::min(1e100, linear_algebra::eigenvalues(whole).cwiseAbs().maxCoeff());
  }

 private:
  /// Between two angles at which nothing enters or leaves. The steps follow the fastest mode and the cut.
  void advance(Eigen::MatrixXcd& z, double from_rad, double to_rad) const {
    const double duration_s = (to_rad - from_rad) / point_.spindle_speed_rad_per_s;
    if (stiffness(0.5 * (from_rad + to_rad)).isZero(0.0)) {
      z = (tip_.pole * duration_s).array().exp().matrix().asDiagonal() * z;
      return;
    }
    const double turns = tip_.pole.cwiseAbs().maxCoeff() * duration_s / 0.05;
    const int steps = static_cast<int>(std::clamp(std::ceil(turns), 24.0, 200000.0));
    const double h = duration_s / steps;
    const Eigen::VectorXcd half = (tip_.pole * (0.5 * h)).array().exp();
    for (int i = 0; i < steps; ++i) {
      // A point of the ends themselves belongs to this arc and not to its neighbour.
      const double inside = 1e-9 * (to_rad - from_rad);
      const auto angle = [&](double step) {
        return std::clamp(from_rad + (to_rad - from_rad) * (i + step) / steps, from_rad + inside, to_rad - inside);
      };
      const Eigen::Matrix4d start = feedback(angle(0.0)), middle = feedback(angle(0.5)), end = feedback(angle(1.0));
      const Eigen::MatrixXcd z_half = half.asDiagonal() * z;
      const Eigen::MatrixXcd k1 = half.asDiagonal() * push(start, z);
      const Eigen::MatrixXcd k2 = push(middle, z_half + 0.5 * h * k1);
      const Eigen::MatrixXcd k3 = push(middle, z_half + 0.5 * h * k2);
      const Eigen::MatrixXcd k4 = push(end, half.asDiagonal() * (z_half + h * k3));
      z = half.asDiagonal() * (z_half + (h / 6.0) * (k1 + 2.0 * k2 + 2.0 * k3)) + (h / 6.0) * k4;
    }
  }

  [[nodiscard]] Eigen::Matrix2d stiffness(double angle_rad) const {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (int j = 0; j < milling_.tool.teeth; ++j) {
      sum += cutting::cutting_stiffness(milling_, j, angle_rad, point_.axial_depth_m);
    }
    return sum;
  }

  /// F = [P Q] of the modes' displacement and velocity, in the upper two rows.
  [[nodiscard]] Eigen::Matrix4d feedback(double angle_rad) const {
    const Eigen::Matrix2d k = stiffness(angle_rad);
    Eigen::Matrix2d c = Eigen::Matrix2d::Zero();
    if (milling_.process_damping.active()) {
      for (int j = 0; j < milling_.tool.teeth; ++j) {
        c +=
            cutting::cutting_damping(milling_, j, angle_rad, 0.0, point_.axial_depth_m, point_.spindle_speed_rad_per_s);
      }
    }
    // dq/dt of the modes holds F itself where 2 Re R Lᵀ is not zero.
    const Eigen::Matrix2d solve = (Eigen::Matrix2d::Identity() - k * tip_.compliance - c * direct_).inverse();
    Eigen::Matrix4d out = Eigen::Matrix4d::Zero();
    out.topLeftCorner<2, 2>() = solve * k;
    out.topRightCorner<2, 2>() = solve * c;
    return out;
  }

  [[nodiscard]] Eigen::MatrixXcd push(const Eigen::Matrix4d& gain, const Eigen::MatrixXcd& z) const {
    const Eigen::MatrixXd displacement = 2.0 * (tip_.right * z).real();
    const Eigen::MatrixXd velocity = 2.0 * (tip_.right * tip_.pole.asDiagonal() * z).real();
    const Eigen::MatrixXd force = gain.topLeftCorner<2, 2>() * displacement + gain.topRightCorner<2, 2>() * velocity;
    return tip_.left.transpose() * force.cast<Complex>();
  }

  const cutting::Milling& milling_;
  detail::TipDynamics tip_;
  OperatingPoint point_;
  Eigen::Matrix2d direct_;
  bool equal_ = true;
};

}  // namespace

std::string_view to_string(ChatterMechanism::Kind kind) {
  return name_in(mechanism_names, kind);
}

ChatterMechanism chatter_mechanism(const LobesProblem& problem, const OperatingPoint& point) {
  const PointResult with = evaluate_point(problem, {}, point);
  ChatterMechanism verdict;
  verdict.spectral_radius = with.spectral_radius;
  verdict.without_delay = WithoutDelay(problem, point).spectral_radius();
  verdict.chatter_frequency_hz = with.chatter_frequency_hz;
  verdict.mode = with.mode;
  if (!with.stable) {
    verdict.kind =
        verdict.without_delay >= 1.0 ? ChatterMechanism::Kind::mode_coupling : ChatterMechanism::Kind::regenerative;
  }
  return verdict;
}

}  // namespace robomill::stability
