#include "robomill/modal/weak_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "examples/first-lobes/hammer.hpp"
#include "robomill/base/random.hpp"
#include "robomill/modal/fit.hpp"
#include "testing/modal/fit_cases.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace weak_modes_test {

using Eigen::Index;

/// A tool in its holder: two or three modes in each of two directions, 3 to 63 N/µm.
ModalModel random_tool(Random& random) {
  const auto direction = [&] {
    std::vector<MassMode> modes;
    const std::uint64_t count = 2 + random.index(2);
    double frequency_hz = random.uniform(500.0, 1100.0);
    for (std::uint64_t k = 0; k < count; ++k) {
      const double stiffness = 1e6 * std::pow(10.0, random.uniform(0.5, 1.8));
      const double omega = 2.0 * std::numbers::pi * frequency_hz;
      modes.push_back({.frequency_hz = frequency_hz,
                       .damping_ratio = random.uniform(0.008, 0.04),
                       .modal_mass_kg = stiffness / (omega * omega)});
      frequency_hz *= random.uniform(1.5, 2.2);
    }
    return modes;
  };
  const std::vector<MassMode> x = direction(), y = direction();
  ModalModel model = modes_from_mass(x, y);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(random.uniform(0.2, 1.2)).toRotationMatrix();
  for (Mode& mode : model.modes) {
    mode.left = turn * mode.left;
    mode.right = turn * mode.right;
  }
  return model;
}

/// Whether a mode of a fit is one of the structure's: within its half-power band.
bool is_true(const Mode& mode, const ModalModel& truth) {
  return std::ranges::any_of(truth.modes, [&](const Mode& of) {
    return std::abs(mode.frequency_hz - of.frequency_hz) < of.damping_ratio * of.frequency_hz &&
           mode.damping_ratio < 3.0 * of.damping_ratio;
  });
}

bool is_found(const Mode& of, const ModalModel& fitted) {
  return std::ranges::any_of(fitted.modes, [&](const Mode& mode) {
    return !mode.weak && std::abs(mode.frequency_hz - of.frequency_hz) < of.damping_ratio * of.frequency_hz;
  });
}

/// Peak of a mode over the scatter of the lines there, of the FRF where it is greatest.
double clearness(const Mode& mode, const ModalModel& truth, const FrfSet& measured) {
  const FrfSet exact = synthesize(truth, measured.frequency_hz);
  const FrfSet own = synthesize({.excitations = truth.excitations, .responses = truth.responses, .modes = {mode}},
                                measured.frequency_hz);
  double clear = 0.0;
  for (const Frf& frf : measured.frfs) {
    double error2 = 0.0, lines = 0.0;
    for (Index i = 0; i < measured.frequency_hz.size(); ++i) {
      if (std::abs(measured.frequency_hz(i) - mode.frequency_hz) > mode.damping_ratio * mode.frequency_hz) continue;
      error2 += std::norm(frf.receptance(i) - exact.find(frf.name)->receptance(i));
      lines += 1.0;
    }
    if (lines == 0.0) continue;
    clear = std::max(clear, own.find(frf.name)->receptance.cwiseAbs().maxCoeff() / std::sqrt(error2 / lines));
  }
  return clear;
}

FrfSet kept(const FrfSet& set, bool cross) {
  FrfSet out{.frequency_hz = set.frequency_hz, .frfs = {}};
  for (const Frf& frf : set.frfs) {
    if (cross || frf.name.response == frf.name.excitation) out.frfs.push_back(frf);
  }
  return out;
}

/// Fits against the truth: ghosts are modes of the fit that are none of the structure's.
struct Tally {
  int modes = 0, lost = 0, ghosts = 0, unmarked = 0;
};
void judge(const ModalModel& truth, const FrfSet& measured, const FitResult& fit, Tally& tally) {
  for (const Mode& mode : fit.model.modes) {
    if (is_true(mode, truth)) continue;
    ++tally.ghosts;
    tally.unmarked += mode.weak ? 0 : 1;
  }
  constexpr double clear_of_noise = 5.0;
  for (const Mode& mode : truth.modes) {
    if (mode.frequency_hz > fit.band_high_hz || clearness(mode, truth, measured) < clear_of_noise) continue;
    ++tally.modes;
    tally.lost += is_found(mode, fit.model) ? 0 : 1;
  }
}

