#include "robomill/stability/frequency_domain/frequency_domain.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/stability/frequency_domain/contact_basis.hpp"
#include "robomill/stability/frequency_domain/crossings.hpp"
#include "testing/stability/problems.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace frequency_domain_test {

using std::numbers::pi;
using test::seeds;
using testing::benchmark;
using testing::robot;
using testing::rpm;
using Status = FrequencyLimit::Status;
constexpr double mm = 1e-3;

std::vector<double> speeds(std::vector<double> speeds_rpm) {
  for (double& s : speeds_rpm) s *= rpm;
  return speeds_rpm;
}

std::vector<FrequencyLimit> multi(const LobesProblem& problem, double depth_m, const std::vector<double>& speeds_rpm,
                                  bool all = false) {
  return multi_frequency_limits(problem.milling, FrequencyResponse::of_modes(problem), speeds(speeds_rpm),
                                {.largest_depth_m = depth_m, .all_crossings = all});
}

modal::FrfSet sampled(const LobesProblem& problem, double low_hz, double high_hz, double step_hz) {
  const auto lines = static_cast<Eigen::Index>(std::lround((high_hz - low_hz) / step_hz)) + 1;
  return modal::synthesize(problem.dynamics, Eigen::VectorXd::LinSpaced(lines, low_hz, high_hz));
}

double discretized(const LobesProblem& problem, double depth_m, double speed_rpm, int intervals) {
  LobesOptions options = testing::chart(1000, 2000, depth_m, 2, 40, intervals);
  options.method = Method::semi_discretization;
  return limit_depths(problem, options, {speed_rpm * rpm}).front().axial_depth_m;
}

/// Spectral radius by collocation.
double collocated(const LobesProblem& problem, double speed_rpm, double depth_m) {
  return evaluate_point(problem, {}, {speed_rpm * rpm, depth_m}).spectral_radius;
}

// Source: limits of the two-degree benchmark of [Insperger2004], converged to 1e-6 mm; the last is a flip.
struct Known {
  double speed_rpm, limit_mm;
  BifurcationType kind;
};
const std::vector<Known> known = {{5000, 1.843802, BifurcationType::hopf},
                                  {10000, 1.486950, BifurcationType::hopf},
                                  {15000, 1.651214, BifurcationType::hopf},
                                  {20000, 3.250386, BifurcationType::flip}};

TEST(MultiFrequency, ReachesTheConvergedLimits) {
  const auto limits = multi(benchmark(0.05), 0.01, {5000, 10000, 15000, 20000});
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_EQ(limits[i].status, Status::found);
    EXPECT_NEAR(limits[i].axial_depth_m / mm, known[i].limit_mm, 1e-6);
    EXPECT_EQ(limits[i].kind, known[i].kind);
    EXPECT_LT(limits[i].error_estimate_m, 1e-7 * limits[i].axial_depth_m);
  }
  EXPECT_NEAR(limits[3].chatter_frequency_hz, 1000.0, 1e-9);  // one and a half tooth passings
}

// No modal fit between: lines every 0.25 Hz go in, the limits come out.
TEST(MultiFrequency, ReachesThemFromSampledFrfs) {
  const LobesProblem problem = benchmark(0.05);
  const FrequencyResponse response = FrequencyResponse::of_frfs(sampled(problem, 0.0, 5000.0, 0.25), 0.0);
  const auto limits =
      multi_frequency_limits(problem.milling, response, speeds({5000, 10000, 15000, 20000}), {.largest_depth_m = 0.01});
  for (std::size_t i = 0; i < known.size(); ++i) {
    EXPECT_NEAR(limits[i].axial_depth_m / mm, known[i].limit_mm, 2e-6);
    EXPECT_LT(limits[i].uncovered_ratio, 1e-3);
    EXPECT_EQ(limits[i].mode.number, 0);
  }
  EXPECT_NO_THROW(require_coverage(response, limits));
}

