#include "robomill/stability/time_steps/monodromy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <complex>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

#include "robomill/base/linear_algebra.hpp"
#include "robomill/base/random.hpp"
#include "robomill/stability/time_steps/evaluator.hpp"
#include "testing/stability/physical_steps.hpp"
#include "testing/stability/problems.hpp"
#include "testing/support.hpp"

namespace robomill::stability::detail {
namespace monodromy_test {

using std::numbers::pi;
using test::seeds;
using testing::exponential;
using testing::mean_stiffness;
using testing::rpm;

/// Spectral radius as published: physical coordinates u, v, one matrix exponential a step, all past positions in the
/// state, the whole matrix. Source: [Insperger2004] with the delay a whole number of steps, so that both weights are
/// one half.
double published_radius(const cutting::Milling& milling, const Eigen::MatrixXd& mass, const Eigen::MatrixXd& damping,
                        const Eigen::MatrixXd& stiffness, double speed, double depth_m, int intervals) {
  const Eigen::Index n = 2;
  const double step_rad = 2.0 * pi / milling.tool.teeth / intervals;
  const double step_s = step_rad / speed;
  const Eigen::Index size = 2 * n + n * intervals;
  Eigen::MatrixXd monodromy = Eigen::MatrixXd::Identity(size, size);
  const Eigen::MatrixXd mass_inverse = linear_algebra::inverse(mass);
  for (int i = 0; i < intervals; ++i) {
    const Eigen::Matrix2d k = mean_stiffness(milling, i * step_rad, (i + 1) * step_rad, depth_m);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    a.block(0, n, n, n).setIdentity();
    a.block(n, 0, n, n) = mass_inverse * (k - stiffness);
    a.block(n, n, n, n) = -mass_inverse * damping;
    a.block(n, 2 * n, n, n) = -mass_inverse * k;
    const Eigen::MatrixXd p = exponential(a * step_s);
    // State: u_i, v_i, u_{i-1}, …, u_{i-m}.
    Eigen::MatrixXd step = Eigen::MatrixXd::Zero(size, size);
    step.topLeftCorner(2 * n, 2 * n) = p.topLeftCorner(2 * n, 2 * n);
    step.block(0, size - n, 2 * n, n) += 0.5 * p.block(0, 2 * n, 2 * n, n);
    step.block(0, size - 2 * n, 2 * n, n) += 0.5 * p.block(0, 2 * n, 2 * n, n);
    step.block(2 * n, 0, n, n).setIdentity();
    for (int j = 1; j < intervals; ++j) step.block(2 * n + n * j, 2 * n + n * (j - 1), n, n).setIdentity();
    monodromy = (step * monodromy).eval();
  }
  return linear_algebra::eigenvalues(monodromy).cwiseAbs().maxCoeff();
}

Dominant evaluate(const LobesProblem& problem, double speed, double depth_m, int intervals,
                  const ArnoldiOptions& options = {}) {
  const Model model(problem, intervals);
  Evaluator evaluator(model, options);
  const Evaluator::Point point{speed, depth_m, nullptr};
  Dominant dominant;
  evaluator.evaluate({&point, 1}, {&dominant, 1});
  return dominant;
}

// The modal form solves the same steps as the published physical one: agreement at every number of steps, not in the
// limit.
TEST(Monodromy, EqualsThePublishedDiscretizationInPhysicalCoordinates) {
  const double omega = 2.0 * pi * 922.0, m = 0.03993, zeta = 0.011;
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  struct Case {
    double ratio, speed_rpm, depth_m;
    int intervals;
  };
  for (const Case& c : {Case{0.1, 5000, 1e-3, 40}, Case{0.05, 12000, 3e-3, 24}, Case{1.0, 5000, 0.2e-3, 20},
                        Case{0.6, 1500, 0.5e-3, 16}, Case{1.0, 400, 1e-3, 12}}) {
    const LobesProblem problem = testing::benchmark(c.ratio);
    const double expected = published_radius(problem.milling, m * one, 2.0 * zeta * omega * m * one,
                                             omega * omega * m * one, c.speed_rpm * rpm, c.depth_m, c.intervals);
    const Dominant found = evaluate(problem, c.speed_rpm * rpm, c.depth_m, c.intervals);
    EXPECT_NEAR(spectral_radius(found), expected, 1e-8 * expected) << c.ratio << " " << c.speed_rpm;
  }
}

LobesProblem random_problem(Random& random) {
  LobesProblem p;
  p.milling.tool.teeth = 1 + static_cast<int>(random.index(5));
  p.milling.tool.diameter_m = random.uniform(0.004, 0.04);
  if (random.index(2) == 0) p.milling.tool.helix_rad = random.uniform(-0.7, 0.7);
  p.milling.immersion.entry_rad = random.uniform(0.0, 0.9 * pi);
  p.milling.immersion.exit_rad = random.uniform(p.milling.immersion.entry_rad + 0.2, pi);
  p.milling.coefficients = {.tangential_n_per_m2 = random.uniform(2e8, 2e9),
                            .radial_n_per_m2 = random.uniform(0.0, 1e9)};
  p.feed_direction_rad = random.uniform(0.0, 2.0 * pi);
  p.dynamics.excitations = p.dynamics.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}};
  const std::size_t count = 1 + random.index(9);
  for (std::size_t k = 0; k < count; ++k) {
    modal::Mode mode = testing::mass_mode(0, random.uniform(20.0, 2000.0), random.uniform(0.005, 0.1), 1.0);
    const double size = std::sqrt(1.0 / (2.0 * random.uniform(0.05, 2.0) * modal::pole(mode).imag()));
    const auto entry = [&] { return size * std::complex<double>(random.normal(), random.normal()); };
    mode.left << entry(), entry();
    mode.right << entry(), entry();
    p.dynamics.modes.push_back(mode);
  }
  if (random.index(3) == 0) {
    p.dynamics.residuals.push_back({.name = modal::parse_frf_name("xx"), .stiffness = random.uniform(0.0, 3e-8)});
    p.dynamics.residuals.push_back({.name = modal::parse_frf_name("xy"), .stiffness = random.uniform(0.0, 3e-8)});
  }
  if (p.milling.tool.teeth > 1 && random.index(4) == 0) {
    const double shift = random.uniform(0.01, 0.2);
    p.milling.tool.pitch_rad.assign(static_cast<std::size_t>(p.milling.tool.teeth), 2.0 * pi / p.milling.tool.teeth);
    p.milling.tool.pitch_rad[0] += shift;
    p.milling.tool.pitch_rad[1] -= shift;
  }
  return p;
}

