#include "robomill/modal/published/pso.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <complex>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/modal/peaks.hpp"
#include "robomill/modal/published/pso_misfit.hpp"
#include "testing/modal/fit_cases.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace pso_test {

using Complex = std::complex<double>;
using detail::Misfit;
using detail::MisfitMode;
using detail::Simd;

const Dof axis_x{.point = 0, .axis = Axis::x};
const Dof axis_y{.point = 0, .axis = Axis::y};

Mode make_mode(double frequency_hz, double damping_ratio, const Eigen::VectorXcd& left, const Eigen::VectorXcd& right) {
  Mode mode;
  mode.frequency_hz = frequency_hz;
  mode.damping_ratio = damping_ratio;
  mode.left = left;
  mode.right = right;
  return mode;
}

ModalModel one_mode() {
  return {.excitations = {axis_x},
          .responses = {axis_x},
          .modes = {make_mode(80.0, 0.05, Eigen::VectorXcd::Constant(1, 0.02),
                              Eigen::VectorXcd::Constant(1, {0.003, -0.02}))}};
}

/// Two modes seen in two directions.
ModalModel two_modes() {
  return {.excitations = {axis_x},
          .responses = {axis_x, axis_y},
          .modes = {make_mode(60.0, 0.05, Eigen::VectorXcd::Constant(1, 0.02),
                              Eigen::Vector2cd(Complex(0.002, -0.02), Complex(-0.004, 0.008))),
                    make_mode(110.0, 0.04, Eigen::VectorXcd::Constant(1, 0.03),
                              Eigen::Vector2cd(Complex(-0.004, -0.03), Complex(0.001, -0.02)))}};
}

/// Two modes in each of two directions that do not touch each other.
FrfSet two_hits() {
  ModalModel model{.excitations = {axis_x, axis_y}, .responses = {axis_x, axis_y}, .modes = {}};
  model.modes.push_back(
      make_mode(50.0, 0.04, Eigen::Vector2cd(0.02, 0.0), Eigen::Vector2cd(Complex(0.0, -0.02), Complex(0.0, -0.004))));
  model.modes.push_back(
      make_mode(80.0, 0.05, Eigen::Vector2cd(0.0, 0.02), Eigen::Vector2cd(Complex(0.0, 0.006), Complex(0.0, -0.02))));
  model.modes.push_back(
      make_mode(120.0, 0.03, Eigen::Vector2cd(0.03, 0.0), Eigen::Vector2cd(Complex(0.0, -0.03), Complex(0.0, 0.004))));
  return synthesize(model, Eigen::VectorXd::LinSpaced(141, 20.0, 160.0));
}

Eigen::VectorXd lines() {
  return Eigen::VectorXd::LinSpaced(161, 20.0, 180.0);
}

/// Few particles, and a patient end.
PsoOptions small_swarm() {
  PsoOptions options;
  options.particles = 80;
  options.max_iterations = 2500;
  options.stall_tolerance = 1e-7;
  options.stall_iterations = 50;
  return options;
}

double misfit_by_definition(const FrfSet& frfs, const FrfSet& fit) {
  double sum = 0.0;
  double count = 0.0;
  for (const Frf& frf : frfs.frfs) {
    const Frf& other = *fit.find(frf.name);
    for (Eigen::Index i = 0; i < frf.receptance.size(); ++i) {
      if (frf.receptance(i) == 0.0) continue;
      sum += std::abs(other.receptance(i) - frf.receptance(i)) / std::abs(frf.receptance(i));
      count += 1.0;
    }
  }
  return sum / count;
}

std::vector<const Frf*> pointers(const FrfSet& set) {
  std::vector<const Frf*> result;
  for (const Frf& frf : set.frfs) result.push_back(&frf);
  return result;
}

double frequency_distance(const Mode& mode, double frequency_hz) {
  return std::abs(mode.frequency_hz - frequency_hz) / frequency_hz;
}

/// A structure with one excitation, `responses` responses and six modes anywhere, heavily and lightly damped.
ModalModel random_model(Random& random, std::size_t responses) {
  ModalModel model{.excitations = {axis_x}, .responses = {}, .modes = {}};
  for (std::size_t i = 0; i < responses; ++i)
    model.responses.push_back({.point = static_cast<int>(i), .axis = Axis::x});
  for (int k = 0; k < 6; ++k) {
    Eigen::VectorXcd right(static_cast<Eigen::Index>(responses));
    for (Complex& value : right) {
      const double re = random.normal();
      value = 0.01 * Complex(re, random.normal());
    }
    model.modes.push_back(make_mode(random.uniform(5.0, 1000.0), std::pow(random.uniform(0.05, 0.99), 2.0),
                                    Eigen::VectorXcd::Constant(1, {0.01, -0.02}), right));
  }
  return model;
}