// Semi-discretization errs by 1e-4 of the depth at 640 intervals, at second order.
TEST(MultiFrequency, AgreesWithSemiDiscretizationOfTheRobot) {
  const std::vector<double> at = {4000, 5000, 6500, 8000, 15000};
  const auto exact = multi(robot(), 3e-3, at);
  const FrequencyResponse measured = FrequencyResponse::of_frfs(sampled(robot(), 0.0, 4000.0, 0.25), 0.0);
  const auto from_lines = multi_frequency_limits(robot().milling, measured, speeds(at), {.largest_depth_m = 3e-3});
  for (std::size_t i = 0; i < at.size(); ++i) {
    EXPECT_NEAR(exact[i].axial_depth_m / discretized(robot(), 3e-3, at[i], 640), 1.0, 1e-4) << at[i];
    EXPECT_NEAR(from_lines[i].axial_depth_m / exact[i].axial_depth_m, 1.0, 1e-6) << at[i];
    EXPECT_EQ(exact[i].mode.number, 8);
  }
}

struct Case {
  const char* name;
  LobesProblem problem;
  double depth_m;
  std::vector<double> speeds_rpm;
};

TEST(MultiFrequency, AgreesWithSemiDiscretizationOfOtherCuts) {
  Case slot = {"slot", benchmark(1.0), 2e-3, {5000, 9000, 20000}};
  Case one_direction = {"slot in one direction", benchmark(1.0, 1), 5e-3, {10000, 20000}};
  Case helix = {"helix", benchmark(0.05), 0.012, {9000, 20000}};
  helix.problem.milling.tool.helix_rad = 0.5;
  Case backwards = helix;
  backwards.name = "left-hand helix";
  backwards.problem.milling.tool.helix_rad = -0.6;
  Case pitch = {"unequal pitch", benchmark(0.5), 5e-3, {5000, 14000}};
  pitch.problem.milling.tool.pitch_rad = {2.9, 2.0 * pi - 2.9};
  Case overlap = {"unequal pitch, two teeth at once", benchmark(0.8), 2e-3, {10000}};
  overlap.problem.milling.tool.teeth = 3;
  overlap.problem.milling.tool.pitch_rad = {1.9, 2.2, 2.0 * pi - 4.1};
  Case compliance = {"residual compliance", benchmark(0.3), 2e-3, {9000}};
  for (const char* name : {"xx", "yy"}) {
    compliance.problem.dynamics.residuals.push_back({.name = modal::parse_frf_name(name), .stiffness = 1.0 / 5e6});
  }
  for (const Case& c : {slot, one_direction, helix, backwards, pitch, overlap, compliance}) {
    const auto limits = multi(c.problem, c.depth_m, c.speeds_rpm);
    for (std::size_t i = 0; i < limits.size(); ++i) {
      const double expected = discretized(c.problem, c.depth_m, c.speeds_rpm[i], 320);
      ASSERT_EQ(limits[i].status, Status::found) << c.name;
      EXPECT_NEAR(limits[i].axial_depth_m / expected, 1.0, 2e-3) << c.name << ' ' << c.speeds_rpm[i];
      EXPECT_NEAR(collocated(c.problem, c.speeds_rpm[i], limits[i].axial_depth_m), 1.0, 2e-6) << c.name;
    }
  }
}

// Its force follows the velocity, harmonics fall more slowly; judged by collocation.
TEST(MultiFrequency, HasProcessDamping) {
  LobesProblem damped = benchmark(0.3);
  damped.milling.process_damping = {.indentation_n_per_m3 = 4e13, .wear_land_m = 60e-6, .friction = 0.3};
  LobesProblem helix = damped, pitch = damped;
  helix.milling.tool.helix_rad = 0.5;
  pitch.milling.tool.pitch_rad = {2.9, 2.0 * pi - 2.9};
  for (const LobesProblem& p : {damped, helix, pitch}) {
    for (const double speed_rpm : {4000.0, 9000.0}) {
      const FrequencyLimit limit = multi(p, 8e-3, {speed_rpm}).front();
      ASSERT_EQ(limit.status, Status::found);
      EXPECT_NEAR(collocated(p, speed_rpm, limit.axial_depth_m), 1.0, 3e-6) << speed_rpm;
      EXPECT_LT(collocated(p, speed_rpm, 0.98 * limit.axial_depth_m), 1.0);
    }
  }
  LobesProblem bare = damped;
  bare.milling.process_damping = {};
  EXPECT_GT(multi(damped, 8e-3, {4000}).front().axial_depth_m, 1.2 * multi(bare, 8e-3, {4000}).front().axial_depth_m);
}

