// The whole way: hammer hits, receptances, modes, lobes, and the speed and depth to cut at.
#include <robomill/robomill.hpp>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

using namespace robomill;

// A blow, simulated: a half sine on a mass and a spring, by central differences; a sample is the mean of its steps.
modal::Hit blow(modal::Axis axis, const modal::MassMode& mode, std::uint64_t seed) {
  constexpr Eigen::Index samples = 8192, steps = 16;
  constexpr double pi = std::numbers::pi, rate_hz = 8192.0, step_s = 1.0 / (rate_hz * steps), pulse_s = 6e-4;
  const double w = 2.0 * pi * mode.frequency_hz, damped = mode.damping_ratio * w * step_s;
  Random random(seed);
  const Eigen::VectorXd noise = Eigen::VectorXd::NullaryExpr(samples, [&] { return 0.05 * random.normal(); });
  modal::Hit hit{.file = {}, .excitation = {.axis = axis}, .force_n = noise, .responses = {}};
  hit.sample_rate_hz = rate_hz;
  hit.responses.push_back({.dof = {.axis = axis}, .samples = noise.reverse()});
  double x_m = 0.0, v_m_per_s = 0.0;
  for (Eigen::Index i = 0; i < samples * steps; ++i) {
    const double since_s = static_cast<double>(i) * step_s - 0.05, before_m_per_s = v_m_per_s;
    const double force_n = since_s > 0.0 && since_s < pulse_s ? 200.0 * std::sin(pi * since_s / pulse_s) : 0.0;
    v_m_per_s = ((1.0 - damped) * v_m_per_s + step_s * (force_n / mode.modal_mass_kg - w * w * x_m)) / (1.0 + damped);
    x_m += step_s * v_m_per_s;
    hit.force_n(i / steps) += force_n / steps;
    hit.responses[0].samples(i / steps) += (v_m_per_s - before_m_per_s) / step_s / steps;
  }
  return hit;
}

int main() {
  const modal::MassMode x{650.0, 0.025, 0.6}, y{720.0, 0.03, 0.55};
  std::vector<modal::Hit> hits;
  for (std::uint64_t i = 0; i < 6; ++i) hits.push_back(i < 3 ? blow(modal::Axis::x, x, i) : blow(modal::Axis::y, y, i));
  const modal::FrfResult frfs = modal::estimate_frfs(hits, {.min_frequency_hz = 100.0, .max_frequency_hz = 1500.0});
  const modal::FitResult fit = modal::fit_modes(frfs.set, {.modes = 2});  // a peak in each direction
  stability::LobesProblem problem;
  problem.milling.tool = {.teeth = 3, .diameter_m = 16 * units::mm};
  problem.milling.immersion = cutting::immersion(cutting::MillingDirection::down, 8 * units::mm, 16 * units::mm);
  problem.milling.coefficients = {700 * units::n_per_mm2, 250 * units::n_per_mm2};
  problem.milling.feed_per_tooth_m = 0.1 * units::mm;
  problem.dynamics = fit.model;
  const stability::LobesOptions options{.spindle_speed_rad_per_s = {6000 * units::rpm, 18000 * units::rpm},
                                        .axial_depth_m = {0.0, 12 * units::mm},
                                        .grid = {121, 40}};
  const auto limits = stability::compute_lobes(problem, options).limit;
  const auto best = decision::choose(problem, options, limits, {.radial_depth_m = 8 * units::mm}).recommended.value();
  std::printf("%zu modes from %zu hits; cut at %.0f rpm, %.2f mm deep, %.0f %% below the limit\n",
              fit.model.modes.size(), hits.size(), best.spindle_speed_rad_per_s / units::rpm,
              best.axial_depth_m / units::mm, 100.0 * best.margin);
  // On the structure that was hit, in place of the modes that were found, vibration must die away there.
  problem.dynamics = modal::modes_from_mass({x}, {y});
  const auto there = stability::evaluate_point(problem, options, {best.spindle_speed_rad_per_s, best.axial_depth_m});
  std::printf("the structure itself: vibration shrinks to %.3f of itself from tooth to tooth\n", there.spectral_radius);
  return there.stable ? 0 : 1;
}
