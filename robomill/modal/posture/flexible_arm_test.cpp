#include "robomill/modal/posture/flexible_arm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robomill/base/lanes.hpp"
#include "robomill/base/random.hpp"
#include "robomill/modal/posture/posture_normal.hpp"
#include "robomill/modal/posture/receptance_lines.hpp"
#include "robomill/modal/posture/smoothed_frf.hpp"
#include "robomill/robot/dynamics.hpp"
#include "testing/modal/simulated_arm.hpp"

namespace robomill::modal::detail {
namespace flexible_arm_test {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

const testing::SimulatedArm& simulated() {
  static const testing::SimulatedArm arm(0);
  return arm;
}

FlexibleArm whole_arm() {
  FlexibleArm arm(simulated().told(), {}, {.bearings = true, .bracket = true, .tool_modes = 1, .load = true},
                  {{.frequency_hz = 420.0, .mass_kg = 1.5}});
  arm.scale_loads(simulated().measured_postures());
  return arm;
}

Eigen::VectorXd moved_from_start(const FlexibleArm& arm) {
  Eigen::VectorXd out = arm.start();
  for (Eigen::Index p = 0; p < out.size(); ++p) out(p) += 0.02 * std::sin(1.0 + 3.0 * static_cast<double>(p));
  return out;
}

TEST(FlexibleArm, HasTheMassMatrixOfItsJointsWhereNothingElseGives) {
  const robot::Cell& cell = simulated().told();
  const FlexibleArm arm(cell, {}, {}, {});
  for (const Eigen::VectorXd& joints : simulated().measured_postures()) {
    const Eigen::MatrixXd expected = robot::mass_matrix(cell.arm, joints);
    EXPECT_LT((arm.at(joints, arm.start()).mass - expected).norm(), 1e-10 * expected.norm());
  }
}

/// H(s) by LU with pivots, or 2 H(s) - H(s + Re s).
Eigen::Matrix3cd smoothed(const FlexibleArm::System& system, Complex s) {
  const Eigen::Matrix3cd value = FlexibleArm::receptance(system, s);
  return s.real() > 0.0 ? 2.0 * value - FlexibleArm::receptance(system, s + s.real()) : value;
}

Eigen::Matrix3cd matrix_of(const SymmetricLanes& lanes, std::size_t lane) {
  Eigen::Matrix3cd out;
  const auto entry = [&](std::size_t e) { return lanes.at(e, lane); };
  out << entry(0), entry(1), entry(2), entry(1), entry(3), entry(4), entry(2), entry(4), entry(5);
  return out;
}

// Two methods: LU with pivots, and without in lanes.
TEST(ReceptanceLines, AreTheReceptanceAtEachOfTheirPoints) {
  const FlexibleArm arm = whole_arm();
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Eigen::VectorXd& joints = simulated().measured_postures()[random.index(10)];
    const FlexibleArm::System system = arm.at(joints, moved_from_start(arm));
    FlexibleArm::ReceptanceLines lines(arm, system, false);
    std::vector<Complex> s(1 + random.index(lane_count));
    for (Complex& one : s) {
      const double rate = 2.0 * pi * random.uniform(1.0, 700.0);
      one = {random.uniform() < 0.3 ? 0.0 : random.uniform(0.01, 0.2) * rate, rate};
    }
    lines.evaluate(s);
    EXPECT_TRUE(lines.derivative().empty());
    for (std::size_t lane = 0; lane < s.size(); ++lane) {
      const Eigen::Matrix3cd expected = smoothed(system, s[lane]);
      EXPECT_LT((matrix_of(lines.value(), lane) - expected).norm(), 1e-11 * expected.norm()) << s[lane];
    }
  }
}

TEST(ReceptanceLines, DifferentiateByEveryParameter) {
  const FlexibleArm arm = whole_arm();
  const Eigen::VectorXd parameters = moved_from_start(arm);
  const Eigen::VectorXd& joints = simulated().measured_postures()[3];
  const std::vector<Complex> s = {{20.0, 2.0 * pi * 60.0}, {0.0, 2.0 * pi * 35.0}, {300.0, 2.0 * pi * 500.0}};
  const FlexibleArm::System system = arm.at(joints, parameters);
  FlexibleArm::ReceptanceLines lines(arm, system, true);
  lines.evaluate(s);
  ASSERT_EQ(lines.derivative().size(), static_cast<std::size_t>(parameters.size()));
  constexpr double step = 1e-5;
  for (Eigen::Index p = 0; p < parameters.size(); ++p) {
    Eigen::VectorXd up = parameters, down = parameters;
    up(p) += step;
    down(p) -= step;
    for (std::size_t lane = 0; lane < s.size(); ++lane) {
      const Eigen::Matrix3cd difference =
          (smoothed(arm.at(joints, up), s[lane]) - smoothed(arm.at(joints, down), s[lane])) / (2.0 * step);
      const Eigen::Matrix3cd analytic = matrix_of(lines.derivative()[static_cast<std::size_t>(p)], lane);
      const double size = matrix_of(lines.value(), lane).norm();
      EXPECT_LT((difference - analytic).norm(), 1e-5 * analytic.norm() + 1e-8 * size) << "parameter " << p;
    }
  }
}

TEST(ReceptanceLines, HaveTheSameBitsWhateverVectorsTheMachineHas) {
  const FlexibleArm arm = whole_arm();
  const FlexibleArm::System system = arm.at(simulated().measured_postures()[4], moved_from_start(arm));
  const std::vector<Complex> s = {{20.0, 400.0}, {0.0, 200.0}, {300.0, 3000.0}, {5.0, 50.0}, {8.0, 90.0}};
  const auto run = [&](Kernels which) {
    kernels() = which;
    FlexibleArm::ReceptanceLines lines(arm, system, true);
    lines.evaluate(s);
    kernels() = best_kernels();
    std::vector<Complex> out;
    for (std::size_t lane = 0; lane < s.size(); ++lane) {
      for (std::size_t e = 0; e < 6; ++e) {
        out.push_back(lines.value().at(e, lane));
        for (const SymmetricLanes& by : lines.derivative()) out.push_back(by.at(e, lane));
      }
    }
    return out;
  };
  const std::vector<Complex> baseline = run(Kernels::baseline);
  for (const Kernels other : {Kernels::avx2, Kernels::avx512}) {
    if (other > best_kernels()) continue;
    EXPECT_EQ(run(other), baseline);
  }
}

TEST(FlexibleArm, SumsItsModesToItsReceptance) {
  const FlexibleArm arm = whole_arm();
  const FlexibleArm::System system = arm.at(simulated().measured_postures()[5], moved_from_start(arm));
  constexpr double far_hz = 1e5;
  const FlexibleArm::Modes modes = arm.modes(system, far_hz);
  for (const double f : {8.0, 31.0, 150.0, 420.0}) {
    const Complex s(0.0, 2.0 * pi * f);
    Eigen::Matrix3cd sum = modes.rest.cast<Complex>();
    for (Eigen::Index k = 0; k < modes.pole.size(); ++k) {
      const Eigen::Matrix3cd residue = modes.at_tip.col(k) * modes.at_tip.col(k).transpose();
      sum += residue / (s - modes.pole(k)) + residue.conjugate() / (s - std::conj(modes.pole(k)));
    }
    const Eigen::Matrix3cd exact = FlexibleArm::receptance(system, s);
    EXPECT_LT((sum - exact).norm(), 1e-6 * exact.norm()) << f << " Hz";
  }
}

TEST(FlexibleArm, KnowsHowItsModesMoveWithItsParameters) {
  const FlexibleArm arm = whole_arm();
  const Eigen::VectorXd parameters = moved_from_start(arm);
  const Eigen::VectorXd& joints = simulated().measured_postures()[1];
  constexpr double far_hz = 1e5;
  const FlexibleArm::System system = arm.at(joints, parameters);
  const FlexibleArm::Modes modes = arm.modes(system, far_hz);
  const FlexibleArm::Sensitivity by = arm.sensitivity(system, modes);
  constexpr double step = 1e-5;
  for (Eigen::Index p = 0; p < parameters.size(); p += 7) {
    Eigen::VectorXd up = parameters, down = parameters;
    up(p) += step;
    down(p) -= step;
    const FlexibleArm::Modes above = arm.modes(arm.at(joints, up), far_hz);
    const FlexibleArm::Modes below = arm.modes(arm.at(joints, down), far_hz);
    for (const Eigen::Index k : {0, 3, 8}) {
      const double slope = (std::log(std::abs(above.pole(k))) - std::log(std::abs(below.pole(k)))) / (2.0 * step);
      EXPECT_NEAR(by.log_frequency(k, p), slope, 1e-5) << "parameter " << p << ", mode " << k;
      const Eigen::Matrix3cd a = above.at_tip.col(k) * above.at_tip.col(k).transpose();
      const Eigen::Matrix3cd b = below.at_tip.col(k) * below.at_tip.col(k).transpose();
      const Eigen::Matrix3cd change = (a - b) / (2.0 * step) / modes.at_tip.col(k).squaredNorm();
      const Eigen::Matrix3cd analytic =
          Eigen::Map<const Eigen::Matrix3cd>(by.residue[static_cast<std::size_t>(k)].col(p).data());
      EXPECT_LT((change - analytic).norm(), 2e-3 * std::max(1.0, change.norm())) << "parameter " << p << ", mode " << k;
    }
  }
}

// Gradient and cost of residuals whose logarithm is taken, by differences; a line that is zero leaves both finite.
TEST(PostureNormal, HasTheGradientOfItsCost) {
  const FlexibleArm arm = whole_arm();
  const Eigen::VectorXd parameters = moved_from_start(arm);
  const Eigen::VectorXd& joints = simulated().measured_postures()[2];
  MeasuredPosture measured{.name = "one", .joints = joints, .frfs = simulated().measure(joints, 5)};
  measured.frfs.frfs[0].receptance(40) = 0.0;
  const SmoothedFrf frf = PostureData(measured, {}).smoothed(0.02, 40, true);
  const PostureNormal here = normal_of(arm, joints, frf, parameters, true);
  ASSERT_TRUE(std::isfinite(here.cost));
  constexpr double step = 1e-6;
  for (Eigen::Index p = 0; p < parameters.size(); p += 5) {
    Eigen::VectorXd up = parameters, down = parameters;
    up(p) += step;
    down(p) -= step;
    const double slope =
        (normal_of(arm, joints, frf, up, false).cost - normal_of(arm, joints, frf, down, false).cost) / (2.0 * step);
    EXPECT_NEAR(2.0 * here.gradient(p), slope, 1e-5 * std::abs(slope) + 1e-6 * here.cost) << "parameter " << p;
  }
}

// H is analytic right of the imaginary axis: its lines there give it by Poisson's integral.
TEST(SmoothedFrf, IsTwiceTheReceptanceRightOfTheAxisLessThatTwiceAsFar) {
  const ModalModel model = modes_from_mass({{.frequency_hz = 40.0, .damping_ratio = 0.05, .modal_mass_kg = 60.0},
                                            {.frequency_hz = 180.0, .damping_ratio = 0.04, .modal_mass_kg = 8.0}},
                                           {{.frequency_hz = 75.0, .damping_ratio = 0.04, .modal_mass_kg = 20.0}});
  MeasuredPosture measured{.name = "one", .joints = Eigen::VectorXd::Zero(6)};
  measured.frfs = synthesize(model, Eigen::VectorXd::LinSpaced(3986, 3.0, 2000.0));
  const PostureModelOptions options{.band_high_hz = 2000.0};
  const SmoothedFrf frf = PostureData(measured, options).smoothed(0.1, 40);
  measured.modes = model;
  const PostureData by_modes(measured, options);
  const auto receptance = [&](Complex s, std::size_t axis) {
    Complex sum = 0.0;
    for (const Mode& mode : model.modes) {
      const Complex residue = mode.right(static_cast<Eigen::Index>(axis)) * mode.left(static_cast<Eigen::Index>(axis));
      sum += residue / (s - pole(mode)) + std::conj(residue) / (s - std::conj(pole(mode)));
    }
    return sum;
  };
  for (std::size_t i = 0; i < frf.s.size(); ++i) {
    if (frf.s[i].imag() > 2.0 * pi * 250.0) continue;
    for (const std::size_t axis : {0U, 1U}) {
      const Complex exact = 2.0 * receptance(frf.s[i], axis) - receptance(frf.s[i] + frf.s[i].real(), axis);
      EXPECT_LT(std::abs(frf.value(static_cast<Eigen::Index>(4 * axis), static_cast<Eigen::Index>(i)) - exact),
                0.01 * std::abs(exact))
          << frf.s[i].imag() / (2.0 * pi) << " Hz";
    }
  }
}

}  // namespace flexible_arm_test
}  // namespace robomill::modal::detail
