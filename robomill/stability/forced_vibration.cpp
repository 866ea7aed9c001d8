#include "robomill/stability/forced_vibration.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/chip.hpp"

namespace robomill::stability {
namespace {

using Complex = std::complex<double>;

/// ∫ e^{iwφ} dφ from..to.
Complex turned(double w, double from_rad, double to_rad) {
  const double length = to_rad - from_rad;
  const double half = 0.5 * w * length;
  const double sinc = std::abs(half) < 1e-8 ? 1.0 : std::sin(half) / half;
  return length * sinc * std::polar(1.0, 0.5 * w * (from_rad + to_rad));
}

/// Force on the tool per axial depth while a tooth cuts the chip slope sin φ + offset, as Σ_m c_m e^{imφ}, m = -2 … 2.
struct AngleHarmonics {
  Eigen::Vector2cd c[5];
};
AngleHarmonics angle_harmonics(const cutting::ForceCoefficients& k, double slope_m, double offset_m) {
  const double ts = k.tangential_n_per_m2 * slope_m;
  const double rs = k.radial_n_per_m2 * slope_m;
  const double t0 = k.tangential_n_per_m2 * offset_m + k.tangential_edge_n_per_m;
  const double r0 = k.radial_n_per_m2 * offset_m + k.radial_edge_n_per_m;
  // F = -(T cos φ + R sin φ, R cos φ - T sin φ), T = t0 + ts sin φ, R = r0 + rs sin φ.
  const Complex i(0.0, 1.0);
  AngleHarmonics h;
  h.c[2] = -0.5 * Eigen::Vector2cd(rs, -ts);                      // of sin² φ: the mean
  h.c[3] = -0.5 * Eigen::Vector2cd(t0 - i * r0, r0 + i * t0);     // of cos φ and sin φ
  h.c[4] = -0.25 * Eigen::Vector2cd(-i * ts - rs, -i * rs + ts);  // of sin 2φ and cos 2φ
  h.c[1] = h.c[3].conjugate();
  h.c[0] = h.c[4].conjugate();
  return h;
}

/// Fourier coefficients of the force over a revolution, F(θ) = Σ_k F_k e^{ikθ}, of every `step`-th k from `step` on.
std::vector<Eigen::Vector2cd> force_harmonics(const cutting::Milling& m, double axial_depth_m, int step, int count) {
  const cutting::FlatEndMill& tool = m.tool;
  const bool alike_up = tool.runout_m == 0.0 && tool.has_equal_helix();
  // Where chips change along the edge it is cut into slices, else lagging along it is a factor.
  constexpr int slices = 60;
  const int heights = alike_up ? 1 : slices;
  const double height_m = axial_depth_m / heights;
  const cutting::Arc arc = {.entry_rad = m.immersion.entry_rad, .exit_rad = m.immersion.exit_rad};
  const cutting::detail::Forwards forwards = {.mean = 0.0, .amplitude = 1.0, .middle_rad = 0.5 * std::numbers::pi};
  std::vector<Eigen::Vector2cd> out(static_cast<std::size_t>(count), Eigen::Vector2cd::Zero());
  cutting::detail::ChipShare chips;
  for (int h = 0; h < heights; ++h) {
    for (int tooth = 0; tooth < tool.teeth; ++tooth) {
      const double lag = tool.lag_rad_per_m(tooth);
      chips.set(tool, tooth, (h + 0.5) * height_m, 1.0, m.feed_per_tooth_m * tool.teeth);
      double missed_rad = 0.0;
      for (const cutting::detail::ChipPiece& piece : chips.pieces(arc, forwards, missed_rad)) {
        const AngleHarmonics f = angle_harmonics(m.coefficients, piece.slope_m, piece.offset_m);
        for (int j = 0; j < count; ++j) {
          const double k = static_cast<double>(step) * (j + 1);
          Eigen::Vector2cd sum = Eigen::Vector2cd::Zero();
          for (int n = -2; n <= 2; ++n) sum += f.c[n + 2] * turned(n - k, piece.from_rad, piece.to_rad);
          const Complex along = turned(-k * lag, h * height_m, (h + 1) * height_m);
          out[static_cast<std::size_t>(j)] +=
              sum * (along * std::polar(1.0 / units::revolution, k * tool.standing_angle(tooth)));
        }
      }
    }
  }
  return out;
}

/// Greatest |Re(2 q e^{iωt})| over t.
double greatest(const Eigen::Vector2cd& q) {
  const double squares = q.squaredNorm();
  const double turning = std::abs(q.x() * q.x() + q.y() * q.y());
  return 2.0 * std::sqrt(0.5 * (squares + turning));
}

/// Half the peak to peak of Σ 2 Re(q_j e^{i(j+1)t}), in the direction in which it is greatest.
double half_width(const std::vector<Eigen::Vector2cd>& q) {
  constexpr int directions = 36;  // within cos 2.5° = 0.1 %
  const int samples = std::clamp(8 * static_cast<int>(q.size()), 64, 4800);
  std::vector<Eigen::Vector2d> path(static_cast<std::size_t>(samples), Eigen::Vector2d::Zero());
  for (int s = 0; s < samples; ++s) {
    const Complex turn = std::polar(1.0, units::revolution * s / samples);
    Complex now = turn;
    for (const Eigen::Vector2cd& part : q) {
      path[static_cast<std::size_t>(s)] += 2.0 * (part * now).real();
      now *= turn;
    }
  }
  double widest = 0.0;
  for (int d = 0; d < directions; ++d) {
    const double angle = std::numbers::pi * d / directions;
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    const auto [low, high] = std::ranges::minmax(path, {}, [&](const Eigen::Vector2d& p) { return along.dot(p); });
    widest = std::max(widest, along.dot(high - low));
  }
  return 0.5 * widest;
}

/// Of modes, or of measured FRFs, and of what stands across from them.
FrequencyResponse response_of(const LobesProblem& problem) {
  if (!problem.has_measured()) return FrequencyResponse::of_modes(problem);
  FrequencyResponse response;
  const auto part = [&](const modal::FrfSet& frfs, const modal::ModalModel& modes, const std::vector<int>& keep,
                        modal::ModeOwner owner) {
    if (!frfs.frfs.empty()) {
      response += FrequencyResponse::of_frfs(frfs, problem.feed_direction_rad);
    } else if (!modes.modes.empty()) {
      response += FrequencyResponse::of_modes(modal::tip_modes(modes, keep, problem.feed_direction_rad, owner));
    }
  };
  part(problem.measured, problem.dynamics, problem.keep_modes, modal::ModeOwner::tool);
  part(problem.workpiece_measured, problem.workpiece_dynamics, {}, modal::ModeOwner::workpiece);
  return response;
}

}  // namespace

ForcedResponse::ForcedResponse(const LobesProblem& problem) : milling_(problem.milling) {
  problem.validate();
  problem.require_plane("forced vibration");
  require_positive("feed_per_tooth_m", milling_.feed_per_tooth_m, "m");
  response_ = response_of(problem);
  equal_teeth_ = milling_.tool.has_equal_pitch() && milling_.tool.has_equal_helix() && milling_.tool.runout_m == 0.0;
}

ForcedVibration ForcedResponse::at(const OperatingPoint& point) const {
  require_positive("axial_depth_m", point.axial_depth_m, "m");
  require_positive("spindle_speed_rad_per_s", point.spindle_speed_rad_per_s, "rad/s");
  const int step = equal_teeth_ ? milling_.tool.teeth : 1;
  const double base = step * point.spindle_speed_rad_per_s;
  double highest = 0.0;
  for (const Resonance& r : response_.resonances()) highest = std::max(highest, r.frequency_rad_per_s);
  constexpr int most = 600;
  const int count =
      std::min(most, std::max(static_cast<int>(2.5 * highest / base) + 1, 12 * milling_.tool.teeth / step));
  const std::vector<Eigen::Vector2cd> force = force_harmonics(milling_, point.axial_depth_m, step, count);
  std::vector<Eigen::Vector2cd> q(force.size());
  std::size_t strongest = 0;
  for (std::size_t j = 0; j < force.size(); ++j) {
    q[j] = response_.at(base * static_cast<double>(j + 1)) * force[j];
    if (greatest(q[j]) > greatest(q[strongest])) strongest = j;
  }
  ForcedVibration out;
  out.amplitude_m = half_width(q);
  out.harmonic = static_cast<int>(strongest) + 1;
  out.of_tooth_passing = equal_teeth_;
  out.frequency_hz = base * out.harmonic / units::revolution;
  out.harmonic_m = greatest(q[strongest]);
  double mode_m = 0.0;
  out.mode = response_.mode_of(base * out.harmonic, force[strongest], mode_m);
  out.mode_m = 2.0 * mode_m;
  return out;
}

}  // namespace robomill::stability
