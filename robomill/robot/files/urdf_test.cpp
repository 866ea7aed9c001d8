#include "robomill/robot/files/urdf.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "robomill/base/random.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::robot {
namespace urdf_test {

using robomill::test::rejection;
using robomill::test::seeds;
namespace arms = robot::testing;

/// Two joints with a fixed flange, a plate on the elbow and a moving gripper beside the chain.
const std::string good = R"(<?xml version="1.0"?>
<robot name="two">
  <link name="base"/>
  <link name="shoulder"><inertial><origin xyz="0 0 0.1" rpy="0 0 1.5707963267948966"/><mass value="10"/>
    <inertia ixx="1" iyy="2" izz="3" ixy="0" ixz="0" iyz="0.5"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="4"/>
    <inertia ixx="0.1" iyy="0.2" izz="0.2" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="plate"><inertial><origin xyz="0 0 0"/><mass value="4"/>
    <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="flange"/>
  <link name="finger"><inertial><mass value="7"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j1" type="revolute"><parent link="base"/><child link="shoulder"/><origin xyz="0 0 0.4"/>
    <axis xyz="0 0 -2"/><limit lower="-3.1" upper="3.2" effort="100" velocity="2.5"/><dynamics damping="12"/></joint>
  <joint name="j2" type="prismatic"><parent link="shoulder"/><child link="arm"/><origin xyz="0.3 0 0" rpy="0 1.5707963267948966 0"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.5" effort="100" velocity="0.2"/></joint>
  <joint name="bolt" type="fixed"><parent link="arm"/><child link="plate"/><origin xyz="0.7 0 0"/></joint>
  <joint name="tip" type="fixed"><parent link="arm"/><child link="flange"/><origin xyz="1 0 0" rpy="0 0 0.5"/></joint>
  <joint name="grip" type="continuous"><parent link="flange"/><child link="finger"/><axis xyz="0 0 1"/></joint>
</robot>
)";

std::string with(const std::string& old_text, const std::string& new_text) {
  return test_support::replaced(good, old_text, new_text);
}

UrdfArm parse_good() {
  return parse_urdf(good, "two.urdf", {.tip = "flange"});
}

TEST(Urdf, ReadsJointsLimitsAndLinks) {
  const UrdfArm read = parse_good();
  ASSERT_EQ(read.arm.joints.size(), 2U);
  const Joint& first = read.arm.joints[0];
  EXPECT_EQ(first.name, "j1");
  EXPECT_FALSE(first.prismatic);
  EXPECT_EQ(first.axis, Eigen::Vector3d(0.0, 0.0, -1.0));
  EXPECT_EQ(first.before.translation(), Eigen::Vector3d(0.0, 0.0, 0.4));
  EXPECT_EQ(first.min_position, -3.1);
  EXPECT_EQ(first.max_position, 3.2);
  EXPECT_EQ(first.max_velocity, 2.5);
  EXPECT_EQ(first.damping, 12.0);
  EXPECT_EQ(first.link.mass_kg, 10.0);
  EXPECT_EQ(first.link.center_m, Eigen::Vector3d(0.0, 0.0, 0.1));
  // Turned by 90 degrees about z: xx and yy change places, yz becomes -xz.
  Eigen::Matrix3d expected;
  expected << 2.0, 0.0, -0.5, 0.0, 1.0, 0.0, -0.5, 0.0, 3.0;
  EXPECT_LT((first.link.inertia_kg_m2 - expected).norm(), 1e-15);
  EXPECT_TRUE(read.arm.joints[1].prismatic);
  EXPECT_EQ(read.arm.joints[1].max_position, 0.5);
  EXPECT_EQ(read.arm.flange.translation(), Eigen::Vector3d(1.0, 0.0, 0.0));
}