// Noise of 0.3 to 10 % of every line: a mode whose peak stands five times out of it stays, unmarked.
TEST(WeakModes, NoneThatStandsOutOfTheNoiseIsMarkedOrDropped) {
  const auto seeds = static_cast<std::uint64_t>(test::seeds(100));
  Tally tally;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Random random(seed, 17);
    const ModalModel truth = random_tool(random);
    FrfSet set = kept(synthesize(truth, Eigen::VectorXd::LinSpaced(1501, 200.0, 6200.0)), seed % 2 == 0);
    cases::add_noise(set, std::pow(10.0, random.uniform(-2.5, -1.0)), seed);
    judge(truth, set, fit_modes(set, {}), tally);
  }
  EXPECT_GT(tally.modes, 3 * static_cast<int>(seeds));
  EXPECT_EQ(tally.lost, 0);
  EXPECT_EQ(tally.unmarked, 0);
}

// Records leave what no mode stands for: windows, a sensor's noise integrated twice. Fits fill it with modes of 1e9
// N/m.
TEST(WeakModes, GhostsOfHitsAreMarked) {
  const auto seeds = static_cast<std::uint64_t>(test::seeds(100));
  Tally tally;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    Random random(seed, 19);
    const ModalModel truth = random_tool(random);
    const examples::Hammer hammer{.peak_force_n = 200.0,
                                  .pulse_s = random.uniform(1.2e-4, 2.5e-4),
                                  .force_noise_n = random.uniform(0.02, 0.2),
                                  .response_noise = std::pow(10.0, random.uniform(-2.0, 0.0)),
                                  .sample_rate_hz = 25600.0,
                                  .record_s = random.uniform(0.2, 0.64),
                                  .pretrigger_s = 0.02};
    const FrfResult estimated = estimate_frfs(examples::simulate_hits(truth, 3, 0.1, hammer, seed), {});
    const FrfSet set = kept(estimated.set, seed % 2 == 0);
    const auto [low_hz, high_hz] = estimated.band_hz();
    if (low_hz > 1000.0) continue;
    const FitOptions options{.band_low_hz = std::max(100.0, low_hz), .band_high_hz = std::min(8500.0, high_hz)};
    judge(truth, set, fit_modes(set, options), tally);
  }
  EXPECT_GT(tally.modes, 2 * static_cast<int>(seeds));
  EXPECT_GT(tally.ghosts, 0);
  EXPECT_LE(100 * tally.lost, tally.modes);
  EXPECT_LE(100 * tally.unmarked, tally.modes);
}

/// Two modes of 1e7 N/m that are well known, and what a test adds.
ModalModel with_third(const MassMode& third, double frequency_std_hz, double damping_ratio_std) {
  ModalModel model = modes_from_mass({{.frequency_hz = 900.0, .damping_ratio = 0.03, .modal_mass_kg = 0.3},
                                      {.frequency_hz = 2100.0, .damping_ratio = 0.02, .modal_mass_kg = 0.06},
                                      third},
                                     {});
  for (Mode& mode : model.modes) {
    mode.frequency_std_hz = 1e-5 * mode.frequency_hz;
    mode.damping_ratio_std = 1e-4 * mode.damping_ratio;
  }
  model.modes[2].frequency_std_hz = frequency_std_hz;
  model.modes[2].damping_ratio_std = damping_ratio_std;
  return model;
}