double misfit_of(const ModalModel& model, const FrfSet& frfs, Simd simd) {
  std::vector<Eigen::VectorXcd> residues;
  std::vector<MisfitMode> modes;
  for (const Mode& mode : model.modes) residues.push_back(mode.right * mode.left(0));
  for (std::size_t k = 0; k < residues.size(); ++k) {
    const std::span<const Complex> row(residues[k].data(), static_cast<std::size_t>(residues[k].size()));
    modes.push_back(
        {.frequency_hz = model.modes[k].frequency_hz, .damping_ratio = model.modes[k].damping_ratio, .residues = row});
  }
  return Misfit(frfs.frequency_hz, pointers(frfs), simd)(modes);
}

TEST(PsoMisfit, IsTheMeanRelativeErrorForAnyNumberOfLinesAndFrfs) {
  Random random(5);
  for (const Eigen::Index count : {1, 3, 4, 257, 1000}) {
    for (const std::size_t responses : {1U, 2U, 3U}) {
      const Eigen::VectorXd axis =
          count == 1 ? Eigen::VectorXd::Constant(1, 40.0) : Eigen::VectorXd::LinSpaced(count, 0.0, 1000.0).eval();
      FrfSet target = synthesize(random_model(random, responses), axis);
      const ModalModel model = random_model(random, responses);
      if (count > 3) target.frfs[0].receptance(2) = 0.0;  // left out
      const double expected = misfit_by_definition(target, synthesize(model, axis));
      EXPECT_NEAR(misfit_of(model, target, Simd::automatic), expected, 1e-11 * expected) << count << ' ' << responses;
    }
  }
}

TEST(PsoMisfit, BothInstructionSetsGiveTheSameBits) {
  if (!detail::supports(Simd::avx2)) GTEST_SKIP() << "this processor has no AVX2";
  Random random(6);
  for (const Eigen::Index count : {5, 700}) {
    for (const std::size_t responses : {1U, 2U, 3U}) {
      const FrfSet target = synthesize(random_model(random, responses), Eigen::VectorXd::LinSpaced(count, 5.0, 1000.0));
      const ModalModel model = random_model(random, responses);
      EXPECT_EQ(misfit_of(model, target, Simd::baseline), misfit_of(model, target, Simd::avx2));
    }
  }
}

TEST(Pso, RecoversOneMode) {
  const FrfSet frfs = synthesize(one_mode(), lines());
  const PsoResult result = fit_pso(frfs, small_swarm());
  ASSERT_EQ(result.model.modes.size(), 1U);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.best.back(), 1e-4);
  EXPECT_LT(frequency_distance(result.model.modes[0], 80.0), 1e-4);
  EXPECT_NEAR(result.model.modes[0].damping_ratio, 0.05, 1e-5);
  const Complex residue = result.model.modes[0].left(0) * result.model.modes[0].right(0);
  EXPECT_LT(std::abs(residue - Complex(0.02) * Complex(0.003, -0.02)), 1e-4 * std::abs(residue));
}

TEST(Pso, RecoversTwoModesInTwoDirections) {
  const FrfSet frfs = synthesize(two_modes(), lines());
  PsoOptions options = small_swarm();
  options.max_damping_ratio = 0.2;
  options.particles = 200;
  const PsoResult result = fit_pso(frfs, options);
  ASSERT_EQ(result.model.modes.size(), 2U);
  EXPECT_LT(result.best.back(), 1e-2);
  EXPECT_LT(frequency_distance(result.model.modes[0], 60.0), 1e-3);
  EXPECT_LT(frequency_distance(result.model.modes[1], 110.0), 1e-3);
}