// Stable just below the limit and unstable just above it, or stable at every depth: checked by another method.
TEST(MultiFrequency, PropertyLimitsOfRandomCuts) {
  int found = 0;
  for (int seed = 0; seed < seeds(200); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 41);
    LobesProblem p = benchmark(random.uniform(0.05, 1.0));
    p.milling.tool.teeth = 1 + static_cast<int>(random.index(4));
    if (random.uniform() < 0.5) {
      p.milling.immersion = cutting::immersion(cutting::MillingDirection::up, random.uniform(0.05, 1.0) * 0.01, 0.01);
    }
    p.milling.coefficients.radial_n_per_m2 = random.uniform(-0.2, 1.0) * 6e8;
    p.feed_direction_rad = random.uniform(0.0, 2.0 * pi);
    p.dynamics.modes.clear();
    for (std::uint64_t k = 0; k < 1 + random.index(4); ++k) {
      modal::Mode mode = testing::mass_mode(static_cast<Eigen::Index>(random.index(2)), random.uniform(300.0, 1500.0),
                                            random.uniform(0.01, 0.05), random.uniform(0.02, 0.2));
      mode.right = (Eigen::Rotation2Dd(random.uniform(-0.6, 0.6)).toRotationMatrix() * mode.right).eval();
      p.dynamics.modes.push_back(mode);
    }
    if (random.uniform() < 0.3) p.milling.tool.helix_rad = random.uniform(-0.7, 0.7);
    const double speed_rpm = random.uniform(6000.0, 25000.0);
    const FrequencyLimit limit = multi(p, 4e-3, {speed_rpm}).front();
    LobesOptions fine;
    fine.method = Method::semi_discretization;
    fine.intervals = 320;
    const auto radius = [&](double depth_m) {
      return evaluate_point(p, fine, {speed_rpm * rpm, depth_m}).spectral_radius;
    };
    ASSERT_NE(limit.status, Status::not_converged) << seed;
    const double reach_m = limit.status == Status::found ? limit.axial_depth_m : 4e-3;
    for (const double share : {0.25, 0.5, 0.75, 0.9, 0.995})
      EXPECT_LT(radius(share * reach_m), 1.0) << seed << ' ' << share;
    if (limit.status != Status::found) continue;
    ++found;
    EXPECT_GT(collocated(p, speed_rpm, 1.005 * reach_m), 1.0) << seed;
    EXPECT_NEAR(collocated(p, speed_rpm, reach_m), 1.0, 2e-6) << seed;
  }
  EXPECT_GT(found, seeds(200) / 2);
}

// Every change of stability up to 10 mm, and which way: between them the cut is as counted.
TEST(MultiFrequency, FindsEveryChangeOfStability) {
  for (const double speed_rpm : {10000.0, 20000.0}) {
    const FrequencyLimit limit = multi(benchmark(0.05), 0.01, {speed_rpm}, true).front();
    int unstable = 0;
    double before_m = 0.0;
    const auto check = [&](double next_m) {
      EXPECT_EQ(collocated(benchmark(0.05), speed_rpm, 0.5 * (before_m + next_m)) > 1.0, unstable > 0) << next_m;
      before_m = next_m;
    };
    for (const DepthCrossing& crossing : limit.crossings) {
      check(crossing.axial_depth_m);
      unstable += crossing.opens ? 1 : -1;
    }
    check(0.01);
    EXPECT_GE(limit.crossings.size(), 2U) << speed_rpm;
  }
}

