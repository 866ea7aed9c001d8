#include "robomill/modal/fitting/fit_kernel.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "robomill/base/random.hpp"

namespace robomill::modal::detail {
namespace fit_kernel_test {

using Complex = std::complex<double>;
using Eigen::Index;

struct Problem {
  FitData data;
  Poles poles;
};

// Random data, weights and poles; the entry yx is missing where `partial`.
Problem random_problem(std::uint64_t seed, bool residuals, bool partial) {
  Random random(seed);
  Problem p;
  p.data.omega = Eigen::VectorXd::LinSpaced(60, 0.05, 1.0);
  p.data.responses = 2;
  p.data.excitations = 2;
  p.data.residuals = residuals;
  for (Index j = 0; j < 2; ++j) {
    for (Index i = 0; i < 2; ++i) {
      if (partial && i == 1 && j == 0) continue;
      FitEntry entry{.response = i, .excitation = j, .receptance = Eigen::VectorXcd(60), .weight = Eigen::VectorXd(60)};
      for (Complex& v : entry.receptance) v = {random.normal(), random.normal()};
      for (double& w : entry.weight) w = random.uniform(0.5, 2.0);
      p.data.entries.push_back(entry);
    }
  }
  p.poles.omega = Eigen::Vector3d(random.uniform(0.1, 0.3), random.uniform(0.3, 0.6), random.uniform(0.6, 0.9));
  p.poles.zeta = Eigen::Vector3d(random.uniform(0.01, 0.2), random.uniform(0.01, 0.2), random.uniform(0.01, 0.2));
  p.poles.left.resize(2, 3);
  for (Complex& v : p.poles.left.reshaped()) v = {random.normal(), random.normal()};
  p.poles.fix_gauge();
  return p;
}

// The same residual by stacking every real equation, with a rank-revealing QR: columns are the linear unknowns.
Eigen::VectorXd dense_residual(const FitData& data, const Poles& poles) {
  const Index n = data.omega.size();
  const auto entries = static_cast<Index>(data.entries.size());
  const Index modes = poles.size();
  const Index unknowns = 2 * modes * data.responses + (data.residuals ? 4 * entries : 0);
  Eigen::MatrixXcd a = Eigen::MatrixXcd::Zero(n * entries, unknowns);
  Eigen::VectorXcd b(n * entries);
  for (Index f = 0; f < entries; ++f) {
    const FitEntry& entry = data.entries[static_cast<std::size_t>(f)];
    for (Index l = 0; l < n; ++l) {
      const Complex s(0.0, data.omega(l));
      const double w = entry.weight(l);
      b(f * n + l) = w * entry.receptance(l);
      for (Index k = 0; k < modes; ++k) {
        const Complex left = poles.left(entry.excitation, k);
        const Complex p = left / (s - poles.pole(k));
        const Complex q = std::conj(left) / (s - std::conj(poles.pole(k)));
        const Index column = 2 * (entry.response * modes + k);
        a(f * n + l, column) = w * (p + q);
        a(f * n + l, column + 1) = w * Complex(0.0, 1.0) * (p - q);
      }
      if (!data.residuals) continue;
      const Index tail = 2 * modes * data.responses + 4 * f;
      a(f * n + l, tail) = w;
      a(f * n + l, tail + 1) = Complex(0.0, w);
      a(f * n + l, tail + 2) = w / (s * s);
      a(f * n + l, tail + 3) = Complex(0.0, w) / (s * s);
    }
  }
  Eigen::MatrixXd real(2 * n * entries, unknowns);
  real << a.real(), a.imag();
  Eigen::VectorXd rhs(2 * n * entries);
  rhs << b.real(), b.imag();
  return rhs - real * real.colPivHouseholderQr().solve(rhs);
}

TEST(FitKernel, CostIsThatOfDenseLeastSquares) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Problem p = random_problem(seed, seed % 2 == 0, seed % 3 == 0);
    const Evaluation e = Kernel(p.data).evaluate(p.poles, false);
    const double expected = dense_residual(p.data, p.poles).squaredNorm();
    EXPECT_NEAR(e.cost, expected, 1e-10 * expected);
  }
}

