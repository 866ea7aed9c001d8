#include "robomill/coupling/distributed.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>

#include "robomill/coupling/base.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/coupling/joint_model.hpp"
#include "testing/coupling/joints.hpp"
#include "testing/support.hpp"

namespace robomill::coupling {
namespace distributed_test {

using detail::JointModel;
using detail::JointValues;
using Eigen::Index;
using testing::bar;
using testing::tip_with;
using testing::values_of;

/// Receptance of a shank's mouth on a bed of springs to the ground, Euler and Bernoulli:
///   EI w⁗ - γ w″ + (κ - ρA ω²) w = 0,  κ and γ the translational and the rotational stiffness per length,
/// with f = EI w‴ - γ w′, m = -EI w″ at the mouth, and both zero at the deep end.
Eigen::Matrix2cd bed_receptance(const Segment& s, const Joint& joint, double frequency_hz) {
  using Complex = std::complex<double>;
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  const Complex i_omega(0.0, omega);
  const Complex ei = testing::bending_stiffness(s) * Complex(1.0, s.loss_factor);
  const Complex kappa =
      (joint.translational_stiffness_n_per_m + i_omega * joint.translational_damping_n_s_per_m) / s.length_m;
  const Complex gamma =
      (joint.rotational_stiffness_n_m_per_rad + i_omega * joint.rotational_damping_n_m_s_per_rad) / s.length_m;
  const Complex rest = kappa - omega * omega * testing::mass_per_length(s);
  const Complex root = std::sqrt(gamma * gamma - 4.0 * ei * rest);
  Eigen::Vector4cd power;
  power.head<2>() << std::sqrt((gamma + root) / (2.0 * ei)), std::sqrt((gamma - root) / (2.0 * ei));
  power.tail<2>() = -power.head<2>();
  Eigen::Matrix4cd loads;              // f and m at the mouth, then at the deep end
  Eigen::Matrix<Complex, 2, 4> moved;  // u and θ at the mouth
  for (Eigen::Index k = 0; k < 4; ++k) {
    const Complex p = power(k);
    const Complex deep = std::exp(p * s.length_m);
    loads.col(k) << ei * p * p * p - gamma * p, -ei * p * p, (ei * p * p * p - gamma * p) * deep, -ei * p * p * deep;
    moved.col(k) << 1.0, p;
  }
  return moved * loads.fullPivLu().inverse().leftCols<2>();
}

// Two methods: the row of springs, whose error falls with the first power of their spacing, and the bed's equation.
TEST(Distributed, ARowOfSpringsBecomesTheBeamOnAnElasticFoundation) {
  Assembly assembly{.tool = {bar(0.11892)}, .joint = {}, .holder = {}};
  // Beside the modes, where the tip answers to the joint in proportion.
  Eigen::VectorXd f(20);
  f << Eigen::VectorXd::LinSpaced(10, 20.0, 200.0), Eigen::VectorXd::LinSpaced(10, 700.0, 1200.0);
  Joint joint{.translational_stiffness_n_per_m = 5e7,
              .translational_damping_n_s_per_m = 50.0,
              .rotational_stiffness_n_m_per_rad = 3e4,
              .rotational_damping_n_m_s_per_rad = 0.5,
              .insertion_length_m = 0.0509,
              .shank = {bar(0.0509)}};
  const auto row = [&](int points) {
    joint.points = points;
    assembly.joint = joint;
    return testing::receptance(tip_frfs(assembly, f).frfs, "xx");
  };
  const std::vector<detail::BeamElement> tool = detail::beam_elements(assembly.tool, f);
  Eigen::VectorXcd bed(f.size());
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    bed(i) = detail::on_base<2>(tool[static_cast<std::size_t>(i)], bed_receptance(joint.shank[0], joint, f(i)))(0, 0);
  }
  const Eigen::VectorXcd most = row(97);
  const Eigen::VectorXcd half = row(49);
  const double error = (most - bed).norm() / bed.norm();
  EXPECT_LT(error, 0.02);
  EXPECT_NEAR((half - bed).norm() / bed.norm(), 2.0 * error, 0.3 * error);
  // Without the first power of the spacing nothing is left of the difference but its square.
  EXPECT_LT((2.0 * most - half - bed).norm(), 0.05 * error * bed.norm());
}

/// The bar on several points over 50.90 mm of a rigid collet.
Assembly in_collet(int points) {
  Assembly assembly{.tool = {bar(0.11892)}, .joint = {}, .holder = {}};
  assembly.joint = Joint{.points = points, .insertion_length_m = 0.0509, .shank = {bar(0.0509)}};
  return assembly;
}

Joint with_values(Joint joint, const JointValues& values) {
  joint.translational_stiffness_n_per_m = values[0];
  joint.translational_damping_n_s_per_m = values[1];
  joint.rotational_stiffness_n_m_per_rad = values[2];
  joint.rotational_damping_n_m_s_per_rad = values[3];
  return joint;
}

TEST(Distributed, FindsAJointThatIsSpreadOverTheShank) {
  const JointValues truth = {2e8, 2000.0, 2e4, 2.0};
  for (const bool holder_moves : {false, true}) {
    Assembly assembly = in_collet(3);
    if (holder_moves) {
      assembly.holder.segments = {bar(0.08)};
      assembly.holder.segments[0].diameter_m = 0.03;
      assembly.holder.segments[0].inner_diameter_m = 0.012;
    }
    const modal::FrfSet measured =
        tip_with(assembly, with_values(*assembly.joint, truth), Eigen::VectorXd::LinSpaced(60, 10.0, 4000.0));
    const JointFitResult found = fit_joint(assembly, measured, {});
    EXPECT_EQ(found.status, JointFitResult::Status::converged);
    EXPECT_LT(found.relative_error, 1e-6);
    for (std::size_t i = 0; i < truth.size(); ++i)
      EXPECT_NEAR(values_of(found.joint)[i], truth[i], 1e-3 * truth[i]) << i;
    EXPECT_EQ(found.joint.points, 3);
    EXPECT_EQ(found.joint.shank.size(), 1U);
    // One point at the mouth of the same tool, the shank's end clamped behind it, cannot give the same FRF.
    const JointFitResult at_mouth = fit_joint(testing::published_pair(), measured, {});
    EXPECT_GT(at_mouth.relative_error, 100.0 * found.relative_error);
  }
}

// A line where the elements overflow has no receptance: nothing is searched with NaN.
TEST(Distributed, RejectsALineWithoutAReceptance) {
  for (const int points : {1, 3}) {
    Assembly assembly = in_collet(3);
    assembly.joint->points = points;
    if (points == 1) assembly.joint = Joint{};
    modal::FrfSet measured = tip_with(in_collet(3), with_values(*in_collet(3).joint, {2e8, 2000.0, 2e4, 2.0}),
                                      Eigen::VectorXd::LinSpaced(60, 10.0, 4000.0));
    measured.frequency_hz(59) = 1e200;
    for (const JointMethod method : {JointMethod::hybrid, JointMethod::ga}) {
      const std::string said =
          test::rejection([&] { static_cast<void>(fit_joint(assembly, measured, {.method = method})); });
      EXPECT_NE(said.find("frequency_hz = 1e+200 Hz"), std::string::npos) << points << ": " << said;
    }
  }
}

// The genetic algorithm takes the same model.
TEST(Distributed, GenesSearchAJointThatIsSpreadOverTheShank) {
  const Assembly assembly = in_collet(3);
  const modal::FrfSet measured = tip_with(assembly, with_values(*assembly.joint, {5e7, 20.0, 2e5, 2.0}),
                                          Eigen::VectorXd::LinSpaced(100, 10.0, 1000.0));
  const JointFitResult found =
      fit_joint(assembly, measured, {.method = JointMethod::ga, .mutation = Mutation::adaptive});
  EXPECT_EQ(found.iterations, 50);
  EXPECT_LT(found.objective_m_per_n, found.start);
  EXPECT_LT(found.relative_error, 0.2);
}

// The slopes along both stiffnesses against differences of the receptance.
TEST(Distributed, SlopesOfASpreadJointAreThoseOfItsReceptance) {
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(40, 10.0, 6000.0);
  for (const bool holder_moves : {false, true}) {
    Assembly assembly = in_collet(4);
    if (holder_moves) assembly.holder.segments = {bar(0.06)};
    const auto base = detail::base_receptances(assembly.holder, f).x;
    const JointModel model(std::make_shared<const detail::DistributedTip>(detail::tool_elements(assembly, f),
                                                                          *assembly.joint, assembly.holder, base, f),
                           f, 1e4);
    const JointValues at = {3e7, 30.0, 4e4, 3.0};
    JointModel::Response here;
    model.sensitivity(at, here);
    for (std::size_t j = 0; j < 2; ++j) {
      JointModel::Response up, down;
      JointValues more = at, less = at;
      const double step = 1e-4 * at[2 * j];
      more[2 * j] += step;
      less[2 * j] -= step;
      model.receptance(more, up);
      model.receptance(less, down);
      for (Index i = 0; i < f.size(); ++i) {
        const std::complex<double> slope(-here.along_real[j](i), -here.along_imag[j](i));
        const std::complex<double> difference((up.real(i) - down.real(i)) / (2.0 * step),
                                              (up.imag(i) - down.imag(i)) / (2.0 * step));
        EXPECT_LT(std::abs(slope - difference), 1e-5 * std::abs(slope) + 1e-12 * std::abs(here.real(i)) / step)
            << holder_moves << ", " << j << ", " << f(i);
      }
    }
  }
}

}  // namespace distributed_test
}  // namespace robomill::coupling