// Hill's determinant itself: the limit satisfies it in the plain basis of harmonics, with the error that such a
// truncation has, which falls with the cube of the number of harmonics.
TEST(MultiFrequency, LimitIsARootOfHillsDeterminant) {
  const LobesProblem p = benchmark(0.05);
  const FrequencyResponse g = FrequencyResponse::of_modes(p);
  const FrequencyLimit limit = multi(p, 0.01, {10000}).front();
  const double tooth = 10000 * rpm * 2.0;
  const double omega = 2.0 * pi * limit.chatter_frequency_hz;
  const auto distance = [&](int harmonics) {
    const int n = 2 * harmonics + 1;
    // Fourier coefficients of the cutting stiffness by the mean over a fine grid.
    std::vector<Eigen::Matrix2cd> k(static_cast<std::size_t>(2 * n), Eigen::Matrix2cd::Zero());
    constexpr int steps = 40000;
    for (int i = 0; i < steps; ++i) {
      const double angle = pi * i / steps;
      const Eigen::Matrix2d mean = cutting::mean_cutting_stiffness(p.milling, 0, angle, angle + pi / steps, 1.0) +
                                   cutting::mean_cutting_stiffness(p.milling, 1, angle, angle + pi / steps, 1.0);
      if (mean.isZero(0.0)) continue;
      for (int h = -n + 1; h < n; ++h) {
        k[static_cast<std::size_t>(h + n)] += mean * std::polar(1.0 / steps, -2.0 * h * (angle + 0.5 * pi / steps));
      }
    }
    Eigen::MatrixXcd hill(2 * n, 2 * n);
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c < n; ++c) {
        hill.block<2, 2>(2 * r, 2 * c) = k[static_cast<std::size_t>(r - c + n)] * g.at(omega + (c - harmonics) * tooth);
      }
    }
    hill *= 1.0 - std::polar(1.0, -omega * 2.0 * pi / tooth);
    Eigen::VectorXcd vector;
    const std::complex<double> value = detail::nearest_eigenvalue(hill, 1.0 / limit.axial_depth_m, vector);
    return std::abs(value * limit.axial_depth_m - 1.0);
  };
  EXPECT_LT(distance(10), 2e-2);
  EXPECT_LT(distance(40), 3e-5);
}

TEST(MultiFrequency, SameBitsAtAnyNumberOfThreads) {
  set_thread_count(1);
  const auto one = multi(robot(), 3e-3, {5000, 6500, 9000});
  set_thread_count(4);
  const auto many = multi(robot(), 3e-3, {5000, 6500, 9000});
  set_thread_count(0);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].axial_depth_m, many[i].axial_depth_m);
}

TEST(MultiFrequency, NoLimitIsAnAnswer) {
  const auto limits = multi(benchmark(0.05), 1e-3, {5000, 9000});
  for (const FrequencyLimit& limit : limits) EXPECT_EQ(limit.status, Status::stable_in_range);
}

// One direction: the mean stiffness is K̄ = N/(2π) ∫ κ_xx, a = 1 / (2 K̄ Re G), least at Re G = -1/(4 k ζ (1 + ζ)).
TEST(ZerothOrder, LeastLimitOfOneModeIsTheClosedForm) {
  const LobesProblem p = benchmark(1.0, 1);
  const double mean = -0.5 * 2.0 * p.milling.coefficients.radial_n_per_m2 / 2.0;  // half a revolution, two teeth
  const double stiffness = 0.03993 * std::pow(2.0 * pi * 922.0, 2);
  const double least_m = 2.0 * stiffness * 0.011 * (1.0 + 0.011) / -mean;
  const FrequencyResponse g = FrequencyResponse::of_modes(p);
  // At the speed where a lobe's bottom stands: ω_c T = 2 (π - atan(...)) + 2 k π.
  const double worst = 2.0 * pi * 922.0 * std::sqrt(1.0 + 2.0 * 0.011);
  const std::complex<double> at_worst = g.at(worst)(0, 0);
  const double phase = 3.0 * pi + 2.0 * std::atan2(at_worst.imag(), at_worst.real());
  for (const int lobe : {1, 3}) {
    double turns = std::fmod(phase, 2.0 * pi);
    if (turns < 0.0) turns += 2.0 * pi;
    const double tooth_s = (turns + 2.0 * pi * lobe) / worst;
    const auto limit =
        zeroth_order_limits(p.milling, g, {2.0 * pi / (2.0 * tooth_s)}, {.largest_depth_m = 0.01}).front();
    EXPECT_NEAR(limit.axial_depth_m, least_m, 1e-9 * least_m);
    EXPECT_NEAR(limit.chatter_frequency_hz, worst / (2.0 * pi), 1e-5);
  }
  for (const FrequencyLimit& limit :
       zeroth_order_limits(p.milling, g, speeds({4000, 7000, 12000, 17000}), {.largest_depth_m = 0.05})) {
    EXPECT_GE(limit.axial_depth_m, least_m * (1.0 - 1e-12));
  }
}

