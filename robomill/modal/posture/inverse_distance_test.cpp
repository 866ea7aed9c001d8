#include "robomill/modal/posture/inverse_distance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "robomill/base/random.hpp"
#include "testing/modal/simulated_arm.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace inverse_distance_test {

using robomill::test::field_of;

const std::vector<Dof> tip = {
    {.point = 0, .axis = Axis::x}, {.point = 0, .axis = Axis::y}, {.point = 0, .axis = Axis::z}};

Mode mode_along(double frequency_hz, const Eigen::Vector3d& direction, double damping_ratio = 0.02) {
  Mode out = mode_from_mass({.frequency_hz = frequency_hz, .damping_ratio = damping_ratio, .modal_mass_kg = 2.0}, 0, 3);
  const std::complex<double> left = out.left(0), right = out.right(0);
  out.left = left * direction;
  out.right = right * direction;
  normalise(out);
  return out;
}

ModalModel model_of(std::vector<Mode> modes) {
  return {.excitations = tip, .responses = tip, .modes = std::move(modes)};
}

Eigen::Matrix3cd residue(const Mode& mode) {
  return mode.right * mode.left.transpose();
}

Eigen::VectorXd joints_near(double share) {
  Eigen::VectorXd out = robot::testing::kr210_posture();
  out(3) += share;
  out(4) -= 0.5 * share;
  return out;
}

TEST(InverseDistance, GivesTheModesOfAMeasuredPostureThere) {
  const testing::SimulatedArm arm(2);
  std::vector<PostureModes> measured;
  for (const Eigen::VectorXd& joints : arm.measured_postures()) {
    measured.push_back({.joints = joints, .modes = arm.modes(joints)});
  }
  const Eigen::VectorXd frequency_hz = Eigen::VectorXd::LinSpaced(200, 4.0, 700.0);
  for (const ResidueAxes axes : {ResidueAxes::base, ResidueAxes::flange}) {
    const ModalModel found = inverse_distance(measured, arm.told().arm, measured[4].joints, axes);
    ASSERT_EQ(found.modes.size(), measured[4].modes.modes.size());
    const FrfSet expected = synthesize(measured[4].modes, frequency_hz), got = synthesize(found, frequency_hz);
    for (std::size_t k = 0; k < 9; ++k) {
      EXPECT_LT((got.frfs[k].receptance - expected.frfs[k].receptance).norm(),
                1e-9 * expected.frfs[k].receptance.norm());
    }
    EXPECT_NEAR(found.modes[0].frequency_std_hz, 0.0, 1e-9);
  }
}

// A mode that stands still in an axes' system is found exactly in that one, and not in the other.
TEST(InverseDistance, KeepsModesThatTurnWithTheToolInFlangeAxesAndThoseOfSpaceInBaseAxes) {
  const robot::Arm arm = robot::testing::kr210();
  const Eigen::Vector3d direction = Eigen::Vector3d(0.6, -0.3, 0.9).normalized();
  for (const ResidueAxes truth : {ResidueAxes::base, ResidueAxes::flange}) {
    const auto at = [&](const Eigen::VectorXd& joints) {
      const Eigen::Matrix3d turn = truth == ResidueAxes::flange ? Eigen::Matrix3d(robot::forward(arm, joints).linear())
                                                                : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
      return model_of({mode_along(520.0, turn * direction)});
    };
    std::vector<PostureModes> measured;
    for (const double share : {-0.6, -0.2, 0.3, 0.7}) {
      measured.push_back({.joints = joints_near(share), .modes = at(joints_near(share))});
    }
    const Eigen::VectorXd asked = joints_near(0.05);
    const Eigen::Matrix3cd expected = residue(at(asked).modes[0]);
    for (const ResidueAxes axes : {ResidueAxes::base, ResidueAxes::flange}) {
      const ModalModel found = inverse_distance(measured, arm, asked, axes);
      ASSERT_EQ(found.modes.size(), 1U);
      const double error = (residue(found.modes[0]) - expected).norm() / expected.norm();
      if (axes == truth) {
        EXPECT_LT(error, 1e-12);
      } else {
        EXPECT_GT(error, 0.01);
      }
    }
  }
}

TEST(InverseDistance, WeighsByTheSquareOfTheDistance) {
  const robot::Arm arm = robot::testing::kr210();
  const std::vector<PostureModes> measured = {
      {.joints = joints_near(0.0), .modes = model_of({mode_along(100.0, Eigen::Vector3d::UnitX(), 0.01)})},
      {.joints = joints_near(0.3), .modes = model_of({mode_along(110.0, Eigen::Vector3d::UnitX(), 0.02)})}};
  const ModalModel found = inverse_distance(measured, arm, joints_near(0.1), ResidueAxes::base);
  ASSERT_EQ(found.modes.size(), 1U);
  // A third and two thirds of the way: weights 4/5 and 1/5.
  EXPECT_NEAR(found.modes[0].frequency_hz, std::pow(100.0, 0.8) * std::pow(110.0, 0.2), 1e-9);
  EXPECT_NEAR(found.modes[0].damping_ratio, 0.01 * std::pow(2.0, 0.2), 1e-12);
  EXPECT_NEAR(found.modes[0].frequency_std_hz / found.modes[0].frequency_hz, 0.4 * std::log(1.1), 1e-9);
}