// What the swarm says of its best is what the model it gives back is worth.
TEST(Pso, BestFallsAndIsTheMisfitOfTheModel) {
  const FrfSet frfs = synthesize(two_modes(), lines());
  PsoOptions options;
  options.particles = 40;
  options.max_iterations = 60;
  options.modes = 3;
  const PsoResult result = fit_pso(frfs, options);
  ASSERT_EQ(result.runs.size(), 1U);
  EXPECT_EQ(result.best, result.runs[0].best);
  EXPECT_EQ(result.best.size(), static_cast<std::size_t>(result.iterations) + 1);
  EXPECT_TRUE(std::ranges::is_sorted(result.best, std::greater<>()));
  EXPECT_LT(result.best.back(), result.best.front());
  EXPECT_EQ(result.model.modes.size(), 3U);
  EXPECT_NO_THROW(result.model.validate());
  EXPECT_NEAR(misfit_by_definition(frfs, synthesize(result.model, frfs.frequency_hz)), result.best.back(), 1e-11);
}

TEST(Pso, GivesTheSameBitsAtAnyThreadCount) {
  const FrfSet frfs = two_hits();
  PsoOptions options;
  options.particles = 4000;  // enough work in every loop for all threads to take part
  options.max_iterations = 10;
  PsoResult first;
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    const PsoResult result = fit_pso(frfs, options);
    if (threads == 1) first = result;
    EXPECT_EQ(result.best, first.best) << threads;
    ASSERT_EQ(result.model.modes.size(), first.model.modes.size());
    for (std::size_t k = 0; k < first.model.modes.size(); ++k) {
      EXPECT_EQ(result.model.modes[k].frequency_hz, first.model.modes[k].frequency_hz);
      EXPECT_EQ(result.model.modes[k].damping_ratio, first.model.modes[k].damping_ratio);
      EXPECT_EQ(result.model.modes[k].left, first.model.modes[k].left);
      EXPECT_EQ(result.model.modes[k].right, first.model.modes[k].right);
    }
  }
  set_thread_count(0);
  options.seed = 2;
  EXPECT_NE(fit_pso(frfs, options).best, first.best);
}

TEST(Pso, FitsEveryExcitationWithModesOfItsOwn) {
  const FrfSet frfs = two_hits();
  PsoOptions options;
  options.particles = 20;
  options.max_iterations = 30;
  options.modes = 5;
  const PsoResult result = fit_pso(frfs, options);
  ASSERT_EQ(result.runs.size(), 2U);
  EXPECT_EQ(result.runs[0].excitation, axis_x);
  EXPECT_EQ(result.runs[0].peaks_hz.size(), 3U);
  EXPECT_EQ(result.runs[1].peaks_hz.size(), 2U);
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes[0].find("on its own"), std::string::npos) << result.notes[0];
  int with_x = 0;
  for (const Mode& mode : result.model.modes) {
    EXPECT_TRUE((mode.left(0) == 0.0) != (mode.left(1) == 0.0));
    if (mode.left(1) == 0.0) ++with_x;
  }
  EXPECT_EQ(with_x, 3);
  EXPECT_TRUE(std::ranges::is_sorted(result.model.modes, {}, &Mode::frequency_hz));
  EXPECT_NEAR(misfit_by_definition(frfs, synthesize(result.model, frfs.frequency_hz)), result.best.back(), 1e-11);

  // The x hits alone take the same course.
  FrfSet only_x = frfs;
  std::erase_if(only_x.frfs, [](const Frf& frf) { return frf.name.excitation != axis_x; });
  options.modes = 3;
  EXPECT_EQ(fit_pso(only_x, options).best, result.runs[0].best);
}

TEST(Pso, HoldsFrequenciesAndDampingsToTheirBounds) {
  const FrfSet frfs = synthesize(two_modes(), lines());
  PsoOptions options = small_swarm();
  options.max_iterations = 50;
  options.peaks_hz = {40.0, 150.0};  // beside the modes, which pull to the bounds
  options.frequency_half_width = 0.05;
  options.max_damping_ratio = 0.02;
  const PsoResult result = fit_pso(frfs, options);
  EXPECT_EQ(result.runs[0].peaks_hz, options.peaks_hz);
  EXPECT_EQ(result.runs[0].stop, PsoRun::Stop::max_iterations);
  EXPECT_FALSE(result.converged);
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_NE(result.notes[0].find("no fit"), std::string::npos) << result.notes[0];
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_LE(frequency_distance(result.model.modes[k], options.peaks_hz[k]), 0.05 + 1e-12);
    EXPECT_LE(result.model.modes[k].damping_ratio, 0.02);
    EXPECT_GT(result.model.modes[k].damping_ratio, 0.0);
  }
}