// Put back: the determinant with all four receptances is zero.
TEST(ZerothOrder, LimitIsARootOfTheDeterminant) {
  const LobesProblem p = robot();
  const FrequencyResponse g = FrequencyResponse::of_modes(p);
  Eigen::Matrix2d mean = Eigen::Matrix2d::Zero();
  for (int j = 0; j < 3; ++j) mean += cutting::mean_cutting_stiffness(p.milling, j, 0.0, 2.0 * pi, 1.0);
  for (const FrequencyLimit& limit :
       zeroth_order_limits(p.milling, g, speeds({4500, 6500, 9000}), {.largest_depth_m = 5e-3})) {
    ASSERT_EQ(limit.status, Status::found);
    const double omega = 2.0 * pi * limit.chatter_frequency_hz;
    const std::complex<double> delay = 1.0 - std::polar(1.0, -omega * 2.0 * pi / (3.0 * limit.spindle_speed_rad_per_s));
    const Eigen::Matrix2cd a =
        Eigen::Matrix2cd::Identity() - limit.axial_depth_m * delay * mean.cast<std::complex<double>>() * g.at(omega);
    EXPECT_LT(std::abs(a.determinant()), 1e-9);
  }
}

TEST(ZerothOrder, AndMultiFrequencyTurnWithStructureAndFeed) {
  LobesProblem turned = robot();
  turned.feed_direction_rad = 0.7;
  for (modal::Mode& mode : turned.dynamics.modes) {
    const Eigen::Matrix2d r = Eigen::Rotation2Dd(0.7).toRotationMatrix();
    mode.left = (r * mode.left).eval();
    mode.right = (r * mode.right).eval();
  }
  const FrequencyOptions options = {.largest_depth_m = 5e-3};
  const auto at = speeds({5000, 6500});
  const FrequencyResponse g = FrequencyResponse::of_modes(robot()), t = FrequencyResponse::of_modes(turned);
  const FrequencyResponse f = FrequencyResponse::of_frfs(sampled(turned, 0.0, 4000.0, 0.25), 0.7);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const double zeroth_m = zeroth_order_limits(robot().milling, g, {at[i]}, options).front().axial_depth_m;
    const double multi_m = multi_frequency_limits(robot().milling, g, {at[i]}, options).front().axial_depth_m;
    EXPECT_NEAR(zeroth_order_limits(robot().milling, t, {at[i]}, options).front().axial_depth_m / zeroth_m, 1.0, 1e-9);
    EXPECT_NEAR(zeroth_order_limits(robot().milling, f, {at[i]}, options).front().axial_depth_m / zeroth_m, 1.0, 1e-6);
    EXPECT_NEAR(multi_frequency_limits(robot().milling, t, {at[i]}, options).front().axial_depth_m / multi_m, 1.0,
                1e-8);
  }
}

// Slotting with two directions: the stiffness hardly varies, harmonics matter little away from flips.
TEST(ZerothOrder, IsNearMultiFrequencyInASlot) {
  const LobesProblem p = benchmark(1.0);
  const auto at = speeds({5000, 10000, 15000, 20000});
  const auto zeroth = zeroth_order_limits(p.milling, FrequencyResponse::of_modes(p), at, {.largest_depth_m = 2e-3});
  const auto exact = multi(p, 2e-3, {5000, 10000, 15000, 20000});
  for (std::size_t i = 0; i < at.size(); ++i) {
    EXPECT_NEAR(zeroth[i].axial_depth_m / exact[i].axial_depth_m, 1.0, 0.035);
    EXPECT_GT(std::abs(zeroth[i].axial_depth_m / exact[i].axial_depth_m - 1.0), 1e-3);
  }
}