TEST(Arnoldi, FindsWhatTheWholeMatrixHas) {
  int by_arnoldi = 0;
  for (int seed = 0; seed < seeds(1000); ++seed) {
    Random random(11, static_cast<std::uint64_t>(seed));
    const LobesProblem problem = random_problem(random);
    const double speed = random.uniform(1000.0, 20000.0) * rpm;
    const double depth_m = random.uniform(0.0, 3e-3);
    const int intervals = 10 + static_cast<int>(random.index(30));
    const Dominant found = evaluate(problem, speed, depth_m, intervals);
    const Dominant whole = evaluate(problem, speed, depth_m, intervals, {.full_matrix_only = true});
    ASSERT_EQ(whole.by, Dominant::By::full_matrix);
    EXPECT_NEAR(spectral_radius(found), spectral_radius(whole), 1e-9 * spectral_radius(whole)) << seed;
    if (found.by == Dominant::By::arnoldi) ++by_arnoldi;
  }
  EXPECT_GE(by_arnoldi, seeds(1000) * 99 / 100);
}

TEST(Arnoldi, FallsBackOnTheWholeMatrix) {
  const LobesProblem problem = testing::robot();
  const Dominant settled = evaluate(problem, 6500 * rpm, 1e-3, 40);
  const Dominant hurried = evaluate(problem, 6500 * rpm, 1e-3, 40, {.tolerance = 1e-12, .extra = 0});
  EXPECT_EQ(settled.by, Dominant::By::arnoldi);
  EXPECT_EQ(hurried.by, Dominant::By::full_matrix);
  EXPECT_NEAR(std::abs(settled.multiplier - hurried.multiplier), 0.0, 1e-10);
  const Dominant nothing = evaluate(problem, 6500 * rpm, 1e-3, 40, {.extra = 0, .largest_matrix = 10});
  EXPECT_EQ(nothing.by, Dominant::By::unsettled);
}