TEST(Urdf, AddsWhatIsBoltedToALinkAndLeavesOutWhatMoves) {
  const UrdfArm read = parse_good();
  const Link& link = read.arm.joints[1].link;
  // 4 kg at 0.5 m and 4 kg at 0.7 m; each 0.1 m from the centre.
  EXPECT_DOUBLE_EQ(link.mass_kg, 8.0);
  EXPECT_LT((link.center_m - Eigen::Vector3d(0.6, 0.0, 0.0)).norm(), 1e-15);
  EXPECT_LT((link.inertia_kg_m2.diagonal() - Eigen::Vector3d(0.1, 0.28, 0.28)).norm(), 1e-14);
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_NE(read.notes[0].find("Joint grip"), std::string::npos);
  // On the way to the finger it is a joint, without limits.
  const UrdfArm finger = parse_urdf(good, "two.urdf", {.tip = "finger", .base = "shoulder"});
  ASSERT_EQ(finger.arm.joints.size(), 2U);
  EXPECT_EQ(finger.arm.joints[1].name, "grip");
  EXPECT_LT(finger.arm.joints[1].min_position, -1e299);
  EXPECT_LT((finger.arm.joints[1].before.translation() - Eigen::Vector3d(1.0, 0.0, 0.0)).norm(), 1e-15);
}

std::string origin_text(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  const Eigen::Vector3d p = pose.translation();
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  return fmt::format("<origin xyz=\"{} {} {}\" rpy=\"{} {} {}\"/>", p.x(), p.y(), p.z(), std::atan2(r(2, 1), r(2, 2)),
                     pitch, std::atan2(r(1, 0), r(0, 0)));
}

/// An arm as a URDF, each joint behind a fixed one.
std::string urdf_of(const Arm& arm, Random& random) {
  std::string text = "<robot name=\"r\"><link name=\"link_0\"/>";
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const Joint& joint = arm.joints[i];
    const Eigen::Isometry3d part = arms::random_pose(random, 0.3);
    text += fmt::format(
        "<link name=\"mid_{}\"/><joint name=\"fix_{}\" type=\"fixed\"><parent link=\"link_{}\"/>"
        "<child link=\"mid_{}\"/>{}</joint>",
        i, i, i, i, origin_text(part));
    text += fmt::format(
        "<link name=\"link_{}\"/><joint name=\"joint_{}\" type=\"{}\"><parent link=\"mid_{}\"/>"
        "<child link=\"link_{}\"/>{}<axis xyz=\"{} {} {}\"/>"
        "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>",
        i + 1, i, joint.prismatic ? "prismatic" : "revolute", i, i + 1, origin_text(part.inverse() * joint.before),
        joint.axis.x(), joint.axis.y(), joint.axis.z());
  }
  text += fmt::format(
      "<link name=\"tip\"/><joint name=\"end\" type=\"fixed\"><parent link=\"link_{}\"/><child "
      "link=\"tip\"/>{}</joint></robot>",
      arm.joints.size(), origin_text(arm.flange));
  return text;
}