// A mode with a half width of one line, beside others: between lines too.
TEST(FrequencyResponse, InterpolatesNarrowPeaks) {
  const FrequencyResponse exact = FrequencyResponse::of_modes(robot());
  const FrequencyResponse lines = FrequencyResponse::of_frfs(sampled(robot(), 5.0, 1000.0, 0.25), 0.0);
  for (double f = 5.0; f < 1000.0; f += 0.0371) {
    const Eigen::Matrix2cd expected = exact.at(2.0 * pi * f);
    ASSERT_LT((lines.at(2.0 * pi * f) - expected).norm(), 1e-7 * expected.norm()) << f;
    ASSERT_LT((lines.at(-2.0 * pi * f) - expected.conjugate()).norm(), 1e-7 * expected.norm()) << f;
  }
  EXPECT_FALSE(lines.covers(2.0 * pi * 4.9));
  EXPECT_TRUE(lines.covers(-2.0 * pi * 5.1));
  const Eigen::Matrix2cd at_rest = exact.at(2.0 * pi);
  EXPECT_LT((lines.at(2.0 * pi) - at_rest).norm(), 0.2 * at_rest.norm());
}

// Far above its resonance a structure is a mass.
TEST(FrequencyResponse, ContinuesAboveItsBand) {
  const FrequencyResponse exact = FrequencyResponse::of_modes(benchmark(0.05));
  const FrequencyResponse lines = FrequencyResponse::of_frfs(sampled(benchmark(0.05), 5.0, 3000.0, 1.0), 0.0);
  for (const double f : {3001.0, 4000.0, 6000.0}) {
    const Eigen::Matrix2cd expected = exact.at(2.0 * pi * f);
    EXPECT_LT((lines.at(2.0 * pi * f) - expected).norm(), 0.03 * expected.norm()) << f;
  }
}

// Noise is not taken for peaks between lines.
TEST(FrequencyResponse, NoiseStaysNoise) {
  modal::FrfSet set = sampled(benchmark(0.05), 5.0, 3000.0, 1.0);
  Random random(5);
  const double noise = 1e-3 * set.frfs.front().receptance.cwiseAbs().maxCoeff();
  for (modal::Frf& frf : set.frfs) {
    for (std::complex<double>& value : frf.receptance)
      value += noise * std::complex<double>(random.normal(), random.normal());
  }
  const FrequencyResponse exact = FrequencyResponse::of_modes(benchmark(0.05));
  const FrequencyResponse noisy = FrequencyResponse::of_frfs(set, 0.0);
  for (double f = 5.0; f < 3000.0; f += 0.137) {
    ASSERT_LT((noisy.at(2.0 * pi * f) - exact.at(2.0 * pi * f)).cwiseAbs().maxCoeff(), 12.0 * noise) << f;
  }
}

TEST(FrequencyResponse, AddsTheWorkpiece) {
  LobesProblem both = benchmark(0.3);
  both.workpiece_dynamics = testing::plane_model({testing::mass_mode(1, 400.0, 0.03, 0.5)});
  LobesProblem part = both;
  part.dynamics = both.workpiece_dynamics;
  part.workpiece_dynamics = {};
  FrequencyResponse sum = FrequencyResponse::of_modes(benchmark(0.3));
  sum += FrequencyResponse::of_frfs(sampled(part, 0.0, 4000.0, 0.5), 0.0);
  const FrequencyOptions options = {.largest_depth_m = 5e-3};
  const auto at = speeds({9000, 15000});
  const auto expected = multi_frequency_limits(both.milling, FrequencyResponse::of_modes(both), at, options);
  const auto found = multi_frequency_limits(both.milling, sum, at, options);
  for (std::size_t i = 0; i < at.size(); ++i) {
    EXPECT_NEAR(found[i].axial_depth_m / expected[i].axial_depth_m, 1.0, 1e-5);
  }
  // A measured tool has no modes: those that are named are the workpiece's.
  LobesProblem measured = both;
  measured.measured = sampled(benchmark(0.3), 0.0, 4000.0, 0.5);
  measured.dynamics = {};
  LobesOptions chart;
  chart.axial_depth_m = {0.0, 5e-3};
  chart.spindle_speed_rad_per_s = {at[0], at[1]};
  chart.method = Method::multi_frequency;
  for (const Limit& limit : limit_depths(measured, chart, at)) {
    ASSERT_EQ(limit.status, Limit::Status::found);
    EXPECT_EQ(limit.mode, (modal::ModeId{1, modal::ModeOwner::workpiece}));
  }
}

