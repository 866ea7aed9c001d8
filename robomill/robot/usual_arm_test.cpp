#include "robomill/robot/usual_arm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace robomill::robot {
namespace usual_arm_test {

/// Six joints of a size: 2.6 m of stretched reach at 1.
Arm arm_of_size(double size) {
  const double quarter = std::numbers::pi / 2;
  std::vector<DhRow> rows(6);
  rows[0] = {.a_m = 0.35 * size, .alpha_rad = -quarter, .d_m = 0.65 * size};
  rows[1] = {.a_m = 1.1 * size};
  rows[2] = {.a_m = 0.05 * size, .alpha_rad = -quarter};
  rows[3] = {.alpha_rad = quarter, .d_m = 1.1 * size};
  rows[4] = {.alpha_rad = -quarter};
  rows[5] = {.d_m = 0.2 * size};
  return arm_from_dh(rows);
}

void set_masses(Arm& arm, const std::vector<double>& masses_kg) {
  for (std::size_t k = 0; k < masses_kg.size(); ++k) {
    Link& link = arm.joints[k].link;
    link.mass_kg = masses_kg[k];
    link.inertia_kg_m2 = masses_kg[k] * 0.02 * Eigen::Matrix3d::Identity();
  }
}

std::string all(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& text : texts) out += text + "\n";
  return out;
}

TEST(UsualArm, ReachesAsFarAsItsOffsetsAndDistancesAdd) {
  EXPECT_NEAR(stretched_reach_m(arm_of_size(1.0)), 0.35 + 1.1 + 0.05 + 1.1, 1e-12);
  EXPECT_EQ(stretched_reach_m(Arm{}), 0.0);
}

TEST(UsualArm, HasNothingToSayOfMakersMasses) {
  Arm arm = arm_of_size(1.0);
  EXPECT_TRUE(unusual_masses(arm).empty());
  set_masses(arm, {310, 250, 150, 90, 40, 12});
  EXPECT_EQ(all(unusual_masses(arm)), "");
  Arm small = arm_of_size(0.33);
  set_masses(small, {3.7, 8.1, 2.3, 1.2, 1.1, 0.2});
  EXPECT_EQ(all(unusual_masses(small)), "");
}

// Mass with its base and reach of the arms of robot/README.md; three fifths to nine tenths of it move.
TEST(UsualArm, HasNothingToSayOfTheArmsThatItsRangesAreFrom) {
  struct Sheet {
    double mass_kg, reach_m, kg_per_m3;
  };
  for (const Sheet& sheet :
       {Sheet{33.5, 1.3, 15.2}, Sheet{1068, 2.696, 54.5}, Sheet{1049, 2.496, 67.5}, Sheet{1310, 2.8, 59.7},
        Sheet{2440, 2.55, 147}, Sheet{8600, 3.734, 165}, Sheet{4.5, 0.26, 256}}) {
    EXPECT_NEAR(sheet.mass_kg / std::pow(sheet.reach_m, 3) / sheet.kg_per_m3, 1.0, 5e-3) << sheet.mass_kg;
    Arm arm = arm_of_size(sheet.reach_m / 2.6);
    for (const double moving : {0.6, 0.9}) {
      std::vector<double> masses_kg;
      for (const double share : {0.36, 0.29, 0.18, 0.1, 0.05, 0.02})
        masses_kg.push_back(moving * sheet.mass_kg * share);
      set_masses(arm, masses_kg);
      for (Joint& joint : arm.joints) joint.link.inertia_kg_m2 *= sheet.reach_m * sheet.reach_m / 6.76;
      EXPECT_EQ(all(unusual_masses(arm)), "") << sheet.mass_kg << ", " << moving;
    }
  }
}

TEST(UsualArm, NamesMassesThatStandInForOthers) {
  Arm arm = arm_of_size(1.0);
  set_masses(arm, {1.5, 1.5, 1.5, 1.5, 1.5, 1.5});
  const std::string text = all(unusual_masses(arm));
  EXPECT_NE(text.find("all links of the arm weigh 1.5 kg"), std::string::npos) << text;
  EXPECT_NE(text.find("weigh 9 kg together"), std::string::npos) << text;
}

TEST(UsualArm, NamesMassesThatAreTooLargeForItsReach) {
  Arm arm = arm_of_size(1.0);
  set_masses(arm, {1300, 1100, 500, 200, 80, 20});
  const std::string text = all(unusual_masses(arm));
  EXPECT_NE(text.find("weigh 3200 kg together"), std::string::npos) << text;
  set_masses(arm, {3.1e5, 2.5e5, 1.5e5, 9e4, 4e4, 1.2e4});
  EXPECT_NE(all(unusual_masses(arm)).find("in g?"), std::string::npos) << all(unusual_masses(arm));
  set_masses(arm, {0.31, 0.25, 0.15, 0.09, 0.04, 0.012});
  EXPECT_NE(all(unusual_masses(arm)).find("in t?"), std::string::npos) << all(unusual_masses(arm));
}

TEST(UsualArm, NamesInertiasThatDoNotGoWithTheirMass) {
  Arm arm = arm_of_size(1.0);
  set_masses(arm, {310, 250, 150, 90, 40, 12});
  arm.joints[2].link.inertia_kg_m2 *= 1e6;
  const std::vector<std::string> found = unusual_masses(arm);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NE(found[0].find("link 3"), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("kg mm^2"), std::string::npos) << found[0];
}

std::vector<Load> loads(double n_per_um, double sign) {
  std::vector<Load> out(5);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const double angle = 0.7 * static_cast<double>(k);
    const Eigen::Vector3d direction(std::cos(angle), std::sin(angle), 0.2);
    out[k].position = Eigen::VectorXd::Zero(6);
    out[k].wrench.force_n = sign * 300.0 * direction;
    out[k].displacement_m = 300.0 / (n_per_um * 1e6) * (direction + 0.4 * direction.cross(Eigen::Vector3d::UnitZ()));
  }
  return out;
}

TEST(UsualArm, SpringsGiveWayAlongTheirLoads) {
  EXPECT_EQ(all(unusual_displacements({})), "");
  for (const double stiffness : {0.1, 0.6, 5.0}) EXPECT_EQ(all(unusual_displacements(loads(stiffness, 1.0))), "");
  const std::string turned = all(unusual_displacements(loads(0.6, -1.0)));
  EXPECT_NE(turned.find("5 of 5 loads the point moved against the force"), std::string::npos) << turned;
  const std::string in_um = all(unusual_displacements(loads(0.6e-3, 1.0)));
  EXPECT_NE(in_um.find("displacements in um"), std::string::npos) << in_um;
  const std::string in_m = all(unusual_displacements(loads(0.6e3, 1.0)));
  EXPECT_NE(in_m.find("displacements in m"), std::string::npos) << in_m;
}

}  // namespace usual_arm_test
}  // namespace robomill::robot