// Modes change places in frequency: their directions tell which is which.
TEST(InverseDistance, FollowsModesThatCross) {
  const robot::Arm arm = robot::testing::kr210();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  const std::vector<PostureModes> measured = {
      {.joints = joints_near(0.0), .modes = model_of({mode_along(99.0, x), mode_along(101.0, y)})},
      {.joints = joints_near(0.2), .modes = model_of({mode_along(98.0, y), mode_along(103.0, x)})}};
  const ModalModel found = inverse_distance(measured, arm, joints_near(0.1), ResidueAxes::base);
  ASSERT_EQ(found.modes.size(), 2U);
  EXPECT_NEAR(found.modes[0].frequency_hz, std::sqrt(101.0 * 98.0), 1e-9);
  EXPECT_NEAR(found.modes[1].frequency_hz, std::sqrt(99.0 * 103.0), 1e-9);
  EXPECT_GT(std::abs(found.modes[0].right(1)), 1e3 * std::abs(found.modes[0].right(0)));
}

TEST(InverseDistance, LeavesOutWhatFewPosturesKnow) {
  const robot::Arm arm = robot::testing::kr210();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  std::vector<PostureModes> measured;
  for (const double share : {-0.2, 0.0, 0.2}) {
    measured.push_back({.joints = joints_near(share), .modes = model_of({mode_along(100.0, x), mode_along(300.0, x)})});
  }
  measured[2].modes.modes.pop_back();                       // two of three know it
  measured[0].modes.modes.push_back(mode_along(500.0, x));  // one of three
  const ModalModel found = inverse_distance(measured, arm, joints_near(0.01), ResidueAxes::base);
  ASSERT_EQ(found.modes.size(), 2U);
  EXPECT_NEAR(found.modes[1].frequency_hz, 300.0, 1e-9);
}

TEST(InverseDistance, TakesAnExcitationThatWasNotMeasuredByReciprocity) {
  const testing::SimulatedArm arm(4);
  std::vector<PostureModes> full, part;
  for (const Eigen::VectorXd& joints : arm.measured_postures()) {
    full.push_back({.joints = joints, .modes = arm.modes(joints)});
    ModalModel model = full.back().modes;
    model.residuals.clear();
    full.back().modes = model;
    model.excitations.pop_back();
    for (Mode& mode : model.modes) mode.left.conservativeResize(2);
    part.push_back({.joints = joints, .modes = model});
  }
  const Eigen::VectorXd& joints = arm.held_out_postures()[0];
  for (const ResidueAxes axes : {ResidueAxes::base, ResidueAxes::flange}) {
    const ModalModel of_full = inverse_distance(full, arm.told().arm, joints, axes);
    const ModalModel of_part = inverse_distance(part, arm.told().arm, joints, axes);
    ASSERT_EQ(of_full.modes.size(), of_part.modes.size());
    for (std::size_t k = 0; k < of_full.modes.size(); ++k) {
      const Eigen::Matrix3cd expected = residue(of_full.modes[k]);
      EXPECT_LT((residue(of_part.modes[k]) - expected).norm(), 1e-6 * expected.norm());
    }
  }
}

TEST(InverseDistance, RejectsWhatItCannotUse) {
  const robot::Arm arm = robot::testing::kr210();
  const PostureModes good{.joints = joints_near(0.0), .modes = model_of({mode_along(100.0, Eigen::Vector3d::UnitX())})};
  const auto field = [&](const std::vector<PostureModes>& measured, const Eigen::VectorXd& joints) {
    return field_of([&] { static_cast<void>(inverse_distance(measured, arm, joints, ResidueAxes::base)); });
  };
  EXPECT_EQ(field({}, good.joints), "measured");
  EXPECT_EQ(field({good}, Eigen::VectorXd::Zero(5)), "joints");
  PostureModes bad = good;
  bad.joints(2) = std::nan("");
  EXPECT_EQ(field({good, bad}, good.joints), "measured[2].joints");
  bad = good;
  bad.modes.modes[0].damping_ratio = 0.0;
  EXPECT_EQ(field({bad}, good.joints), "measured[1].modes[1].damping_ratio");
  bad = good;
  bad.modes.responses[0].point = 3;
  EXPECT_EQ(field({bad}, good.joints), "measured[1].modes");
}

}  // namespace inverse_distance_test
}  // namespace robomill::modal