template <class F>
std::string message_of(F&& f) {
  try {
    f();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
}

TEST(FrequencyResponse, SaysWhichBandIsMissing) {
  const LobesProblem p = benchmark(0.05);
  const auto said = [&](double low_hz, double high_hz) {
    const FrequencyResponse g = FrequencyResponse::of_frfs(sampled(p, low_hz, high_hz, 1.0), 0.0);
    const auto limits = multi_frequency_limits(p.milling, g, speeds({10000, 20000}), {.largest_depth_m = 0.01});
    return message_of([&] { require_coverage(g, limits); });
  };
  EXPECT_EQ(said(5.0, 3000.0), "accepted");
  EXPECT_NE(said(100.0, 900.0).find("band above 900 Hz missing"), std::string::npos) << said(100.0, 900.0);
  EXPECT_NE(said(100.0, 1200.0).find("band above 1200 Hz missing"), std::string::npos) << said(100.0, 1200.0);
  // The flank of a mode far above.
  EXPECT_NE(said(1.0, 400.0).find("band above 400 Hz missing"), std::string::npos) << said(1.0, 400.0);
  EXPECT_NE(said(930.0, 4000.0).find("band 0 to 930 Hz missing"), std::string::npos) << said(930.0, 4000.0);
}

TEST(FrequencyDomain, RejectsWhatCannotBe) {
  const FrequencyResponse g = FrequencyResponse::of_modes(benchmark(0.05));
  const auto rejected = [&](auto change, double speed = 500.0, double depth_m = 0.01) {
    LobesProblem p = benchmark(0.05);
    change(p.milling);
    const std::string multi = message_of(
        [&] { static_cast<void>(multi_frequency_limits(p.milling, g, {speed}, {.largest_depth_m = depth_m})); });
    const std::string zeroth = message_of(
        [&] { static_cast<void>(zeroth_order_limits(p.milling, g, {speed}, {.largest_depth_m = depth_m})); });
    EXPECT_EQ(multi, zeroth);
    return multi;
  };
  EXPECT_EQ(rejected([](cutting::Milling&) {}), "accepted");
  EXPECT_EQ(rejected([](cutting::Milling&) {}, -1.0).rfind("spindle_speed_rad_per_s", 0), 0U);
  EXPECT_EQ(rejected([](cutting::Milling&) {}, 500.0, 0.0).rfind("largest_depth_m", 0), 0U);
  EXPECT_EQ(rejected([](cutting::Milling& m) { m.tool.tooth_helix_rad = {0.5, 0.6}; }).rfind("tooth_helix_rad", 0), 0U);
  EXPECT_EQ(rejected([](cutting::Milling& m) {
              m.tool.runout_m = 1e-5;
              m.feed_per_tooth_m = 1e-4;
            }).rfind("runout_m", 0),
            0U);
  EXPECT_EQ(rejected([](cutting::Milling& m) { m.speed_variation = {0.1, 0.2}; }).rfind("amplitude_ratio", 0), 0U);
  modal::FrfSet set = sampled(robot(), 5.0, 6.0, 0.25);
  EXPECT_EQ(message_of([&] { static_cast<void>(FrequencyResponse::of_frfs(set, 0.0)); }).rfind("frequency_hz", 0), 0U);
  set = sampled(robot(), 5.0, 100.0, 0.25);
  for (modal::Frf& frf : set.frfs) frf.name.response.axis = modal::Axis::z;
  EXPECT_EQ(message_of([&] {
              static_cast<void>(FrequencyResponse::of_frfs({set.frequency_hz, {set.frfs[0]}}, 0.0));
            }).rfind("frfs", 0),
            0U);
}

}  // namespace frequency_domain_test
}  // namespace robomill::stability