// In n iterations no particle goes further than n times the greatest velocity from where its stream of random numbers
// put it.
TEST(Pso, HoldsVelocitiesToTheirShareOfTheRange) {
  const FrfSet frfs = synthesize(one_mode(), lines());
  PsoOptions options;
  options.particles = 3;
  options.max_iterations = 30;
  options.peaks_hz = {80.0};
  options.velocity_fraction = 1e-4;
  const Mode mode = fit_pso(frfs, options).model.modes[0];
  const double reach = 30.0 * options.velocity_fraction;
  bool reachable = false;
  for (std::uint64_t particle = 0; particle < 3; ++particle) {
    Random random(options.seed, particle);
    const double frequency_hz = random.uniform(72.0, 88.0);
    const double damping_ratio = random.uniform(0.0, options.max_damping_ratio);
    reachable = reachable || (std::abs(mode.frequency_hz - frequency_hz) <= reach * 16.0 &&
                              std::abs(mode.damping_ratio - damping_ratio) <= reach + 1e-5);
  }
  EXPECT_TRUE(reachable);
}

// [RobotMillingChatter] table 4-3: c1 = c2 = 2, and an inertia that has come down from 0.9 to 0.88 where its fits stop
// (281 and 284 of 8,000 iterations). c1 + c2 = 4 is beyond 24 (1 - w²) / (7 - 5 w), up to which positions have a finite
// variance ([Poli2009]), until w is 0.5: a free swarm's steps grow.
TEST(Pso, ABoundOnTheVelocityEndsBetterThanAsPrinted) {
  const auto most_pull = [](double w) { return 24.0 * (1.0 - w * w) / (7.0 - 5.0 * w); };
  EXPECT_LT(most_pull(0.88), 4.0);
  EXPECT_DOUBLE_EQ(most_pull(0.5), 4.0);
  const FrfSet frfs = synthesize(two_modes(), lines());
  PsoOptions printed;
  printed.modes = 2;
  printed.particles = 100;
  printed.max_iterations = 284;
  printed.inertia_end = 0.88;
  printed.velocity_fraction = 0.0;
  PsoOptions held = printed;
  held.velocity_fraction = 0.1;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    printed.seed = held.seed = seed;
    const std::vector<double> free = fit_pso(frfs, printed).best, bounded = fit_pso(frfs, held).best;
    EXPECT_EQ(free.front(), bounded.front()) << seed;
    EXPECT_LT(bounded.back(), free.back()) << seed;
  }
}

// Its step 8 goes back to a new random swarm. That is a random search: as many particles drawn at once.
TEST(Pso, IsBetterThanANewSwarmAtEveryStep) {
  const FrfSet frfs = synthesize(two_modes(), lines());
  PsoOptions options;
  options.modes = 2;
  options.particles = 50;
  options.max_iterations = options.inertia_iterations = 100;
  PsoOptions random = options;
  random.particles = 50 * 101;
  random.max_iterations = 1;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    options.seed = random.seed = seed;
    EXPECT_LT(fit_pso(frfs, options).best.back(), fit_pso(frfs, random).best.front()) << seed;
  }
}

TEST(Pso, InertiaFallsLinearlyAndStays) {
  PsoOptions options;
  options.inertia_iterations = 101;
  EXPECT_DOUBLE_EQ(inertia(options, 1), 0.9);
  EXPECT_DOUBLE_EQ(inertia(options, 51), 0.65);
  EXPECT_DOUBLE_EQ(inertia(options, 101), 0.4);
  EXPECT_DOUBLE_EQ(inertia(options, 5000), 0.4);
  options.max_iterations = 11;
  EXPECT_DOUBLE_EQ(inertia(options, 6), 0.65);
  options.max_iterations = 1;
  EXPECT_DOUBLE_EQ(inertia(options, 1), 0.4);
}

// The x hits of the robot show four modes; noise adds none.
TEST(PsoPeaks, AreThoseOfTheRobot) {
  const std::vector<double> expected_hz = {19.57, 49.86, 67.26, 543.67};
  for (const double noise : {0.0, 0.02, 0.05}) {
    FrfSet frfs = synthesize(data::robot_modes(), cases::robot_lines());
    std::erase_if(frfs.frfs, [](const Frf& frf) { return frf.name.excitation != axis_x; });
    cases::add_noise(frfs, noise, 11);
    const std::vector<Peak> peaks = pick_peaks(frfs.frequency_hz, pointers(frfs));
    ASSERT_EQ(peaks.size(), expected_hz.size()) << noise;
    for (std::size_t k = 0; k < peaks.size(); ++k) {
      EXPECT_NEAR(peaks[k].frequency_hz, expected_hz[k], 0.05 * expected_hz[k]) << noise;
    }
  }
}