TEST(Urdf, GivesBackAnyArmThatWasWritten) {
  Random random(51);
  for (int k = 0; k < seeds(300); ++k) {
    const Arm arm = arms::random_chain(random, 1 + k % 8);
    const Arm back = parse_urdf(urdf_of(arm, random), "r.urdf", {.tip = "tip"}).arm;
    ASSERT_EQ(back.joints.size(), arm.joints.size());
    const Eigen::VectorXd position = arms::random_position(random, arm.size());
    EXPECT_LT((forward(arm, position).matrix() - forward(back, position).matrix()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Urdf, SaysWhatIsWrong) {
  const auto said = [](const std::string& text, const UrdfReading& reading) {
    return rejection([&] { (void)parse_urdf(text, "two.urdf", reading); });
  };
  const UrdfReading reading{.tip = "flange"};
  EXPECT_NE(said(good, {}).find("needs the link of the flange"), std::string::npos);
  EXPECT_NE(said(good, {.tip = "flnge"}).find("has no link \"flnge\". Did you mean flange?"), std::string::npos);
  EXPECT_NE(said(good, {.tip = "flange", .base = "bas"}).find("has no link \"bas\""), std::string::npos);
  EXPECT_NE(said(good, {.tip = "plate", .base = "flange"}).find("does not lead from flange to plate"),
            std::string::npos);
  EXPECT_NE(said(good, {.tip = "base"}).find("no moving joint between base and base"), std::string::npos);
  EXPECT_NE(said("no XML at all", reading).find("no URDF that can be read"), std::string::npos);
  EXPECT_NE(said("", reading).find("no URDF that can be read"), std::string::npos);
  EXPECT_NE(said(with("type=\"prismatic\"", "type=\"planar\""), reading).find("joint \"j2\" must be revolute"),
            std::string::npos);
  EXPECT_NE(said(with("<dynamics damping=\"12\"/>", "<mimic joint=\"j2\"/>"), reading).find("joint \"j1\" mimics j2"),
            std::string::npos);
  const std::string no_limit =
      said(with("<limit lower=\"-3.1\" upper=\"3.2\" effort=\"100\" velocity=\"2.5\"/>", ""), reading);
  EXPECT_NE(no_limit.find("j1"), std::string::npos) << no_limit;
  EXPECT_NE(no_limit.find("limit"), std::string::npos) << no_limit;
  const std::string exchanged = said(with("lower=\"-3.1\" upper=\"3.2\"", "lower=\"3.1\" upper=\"-3.2\""), reading);
  EXPECT_NE(exchanged.find("two.urdf: joint \"j1\" min_position = 3.1 rad; must be below max_position"),
            std::string::npos)
      << exchanged;
  EXPECT_NE(said(with("0 0 -2", "0 0 0"), reading).find("joint \"j1\" must have an axis"), std::string::npos);
  const std::string negative = said(with("<mass value=\"10\"/>", "<mass value=\"-10\"/>"), reading);
  EXPECT_NE(negative.find("joint \"j1\" link.mass_kg = -10 kg"), std::string::npos) << negative;
  std::string deep = "<robot>";
  for (int i = 0; i < 1000000; ++i) deep += "<a>";
  EXPECT_NE(said(deep, reading).find("too deeply"), std::string::npos);
  const test::Folder folder;
  EXPECT_NE(rejection([&] { (void)read_urdf(folder.at("none.urdf"), reading); }).find("none.urdf"), std::string::npos);
  EXPECT_EQ(read_urdf(folder.file("two.urdf", good), reading).arm.joints.size(), 2U);
}

std::string fixed(const std::string& name, const std::string& parent, const std::string& child) {
  return fmt::format(R"(<joint name="{}" type="fixed"><parent link="{}"/><child link="{}"/></joint>)", name, parent,
                     child);
}

TEST(Urdf, OtherDescriptionsAreNamed) {
  const auto say = [](const std::string& text) { return rejection([&] { (void)parse_urdf(text, "arm.xacro", {}); }); };
  const std::string head = "<?xml version=\"1.0\"?>\n<robot name=\"r\" xmlns:xacro=\"http://wiki.ros.org/xacro\">\n";
  for (const char* body :
       {"<xacro:include filename=\"macro.xacro\"/>\n</robot>\n", "<link name=\"${prefix}base\"/>\n</robot>\n"}) {
    const std::string said = say(head + body);
    EXPECT_NE(said.find("arm.xacro:3: is xacro"), std::string::npos) << said;
    EXPECT_NE(said.find("xacro FILE.xacro > FILE.urdf"), std::string::npos) << said;
  }
  EXPECT_NE(say("<sdf version=\"1.7\"><model name=\"a\"/></sdf>").find("is SDF"), std::string::npos);
  EXPECT_NE(say("<mujoco model=\"a\"/>").find("is MJCF"), std::string::npos);
  std::string written = good;
  written.replace(written.find("<robot name"), 6, "<robot xmlns:xacro=\"http://wiki.ros.org/xacro\"");
  EXPECT_NO_THROW((void)parse_urdf(written, "arm.urdf", {.tip = "flange"}));
}

// What tinyxml would read behind its end, AddressSanitizer sees.
TEST(Urdf, ATextThatEndsWithinALetterIsRejected) {
  for (const char* begun : {"\xc3", "\xe2\x82", "\xf0\x9f\x98"}) {
    for (const char* cut : {"<child link=\"", "<link na", "<joint name=\"j1\" ty"}) {
      const std::string text = good.substr(0, good.find(cut) + std::string(cut).size()) + begun;
      EXPECT_NE(rejection([&] { (void)parse_urdf(text, "two.urdf", {.tip = "flange"}); }).find("is no URDF"),
                std::string::npos)
          << text;
    }
  }
}

TEST(Urdf, LinksThatAreNoTreeAreRejected) {
  const auto said = [](const std::string& text) {
    return rejection([&] { (void)parse_urdf(text, "two.urdf", {.tip = "flange"}); });
  };
  // A ring beside a sound root, which the way up from the flange would never leave.
  const std::string ring = said(with("link=\"base\"/><child", "link=\"flange\"/><child"));
  EXPECT_NE(ring.find("two.urdf: has links that form a ring, through joint"), std::string::npos) << ring;
  // One that the links bolted to the arm would be collected along.
  const std::string bolted = said(with(
      "</robot>", "<link name=\"p\"/><link name=\"q\"/>" + fixed("pq", "p", "q") + fixed("qp", "q", "p") + "</robot>"));
  EXPECT_NE(bolted.find("form a ring"), std::string::npos) << bolted;
  const std::string self = said(with("</robot>", "<link name=\"p\"/>" + fixed("pp", "p", "p") + "</robot>"));
  EXPECT_NE(self.find("form a ring, through joint \"pp\" of link \"p\""), std::string::npos) << self;
  const std::string twice = said(with("</robot>", fixed("second", "plate", "flange") + "</robot>"));
  EXPECT_NE(twice.find("lets two joints carry link \"flange\": \"tip\" and \"second\""), std::string::npos) << twice;
}

/// Links in a row that fixed joints carry; taking the model apart in the order of their names goes down all of it.
std::string chain(int joints) {
  const auto link = [joints](int i) { return fmt::format("{:05}", joints - i); };
  std::string text = "<robot name=\"long\"><link name=\"" + link(0) + "\"/>";
  for (int i = 0; i < joints; ++i) {
    text += "<link name=\"" + link(i + 1) + "\"/>" + fixed(fmt::format("j{}", i), link(i), link(i + 1));
  }
  return text + "</robot>";
}

TEST(Urdf, LongChainsAreReadOrRejected) {
  const UrdfReading tip{.tip = "00000"};
  EXPECT_NE(rejection([&] { (void)parse_urdf(chain(2000), "long.urdf", tip); }).find("no moving joint"),
            std::string::npos);
  for (const int joints : {2001, 50000}) {
    EXPECT_NE(rejection([&] { (void)parse_urdf(chain(joints), "long.urdf", tip); }).find("has more than 2000 joints"),
              std::string::npos);
  }
}

TEST(Urdf, NestingCannotHideBehindCommentsAndQuotes) {
  std::string commented = "<robot>", quoted = commented;
  for (int i = 0; i < 300000; ++i) {
    commented += "<a><!--</></>-->";
    quoted += "<a b=\"/></>\">";
  }
  for (const std::string& text : {commented, quoted}) {
    EXPECT_NE(rejection([&] { (void)parse_urdf(text, "deep.urdf", {.tip = "a"}); }).find("too deeply"),
              std::string::npos);
  }
  const UrdfArm read = parse_urdf(with("</robot>", "<!-- <a><a> --></robot>"), "two.urdf", {.tip = "flange"});
  EXPECT_EQ(read.arm.joints.size(), 2U);
}

TEST(Urdf, DamagedFilesAreReadOrRejected) {
  Random random(52);
  int read = 0, rejected = 0;
  for (int k = 0; k < seeds(20000); ++k) {
    std::string text = good;
    for (std::uint64_t changes = 1 + random.index(4); changes > 0; --changes) {
      const std::size_t at = random.index(text.size());
      switch (random.index(3)) {
        case 0:
          text[at] = static_cast<char>(random.index(256));
          break;
        case 1:
          text.erase(at, 1 + random.index(20));
          break;
        default:
          text.insert(at, text.substr(random.index(text.size()), random.index(30)));
      }
    }
    try {
      const UrdfArm arm = parse_urdf(text, "damaged.urdf", {.tip = "flange"});
      EXPECT_TRUE(forward(arm.arm, Eigen::VectorXd::Zero(arm.arm.size())).matrix().allFinite());
      ++read;
    } catch (const InvalidInput&) {
      ++rejected;
    }
  }
  EXPECT_GT(read, 20);
  EXPECT_GT(rejected, 100);
}

}  // namespace urdf_test
}  // namespace robomill::robot