// The residual is what it says: the eigenvector goes through the period and comes back times the multiplier.
TEST(Arnoldi, ItsVectorComesBackTimesTheMultiplier) {
  const Model model(testing::robot(), 40);
  SpeedPlan speed;
  DepthPlan depth;
  model.cut.at_depth(1e-3, depth);
  const double step_s = model.cut.step_rad() / (6500 * rpm);
  plan_speed(model.tip, step_s, resolution(model.tip, step_s, depth.largest_n_per_m), speed);
  Monodromy monodromy(model.tip, model.cut);
  const LanePoint point{&speed, &depth};
  monodromy.prepare({&point, 1});
  Arnoldi arnoldi;
  Dominant dominant;
  arnoldi.find(monodromy, {&dominant, 1});
  const Eigen::VectorXcd x = arnoldi.vector(0);
  ASSERT_EQ(static_cast<std::size_t>(x.size()), monodromy.size());
  std::vector<Lanes> in(monodromy.size(), Lanes{}), out(monodromy.size());
  Eigen::VectorXcd image(x.size());
  for (const bool imaginary : {false, true}) {
    for (std::size_t i = 0; i < in.size(); ++i) {
      const std::complex<double> entry = x(static_cast<Eigen::Index>(i));
      in[i].v[0] = imaginary ? entry.imag() : entry.real();
    }
    monodromy.apply(in.data(), out.data());
    for (std::size_t i = 0; i < in.size(); ++i) {
      const std::complex<double> part = imaginary ? std::complex<double>(0.0, 1.0) : 1.0;
      std::complex<double>& entry = image(static_cast<Eigen::Index>(i));
      entry = (imaginary ? entry : 0.0) + part * out[i].v[0];
    }
  }
  EXPECT_NEAR(x.norm(), 1.0, 1e-12);
  EXPECT_LT((image - dominant.multiplier * x).norm(), 1e-11);
}

/// Each entry of the state by itself: 1, a half, a quarter, … of `first`.
class Halving final : public PeriodMap {
 public:
  Halving(std::size_t size, double first) : size_(size), first_(first) {}
  [[nodiscard]] std::size_t size() const override { return size_; }
  [[nodiscard]] std::size_t modal_size() const override { return 2; }
  void apply(const Lanes* in, Lanes* out) override {
    double factor = first_;
    for (std::size_t i = 0; i < size_; ++i, factor *= 0.5) {
      for (std::size_t lane = 0; lane < lane_count; ++lane) out[i].v[lane] = factor * in[i].v[lane];
    }
  }

 private:
  std::size_t size_;
  double first_;
};

TEST(Arnoldi, KeepsNoVectorOfTheFindBefore) {
  Halving fades(40, 0.9);
  Halving overflows(10, std::numeric_limits<double>::infinity());
  Arnoldi arnoldi;
  Dominant dominant;
  arnoldi.find(fades, {&dominant, 1});
  EXPECT_NEAR(dominant.multiplier.real(), 0.9, 1e-10);
  EXPECT_NEAR(std::abs(arnoldi.vector(0)(0)), 1.0, 1e-10);
  arnoldi.find(overflows, {&dominant, 1});
  EXPECT_EQ(dominant.by, Dominant::By::unsettled);
  EXPECT_EQ(spectral_radius(dominant), 1e100);
  ASSERT_EQ(arnoldi.vector(0).size(), 10);
  EXPECT_TRUE(arnoldi.vector(0).isZero(0.0));
}

// Steps that nobody looks back at are not remembered: 45.6° of 120° are in cut, 16 of 40 steps.
TEST(Monodromy, RemembersTwoNumbersForEachStepThatCuts) {
  const Model model(testing::robot(), 40);
  SpeedPlan speed;
  DepthPlan depth;
  model.cut.at_depth(1e-3, depth);
  plan_speed(model.tip, 1e-4, resolution(model.tip, 1e-4, depth.largest_n_per_m), speed);
  Monodromy monodromy(model.tip, model.cut);
  const LanePoint point{&speed, &depth};
  monodromy.prepare({&point, 1});
  EXPECT_EQ(monodromy.cut_steps().size(), 16U);
  EXPECT_EQ(monodromy.size(), 2U * 8U + 2U * 16U);
}

