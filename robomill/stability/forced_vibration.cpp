#include "robomill/stability/forced_vibration.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/chip.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/vibration/steady_vibration.hpp"
#include "robomill/stability/vibration/surface_error_spatial.hpp"

namespace robomill::stability {
namespace {

using Complex = std::complex<double>;
using detail::turned;

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

Eigen::Vector3cd in_space(const Eigen::Vector2cd& q) {
  return {q.x(), q.y(), 0.0};
}

/// Half the greatest extent of Σ 2 Re(q_j e^{i(j+1)t}).
double half_width(const std::vector<Eigen::Vector2cd>& q) {
  const int samples = std::clamp(8 * static_cast<int>(q.size()), 64, 4800);
  Eigen::Matrix3Xd path = Eigen::Matrix3Xd::Zero(3, samples);
  for (int s = 0; s < samples; ++s) {
    const Complex turn = std::polar(1.0, units::revolution * s / samples);
    Complex now = turn;
    for (const Eigen::Vector2cd& part : q) {
      path.col(s).head<2>() += 2.0 * (part * now).real();
      now *= turn;
    }
  }
  return detail::half_extent(path);
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

struct ForcedResponse::Spatial {
  explicit Spatial(const LobesProblem& of) : problem(of), surface(problem) {}
  LobesProblem problem;
  detail::SpatialSurface surface;
};

ForcedResponse::ForcedResponse(const LobesProblem& problem) : milling_(problem.milling) {
  problem.validate();
  if (problem.drilling) throw InvalidInput("drilling", "must not be there: forced vibration is known of milling alone");
  if (problem.spatial) {
    if (problem.has_measured()) {
      throw InvalidInput("dynamics.frf", "does not go with forced vibration in three directions, which needs modes",
                         "Fit them first: robomill modes");
    }
    require_positive("feed_per_tooth_m", problem.spatial->feed_per_tooth_m, "m");
    spatial_ = std::make_shared<Spatial>(problem);
    return;
  }
  require_positive("feed_per_tooth_m", milling_.feed_per_tooth_m, "m");
  response_ = response_of(problem);
  equal_teeth_ = milling_.tool.has_equal_teeth();
}

ForcedVibration ForcedResponse::at(const OperatingPoint& point) const {
  require_positive("axial_depth_m", point.axial_depth_m, "m");
  cutting::require_spindle_speed("spindle_speed_rad_per_s", point.spindle_speed_rad_per_s);
  if (spatial_) {
    constexpr double tolerance = 1e-4;  // of the spectral radius: the steady motion needs no finer mesh
    const detail::SpatialSurface& surface = spatial_->surface;
    return surface.vibration(point, surface.model().first_level(point, tolerance));
  }
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
    if (detail::greatest(in_space(q[j])) > detail::greatest(in_space(q[strongest]))) strongest = j;
  }
  ForcedVibration out;
  out.amplitude_m = half_width(q);
  out.harmonic = static_cast<int>(strongest) + 1;
  out.of_tooth_passing = equal_teeth_;
  out.frequency_hz = base * out.harmonic / units::revolution;
  out.harmonic_m = detail::greatest(in_space(q[strongest]));
  detail::set_mode(out, response_.mode_of(base * out.harmonic, force[strongest]));
  return out;
}

}  // namespace robomill::stability