TEST(FitKernel, GradientIsThatOfTheCost) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const Problem p = random_problem(seed, seed % 2 == 0, seed % 3 == 0);
    const Kernel kernel(p.data);
    const Evaluation e = kernel.evaluate(p.poles, true);
    const Eigen::VectorXd at = to_parameters(p.poles);
    ASSERT_EQ(at.size(), parameter_count(p.data, p.poles.size()));
    for (Index i = 0; i < at.size(); ++i) {
      const double step = 1e-5;
      Eigen::VectorXd up = at;
      Eigen::VectorXd down = at;
      up(i) += step;
      down(i) -= step;
      const double slope = (kernel.evaluate(from_parameters(up, p.poles), false).cost -
                            kernel.evaluate(from_parameters(down, p.poles), false).cost) /
                           (2.0 * step);
      EXPECT_NEAR(-2.0 * e.gradient(i), slope, 1e-5 * (1.0 + std::abs(slope))) << "seed " << seed << " parameter " << i;
    }
  }
}

// Kaufman's form of the reduced JᵀJ: derivatives of the dense residual at fixed linear parameters, projected. With data
// that the model explains exactly it equals JᵀJ of the variable projection.
TEST(FitKernel, HessianIsThatOfTheReducedResidualAtAnExactFit) {
  for (const bool partial : {false, true}) {
    Problem p = random_problem(11, true, partial);
    Evaluation e = Kernel(p.data).evaluate(p.poles, false);
    for (std::size_t f = 0; f < p.data.entries.size(); ++f)
      p.data.entries[f].receptance -= e.residual.col(static_cast<Index>(f));
    e = Kernel(p.data).evaluate(p.poles, true);
    EXPECT_LT(e.cost, 1e-20);
    const Eigen::VectorXd at = to_parameters(p.poles);
    Eigen::MatrixXd jacobian(dense_residual(p.data, p.poles).size(), at.size());
    for (Index i = 0; i < at.size(); ++i) {
      const double step = 1e-6;
      Eigen::VectorXd up = at;
      Eigen::VectorXd down = at;
      up(i) += step;
      down(i) -= step;
      jacobian.col(i) = (dense_residual(p.data, from_parameters(up, p.poles)) -
                         dense_residual(p.data, from_parameters(down, p.poles))) /
                        (2.0 * step);
    }
    const Eigen::MatrixXd expected = jacobian.transpose() * jacobian;
    EXPECT_LT((e.hessian - expected).norm(), 1e-6 * expected.norm());
  }
}

TEST(FitKernel, LossIsWhatTheCostRises) {
  const Problem p = random_problem(7, true, true);
  const Kernel kernel(p.data);
  const Evaluation all = kernel.evaluate(p.poles, true);
  for (Index k = 0; k < p.poles.size(); ++k) {
    const double cost = kernel.evaluate(p.poles.without(k), false).cost;
    EXPECT_NEAR(all.loss(k), cost - all.cost, 1e-9 * cost);
  }
}

TEST(FitKernel, GainOfACandidateIsWhatTheCostFalls) {
  // With one excitation a residue matrix has rank one, so the gain is exact.
  Problem p = random_problem(5, true, false);
  p.data.excitations = 1;
  p.data.entries.resize(2);
  p.poles.left = Eigen::MatrixXcd::Ones(1, 3);
  p.poles.fix_gauge();
  const Kernel kernel(p.data);
  const Evaluation base = kernel.evaluate(p.poles, false);
  std::vector<Candidate> candidates;
  for (const double omega : {0.07, 0.2, 0.45, 0.97}) {
    for (const double zeta : {0.005, 0.05, 0.3}) candidates.push_back({.omega = omega, .zeta = zeta});
  }
  kernel.measure(candidates, p.poles, base);
  for (const Candidate& c : candidates) {
    const Poles more = p.poles.with(c.omega, c.zeta, Eigen::VectorXcd::Ones(1));
    const Evaluation e = kernel.evaluate(more, false);
    EXPECT_NEAR(c.gain, base.cost - e.cost, 1e-8 * base.cost);
    EXPECT_LT((c.residue - e.right.col(3)).norm(), 1e-6 * e.right.col(3).norm());
  }
}

}  // namespace fit_kernel_test
}  // namespace robomill::modal::detail