TEST(WeakModes, OfModesAloneTheDeviationsSayIt) {
  const auto third_is_weak = [](const MassMode& third, double frequency_std_hz, double damping_ratio_std) {
    ModalModel model = with_third(third, frequency_std_hz, damping_ratio_std);
    mark_weak_modes(model);
    EXPECT_FALSE(model.modes[0].weak || model.modes[1].weak);
    return model.modes[2].weak;
  };
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  // 6e10 N/m, a quarter of the damping not known.
  const MassMode ghost{.frequency_hz = 3300.0, .damping_ratio = 0.2, .modal_mass_kg = 140.0};
  EXPECT_TRUE(third_is_weak(ghost, 210.0, 0.05));
  EXPECT_TRUE(third_is_weak(ghost, 2.0, 0.001));  // it bends a baseline, however well that is known
  EXPECT_FALSE(third_is_weak(ghost, unknown, unknown));
  // 4e8 N/m and small, but known.
  const MassMode small{.frequency_hz = 3300.0, .damping_ratio = 0.01, .modal_mass_kg = 1.0};
  EXPECT_FALSE(third_is_weak(small, 0.3, 1e-4));
  // Vague, but most of what moves there.
  const MassMode large{.frequency_hz = 3300.0, .damping_ratio = 0.05, .modal_mass_kg = 0.03};
  EXPECT_FALSE(third_is_weak(large, 60.0, 0.02));
}

TEST(ModalStiffness, IsThatOfTheMassOnItsSpring) {
  Random random(5);
  for (int round = 0; round < 100; ++round) {
    const MassMode mode{.frequency_hz = random.uniform(10.0, 5000.0),
                        .damping_ratio = random.uniform(0.001, 0.4),
                        .modal_mass_kg = std::pow(10.0, random.uniform(-2.0, 3.0))};
    ModalModel model = modes_from_mass({}, {mode}, {});
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(random.uniform(0.0, 6.0)).toRotationMatrix();
    model.modes[0].left = turn * model.modes[0].left;
    model.modes[0].right = turn * model.modes[0].right;
    const ModalStiffness found = modal_stiffness(model, 0);
    EXPECT_NEAR(found.mass_kg, mode.modal_mass_kg, 1e-12 * mode.modal_mass_kg);
    // At rest the tip deflects by 1 / k in the direction in which the mode moves.
    const Eigen::Vector2d along = turn * Eigen::Vector2d::UnitY();
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(1);
    const FrfSet at_rest = synthesize(model, still);
    Eigen::Matrix2cd compliance;
    for (std::size_t f = 0; f < 4; ++f) {
      compliance(static_cast<Index>(f % 2), static_cast<Index>(f / 2)) = at_rest.frfs[f].receptance(0);
    }
    const double softest = along.dot(compliance.real() * along);
    EXPECT_NEAR(found.stiffness_n_per_m * softest, 1.0, 1e-12);
  }
}

// Hits at 1x and 2x, sensors at 2x, 3x and 2y: only 2x is both hit and measured.
TEST(ModalStiffness, IsOfAPointThatIsHitAndMeasured) {
  ModalModel model{.excitations = {{.point = 1}, {.point = 2}},
                   .responses = {{.point = 2}, {.point = 3}, {.point = 2, .axis = Axis::y}},
                   .modes = {{.frequency_hz = 100.0,
                              .damping_ratio = 0.01,
                              .left = Eigen::Vector2cd(5e-3, 2e-3),
                              .right = Eigen::Vector3cd(2e-3, 7e-3, 9e-3)}}};
  const double damped = 200.0 * std::numbers::pi * std::sqrt(1.0 - 1e-4);
  EXPECT_NEAR(modal_stiffness(model, 0).mass_kg, 1.0 / (2.0 * damped * 4e-6), 1e-9 / damped / 4e-6);
  model.responses = {{.point = 4}, {.point = 3}, {.point = 2, .axis = Axis::y}};
  EXPECT_TRUE(std::isnan(modal_stiffness(model, 0).stiffness_n_per_m));
}

}  // namespace weak_modes_test
}  // namespace robomill::modal