TEST(Kernels, HaveTheSameBitsOnEveryMachine) {
  const Model model(testing::robot(), 40);
  std::vector<Evaluator::Point> points;
  for (int i = 0; i < 8; ++i) points.push_back({(5000 + 100 * i) * rpm, 0.3e-3 * i, nullptr});
  const auto all = [&](Kernels which) {
    kernels() = which;
    Evaluator evaluator(model);
    std::vector<Dominant> found(8);
    evaluator.evaluate(points, found);
    return found;
  };
  const Kernels best = best_kernels();
  const std::vector<Dominant> reference = all(Kernels::baseline);
  for (const Kernels which : {Kernels::avx2, Kernels::avx512}) {
    if (static_cast<int>(which) > static_cast<int>(best)) continue;
    const std::vector<Dominant> found = all(which);
    for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(found[i].multiplier, reference[i].multiplier);
  }
  kernels() = best;
}

// Each lane has its own point; alone it comes out the same but for the resolution, which the lanes share.
TEST(Monodromy, LanesDoNotMeet) {
  const Model model(testing::robot(), 40);
  std::vector<Evaluator::Point> points;
  for (int i = 0; i < 8; ++i) points.push_back({(5000 + 900 * i) * rpm, 0.4e-3 * (7 - i), nullptr});
  Evaluator evaluator(model);
  std::vector<Dominant> together(8);
  evaluator.evaluate(points, together);
  for (std::size_t i = 0; i < 8; ++i) {
    Dominant alone;
    evaluator.evaluate({&points[i], 1}, {&alone, 1});
    EXPECT_NEAR(std::abs(alone.multiplier - together[i].multiplier), 0.0, 1e-11) << i;
  }
}

TEST(Hessenberg, HasTheEigenvaluesThatEigenFinds) {
  for (int seed = 0; seed < seeds(3000); ++seed) {
    Random random(5, static_cast<std::uint64_t>(seed));
    const std::size_t n = 1 + random.index(30);
    Hessenberg hessenberg;
    hessenberg.resize(n);
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    for (std::size_t r = 0; r < n; ++r) {
      for (std::size_t c = r == 0 ? 0 : r - 1; c < n; ++c) {
        const double entry = random.normal() * std::exp(seed % 3 == 0 ? 3.0 * random.normal() : 0.0);
        hessenberg(r, c) = matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = entry;
      }
    }
    std::complex<double> value;
    ASSERT_TRUE(hessenberg.dominant(value)) << seed;
    EXPECT_GE(value.imag(), 0.0);
    const double expected = linear_algebra::eigenvalues(matrix).cwiseAbs().maxCoeff();
    EXPECT_NEAR(std::abs(value), expected, 1e-9 * matrix.norm()) << seed;
    const auto& y = hessenberg.vector(value);
    const Eigen::VectorXcd v = Eigen::Map<const Eigen::VectorXcd>(y.data(), static_cast<Eigen::Index>(n));
    EXPECT_NEAR(v.norm(), 1.0, 1e-12);
    EXPECT_LT((matrix.cast<std::complex<double>>() * v - value * v).norm(), 1e-11 * matrix.norm()) << seed;
  }
}

TEST(Hessenberg, SolvesTheAwkwardOnes) {
  Hessenberg hessenberg;
  std::complex<double> value;
  hessenberg.resize(3);  // all zero
  EXPECT_TRUE(hessenberg.dominant(value));
  EXPECT_EQ(value, 0.0);
  for (std::size_t i = 0; i < 3; ++i) hessenberg((i + 1) % 3, i) = 1.0;  // a cycle, on which plain shifts stand still
  ASSERT_TRUE(hessenberg.dominant(value));
  EXPECT_NEAR(std::abs(value), 1.0, 1e-12);
  hessenberg.resize(2);
  hessenberg(0, 0) = hessenberg(1, 1) = 3.0;
  hessenberg(0, 1) = 1.0;  // one vector for two eigenvalues
  ASSERT_TRUE(hessenberg.dominant(value));
  EXPECT_NEAR(value.real(), 3.0, 1e-12);
  hessenberg(0, 0) = std::nan("");
  EXPECT_FALSE(hessenberg.dominant(value) && std::isfinite(value.real()));
}

}  // namespace monodromy_test
}  // namespace robomill::stability::detail
