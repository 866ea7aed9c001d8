#include "robomill/stability/time_steps/discretizations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "testing/stability/physical_steps.hpp"
#include "testing/stability/problems.hpp"

namespace robomill::stability::detail {
namespace discretizations_test {

using std::numbers::pi;
using testing::benchmark;
using testing::Known;
using testing::rpm;

using Make = std::unique_ptr<Scheme> (*)(const LobesProblem&, int);
constexpr std::array<Make, 2> methods = {first_order_semi_discretization, full_discretization};

Outcome at(Make make, const LobesProblem& problem, double speed_rpm, double depth_m, int intervals, Ask ask = {}) {
  const std::unique_ptr<Scheme> scheme = make(problem, intervals);
  const OperatingPoint point{speed_rpm * rpm, depth_m};
  Outcome outcome;
  scheme->evaluator()->evaluate({&point, 1}, ask, {&outcome, 1});
  return outcome;
}

double radius(Make make, const LobesProblem& problem, double speed_rpm, double depth_m, int intervals) {
  return at(make, problem, speed_rpm, depth_m, intervals).spectral_radius;
}

/// The tests' structure of test_problems.hpp in physical coordinates: x, or x and y.
struct Physical {
  Eigen::MatrixXd mass, damping, stiffness;
  explicit Physical(Eigen::Index n) {
    const double omega = 2.0 * pi * 922.0, m = 0.03993, zeta = 0.011;
    mass = m * Eigen::MatrixXd::Identity(n, n);
    damping = 2.0 * zeta * omega * mass;
    stiffness = omega * omega * mass;
  }
};

/// Spectral radius of steps x_{i+1} = from x_i - before x_{i-m} - after x_{i-m+1} with x = (u, v), all past
/// displacements in the state, the whole matrix.
struct FullStep {
  Eigen::MatrixXd from, before, after;  ///< 2n x 2n, 2n x n, 2n x n
};
template <class StepOf>
double whole_matrix_radius(Eigen::Index n, int intervals, const StepOf& step_of) {
  const Eigen::Index size = 2 * n + n * intervals;
  Eigen::MatrixXd monodromy = Eigen::MatrixXd::Identity(size, size);
  for (int i = 0; i < intervals; ++i) {
    const FullStep s = step_of(i);
    Eigen::MatrixXd step = Eigen::MatrixXd::Zero(size, size);  // state: u_i, v_i, u_{i-1}, …, u_{i-m}
    step.topLeftCorner(2 * n, 2 * n) = s.from;
    step.block(0, size - n, 2 * n, n) -= s.before;
    step.block(0, size - 2 * n, 2 * n, n) -= s.after;
    step.block(2 * n, 0, n, n).setIdentity();
    for (int j = 1; j < intervals; ++j) step.block(2 * n + n * j, 2 * n + n * (j - 1), n, n).setIdentity();
    monodromy = (step * monodromy).eval();
  }
  return linear_algebra::eigenvalues(monodromy).cwiseAbs().maxCoeff();
}

/// Semi-discretization of first order as published: K is its mean over a step, and the exponential is that of the
/// structure together with the delayed displacement and its slope. Source: [Insperger2008].
double published_first_order(const LobesProblem& problem, Eigen::Index n, double speed, double depth_m, int intervals) {
  const Physical p(n);
  const double step_rad = 2.0 * pi / problem.milling.tool.teeth / intervals;
  const double h = step_rad / speed;
  return whole_matrix_radius(n, intervals, [&](int i) {
    const Eigen::MatrixXd k =
        testing::mean_stiffness(problem.milling, i * step_rad, (i + 1) * step_rad, depth_m).topLeftCorner(n, n);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(4 * n, 4 * n);  // u, v, delayed u, what it gains in the step
    a.block(0, n, n, n).setIdentity();
    a.block(n, 0, n, n) = linear_algebra::inverse(p.mass) * (k - p.stiffness);
    a.block(n, n, n, n) = -linear_algebra::inverse(p.mass) * p.damping;
    a.block(n, 2 * n, n, n) = -linear_algebra::inverse(p.mass) * k;
    a.block(2 * n, 3 * n, n, n) = Eigen::MatrixXd::Identity(n, n) / h;
    const Eigen::MatrixXd e = testing::exponential(a * h);
    const Eigen::MatrixXd held = e.block(0, 2 * n, 2 * n, n), gained = e.block(0, 3 * n, 2 * n, n);
    return FullStep{e.topLeftCorner(2 * n, 2 * n), gained - held, -gained};
  });
}

enum class Line { through_half_means, through_end_values };

/// Full-discretization as published: ∫ s^j exp(A s) ds by the inverse of A, and a system for the state at the end of
/// each step. Source: [Ding2010], which takes K as linear between its values at the ends.
double published_full(const LobesProblem& problem, Eigen::Index n, double speed, double depth_m, int intervals,
                      Line line) {
  const Physical p(n);
  const cutting::Milling& milling = problem.milling;
  const double step_rad = 2.0 * pi / milling.tool.teeth / intervals;
  const double h = step_rad / speed;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(2 * n, 2 * n);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  a.block(0, n, n, n).setIdentity();
  a.block(n, 0, n, n) = -linear_algebra::inverse(p.mass) * p.stiffness;
  a.block(n, n, n, n) = -linear_algebra::inverse(p.mass) * p.damping;
  const Eigen::MatrixXd phi0 = testing::exponential(a * h);
  const Eigen::MatrixXd phi1 = linear_algebra::inverse(a) * (phi0 - one);
  const Eigen::MatrixXd phi2 = linear_algebra::inverse(a) * (h * phi0 - phi1);
  const Eigen::MatrixXd phi3 = linear_algebra::inverse(a) * (h * h * phi0 - 2.0 * phi2);
  const auto coefficient = [&](const Eigen::Matrix2d& k) {
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    b.block(n, 0, n, n) = linear_algebra::inverse(p.mass) * k.topLeftCorner(n, n);
    return b;
  };
  const auto value = [&](double angle) {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (int j = 0; j < milling.tool.teeth; ++j) sum += cutting::cutting_stiffness(milling, j, angle, depth_m);
    return sum;
  };
  return whole_matrix_radius(n, intervals, [&](int i) {
    const double start = i * step_rad, middle = (i + 0.5) * step_rad, end = (i + 1) * step_rad;
    Eigen::Matrix2d first = value(start), last = value(end);
    if (line == Line::through_half_means) {
      const Eigen::Matrix2d left = testing::mean_stiffness(milling, start, middle, depth_m);
      const Eigen::Matrix2d right = testing::mean_stiffness(milling, middle, end, depth_m);
      first = 1.5 * left - 0.5 * right;
      last = 1.5 * right - 0.5 * left;
    }
    const Eigen::MatrixXd constant = coefficient(last), slope = coefficient((first - last) / h);
    const Eigen::MatrixXd old = (phi2 * constant + phi3 * slope) / h;
    const Eigen::MatrixXd fresh = phi1 * constant + phi2 * slope - old;
    const Eigen::MatrixXd back = linear_algebra::inverse(Eigen::MatrixXd(one - fresh));
    return FullStep{back * (phi0 + old), back * old.leftCols(n), back * fresh.leftCols(n)};
  });
}

struct Case {
  double ratio;
  int directions;
  double speed_rpm, depth_m;
  int intervals;
};
const std::array<Case, 6> cases = {{{0.1, 1, 5000, 1e-3, 40},
                                    {0.05, 1, 12000, 3e-3, 24},
                                    {1.0, 1, 5000, 1e-3, 12},
                                    {1.0, 2, 5000, 0.2e-3, 20},
                                    {0.6, 2, 1500, 0.5e-3, 16},
                                    {1.0, 2, 400, 0.1e-3, 12}}};

// The modal forms solve the same steps as the published physical ones: agreement at every number of steps.
TEST(Discretizations, EqualThePublishedOnesInPhysicalCoordinates) {
  for (const Case& c : cases) {
    const LobesProblem problem = benchmark(c.ratio, c.directions);
    const double first = published_first_order(problem, c.directions, c.speed_rpm * rpm, c.depth_m, c.intervals);
    const double full =
        published_full(problem, c.directions, c.speed_rpm * rpm, c.depth_m, c.intervals, Line::through_half_means);
    EXPECT_NEAR(radius(methods[0], problem, c.speed_rpm, c.depth_m, c.intervals), first, 1e-8 * first) << c.ratio;
    EXPECT_NEAR(radius(methods[1], problem, c.speed_rpm, c.depth_m, c.intervals), full, 1e-8 * full) << c.ratio;
  }
}

// A line through K's values at the ends differs from one through its means by the square of the step where K is smooth.
TEST(Discretizations, FullDiscretizationsLineStaysNearTheEndValues) {
  const LobesProblem problem = benchmark(1.0, 1);
  const auto apart = [&](int intervals) {
    return radius(methods[1], problem, 5000, 1e-3, intervals) -
           published_full(problem, 1, 5000 * rpm, 1e-3, intervals, Line::through_end_values);
  };
  EXPECT_LT(std::abs(apart(40)), 0.01);
  EXPECT_NEAR(std::log2(apart(20) / apart(80)) / 2.0, 2.0, 0.3);
}

// Order 2, towards the radii that collocation reaches. Where teeth enter and leave within a step the errors are less
// even than in the slot. (Through end values full-discretization would be of the order 1 there.)
TEST(Discretizations, ConvergeToTheKnownRadiiWithOrderTwo) {
  for (const Make make : methods) {
    for (const Known& known : testing::known_points()) {
      const auto error = [&](int intervals) {
        return std::abs(radius(make, known.problem, known.speed_rpm, known.depth_m, intervals) - known.converged);
      };
      const cutting::Immersion& cut = known.problem.milling.immersion;
      const bool smooth = cut.exit_rad - cut.entry_rad > 3.14;
      EXPECT_NEAR(std::log2(error(40) / error(320)) / 3.0, 2.0, smooth ? 0.05 : 0.3) << known.speed_rpm;
      EXPECT_LT(error(640), 3e-4 * known.converged) << known.speed_rpm;
    }
  }
}

TEST(Discretizations, NoDepthLeavesTheStructureAlone) {
  const double decay = std::exp(-0.011 * 2.0 * pi * 922.0 * 60.0 / 5000.0 / 2.0);
  for (const Make make : methods) {
    for (const double ratio : {0.1, 1.0}) EXPECT_NEAR(radius(make, benchmark(ratio), 5000, 0.0, 40), decay, 1e-12);
  }
}

/// Helix, several teeth in the cut, a static compliance, a turned feed.
std::vector<LobesProblem> varied_problems() {
  std::vector<LobesProblem> all = {testing::robot(), benchmark(0.7), benchmark(1.0)};
  all[0].milling.tool.helix_rad = 0.5;
  all[0].feed_direction_rad = 0.8;
  all[1].milling.tool.teeth = 5;
  all[1].milling.tool.helix_rad = -0.3;
  for (const char* name : {"xx", "xy"}) {
    all[2].dynamics.residuals.push_back({.name = modal::parse_frf_name(name), .stiffness = 1e-7});
  }
  return all;
}

// Against collocation, which shares neither steps nor delayed displacements; the estimate gives the error.
TEST(Discretizations, AgreeWithCollocationWithinTheirEstimate) {
  LobesOptions options;
  for (const LobesProblem& problem : varied_problems()) {
    Random random(7);
    for (int i = 0; i < 5; ++i) {
      const double speed_rpm = random.uniform(4000.0, 20000.0), depth_m = random.uniform(0.05e-3, 0.6e-3);
      const PointResult expected = evaluate_point(problem, options, {speed_rpm * rpm, depth_m});
      for (const Make make : methods) {
        const Outcome found = at(make, problem, speed_rpm, depth_m, 160, {.estimate = true});
        const double error = std::abs(found.spectral_radius - expected.spectral_radius);
        EXPECT_LE(error, 2.0 * found.error_estimate + 1e-6) << speed_rpm << " " << depth_m;
        EXPECT_LT(found.error_estimate, 0.02 * expected.spectral_radius) << speed_rpm << " " << depth_m;
      }
    }
  }
}

TEST(Discretizations, FindTheMotionThatCollocationFinds) {
  for (const Known& known : testing::known_points()) {
    const PointResult expected = evaluate_point(known.problem, {}, {known.speed_rpm * rpm, known.depth_m});
    for (const Make make : methods) {
      const Outcome found = at(make, known.problem, known.speed_rpm, known.depth_m, 320, {.motion = true});
      EXPECT_NEAR(found.chatter_frequency_hz, expected.chatter_frequency_hz, 0.1);
      EXPECT_EQ(found.kind, expected.kind);
      // The two modes of the benchmark are equal, and in a slot so are their motions.
      if (known.problem.dynamics.modes.size() != 2) {
        EXPECT_EQ(found.mode, expected.mode);
      }
    }
  }
}

// Each lane has its own point.
TEST(Discretizations, LanesDoNotMeet) {
  for (const double helix : {0.0, 0.5}) {
    LobesProblem problem = testing::robot();
    problem.milling.tool.helix_rad = helix;
    std::vector<OperatingPoint> points;
    for (int i = 0; i < 8; ++i) points.push_back({(5000 + 900 * i) * rpm, 0.4e-3 * (7 - i)});
    for (const Make make : methods) {
      const std::unique_ptr<Scheme> scheme = make(problem, 40);
      const std::vector<double> depths = {0.4e-3, 0.8e-3};  // some from store, some not
      scheme->expect(depths);
      std::vector<Outcome> together(8);
      scheme->evaluator()->evaluate(points, {.motion = true}, together);
      for (std::size_t i = 0; i < 8; ++i) {
        Outcome alone;
        scheme->evaluator()->evaluate({&points[i], 1}, {.motion = true}, {&alone, 1});
        EXPECT_NEAR(std::abs(alone.multiplier - together[i].multiplier), 0.0, 1e-11) << i;
        EXPECT_EQ(alone.mode, together[i].mode) << i;
      }
    }
  }
}

// One helix angle for all teeth is one helix, however it is given.
TEST(Discretizations, TakeEqualToothHelixAsHelix) {
  LobesProblem helix = testing::robot(), each = testing::robot();
  helix.milling.tool.helix_rad = 0.5;
  each.milling.tool.tooth_helix_rad = {0.5, 0.5, 0.5};
  for (const Make make : {methods[0], methods[1], Make{semi_discretization}}) {
    EXPECT_EQ(radius(make, helix, 6500, 1e-3, 40), radius(make, each, 6500, 1e-3, 40));
  }
}

TEST(Discretizations, StayFiniteWhateverIsAsked) {
  for (const Make make : methods) {
    for (const double speed_rpm : {0.5, 300.0, 1e6}) {
      for (const double depth_m : {1e-9, 0.01, 0.5}) {
        const Outcome found = at(make, benchmark(0.3), speed_rpm, depth_m, 4, {.estimate = true, .motion = true});
        EXPECT_TRUE(std::isfinite(found.spectral_radius) && std::isfinite(std::abs(found.multiplier)));
        EXPECT_TRUE(std::isfinite(found.error_estimate) && std::isfinite(found.chatter_frequency_hz));
      }
    }
  }
}

TEST(Discretizations, RejectWhatTheyDoNotKnow) {
  const auto rejected = [](auto change) {
    LobesProblem problem = testing::robot();
    change(problem.milling);
    std::string fields;
    for (const Make make : methods) {
      try {
        make(problem, 40);
        ADD_FAILURE() << "not rejected";
      } catch (const InvalidInput& e) {
        fields += e.parts().field + " ";
        EXPECT_NE(std::string(e.what()).find("discretization"), std::string::npos);
      }
    }
    return fields;
  };
  using cutting::Milling;
  EXPECT_EQ(rejected([](Milling& m) { m.tool.pitch_rad = {2.0, 2.1, 2.0 * pi - 4.1}; }), "pitch_rad pitch_rad ");
  EXPECT_EQ(rejected([](Milling& m) { m.tool.tooth_helix_rad = {0.5, 0.6, 0.5}; }), "tooth_helix_rad tooth_helix_rad ");
  EXPECT_EQ(rejected([](Milling& m) { m.tool.runout_m = 1e-5; }), "runout_m runout_m ");
  EXPECT_EQ(rejected([](Milling& m) { m.process_damping = {.indentation_n_per_m3 = 3e13, .wear_land_m = 8e-5}; }),
            "indentation_n_per_m3 indentation_n_per_m3 ");
  EXPECT_EQ(rejected([](Milling& m) { m.speed_variation = {.amplitude_ratio = 0.1, .frequency_ratio = 0.1}; }),
            "amplitude_ratio amplitude_ratio ");
}

}  // namespace discretizations_test
}  // namespace robomill::stability::detail