TEST(PsoPeaks, KnowWidthAndHeight) {
  const FrfSet frfs = synthesize(one_mode(), Eigen::VectorXd::LinSpaced(8001, 20.0, 180.0));
  for (const Peak& peak :
       {pick_peaks(frfs.frequency_hz, pointers(frfs)).at(0), peak_at(80.0, frfs.frequency_hz, pointers(frfs))}) {
    EXPECT_NEAR(peak.frequency_hz, 80.0, 0.5);
    EXPECT_NEAR(peak.damping_ratio, 0.05, 0.003);
    EXPECT_NEAR(peak.receptance, frfs.frfs[0].receptance.cwiseAbs().maxCoeff(), 0.01 * peak.receptance);
  }
}

TEST(Pso, RejectsEveryFaultOfTheOptions) {
  const auto rejects = [](const std::string& field, const std::function<void(PsoOptions&)>& spoil) {
    PsoOptions options;
    spoil(options);
    EXPECT_EQ(test::field_of([&] { options.validate(); }), field);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  rejects("modes", [](PsoOptions& o) { o.modes = -1; });
  rejects("peaks_hz", [](PsoOptions& o) { o.peaks_hz = {10.0, 0.0}; });
  rejects("frequency_half_width", [](PsoOptions& o) { o.frequency_half_width = 1.0; });
  rejects("frequency_half_width", [nan](PsoOptions& o) { o.frequency_half_width = nan; });
  rejects("max_damping_ratio", [](PsoOptions& o) { o.max_damping_ratio = 0.0; });
  rejects("max_damping_ratio", [](PsoOptions& o) { o.max_damping_ratio = 5.0; });
  rejects("lines", [](PsoOptions& o) { o.lines = 5; });
  rejects("particles", [](PsoOptions& o) { o.particles = 1; });
  rejects("max_iterations", [](PsoOptions& o) { o.max_iterations = 0; });
  rejects("inertia_start", [](PsoOptions& o) { o.inertia_start = 1.1; });
  rejects("inertia_end", [](PsoOptions& o) { o.inertia_end = 0.95; });
  rejects("inertia_iterations", [](PsoOptions& o) { o.inertia_iterations = 0; });
  rejects("cognitive", [](PsoOptions& o) { o.cognitive = -1.0; });
  rejects("cognitive", [](PsoOptions& o) { o.cognitive = 101.0; });
  rejects("social", [](PsoOptions& o) { o.social = 1e6; });
  rejects("social", [nan](PsoOptions& o) { o.social = nan; });
  rejects("velocity_fraction", [](PsoOptions& o) { o.velocity_fraction = -0.1; });
  rejects("stall_iterations", [](PsoOptions& o) { o.stall_iterations = 0; });
  rejects("stall_tolerance", [](PsoOptions& o) { o.stall_tolerance = -1.0; });
  EXPECT_NO_THROW(PsoOptions().validate());
}

TEST(Pso, RejectsDataThatCannotCarryTheModes) {
  const auto rejects = [](const std::string& field, const FrfSet& frfs, const PsoOptions& options) {
    EXPECT_EQ(test::field_of([&] { static_cast<void>(fit_pso(frfs, options)); }), field);
  };
  rejects("modes", two_hits(), {.modes = 1});                          // one mode for two excitations
  rejects("modes", synthesize(one_mode(), lines()), {.modes = 1000});  // more unknowns than numbers
  rejects("peaks_hz", synthesize(one_mode(), lines()), {.modes = 0, .peaks_hz = {500.0}});  // outside the band
  FrfSet flat = synthesize(one_mode(), lines());
  flat.frfs[0].receptance.setConstant(1e-6);
  rejects("frfs", flat, {});
  flat.frfs[0].receptance.setZero();
  rejects("frfs", flat, {});
  flat.frfs[0].receptance(3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(fit_pso(flat, {})), InvalidInput);
  EXPECT_THROW(static_cast<void>(fit_pso(FrfSet(), {})), InvalidInput);
}

TEST(Pso, StopsWhenAsked) {
  const std::atomic<bool> stop{true};
  Progress progress({}, &stop);
  EXPECT_THROW(static_cast<void>(fit_pso(synthesize(one_mode(), lines()), {}, progress)), Interrupted);
}

}  // namespace pso_test
}  // namespace robomill::modal
