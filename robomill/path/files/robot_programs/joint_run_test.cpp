#include "robomill/path/files/robot_programs/joint_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/path/files/trajectory.hpp"
#include "robomill/path/smooth.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "testing/path/joint_parsers.hpp"
#include "testing/path/trajectories.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace joint_run_test {

using robot::Position6;

constexpr double period_s = test::period_s;

robot::SerialKinematics arm(double tool_m = 0.25) {
  robot::Cell cell;
  cell.arm = robot::testing::with_limits(robot::testing::kr210());
  cell.tool_length_m = tool_m;
  return robot::SerialKinematics(cell);
}

/// Joints over time: about a posture, each joint a sine; at rest at both ends.
struct Sines {
  static constexpr double duration_s = 1.2;
  Position6 middle = Position6::Zero(), size = Position6::Zero(), rate = Position6::Zero();
  [[nodiscard]] Position6 at(double time_s) const {
    const double round = 2.0 * robot::testing::pi / duration_s;
    const double run_s = time_s - std::sin(round * time_s) / round;
    return middle + (size.array() * (1.0 - (rate.array() * run_s).cos())).matrix();
  }
};

Sines random_sines(Random& random) {
  Sines out;
  for (int joint = 0; joint < 6; ++joint) {
    out.middle[joint] = random.uniform(-1.5, 1.5);
    out.size[joint] = random.uniform(-0.1, 0.1);
    out.rate[joint] = random.uniform(0.5, 3.0);
  }
  return out;
}

template <class Joints>
std::vector<Sample> samples_of(const robot::Kinematics& machine, std::size_t count, Joints&& joints) {
  std::vector<Sample> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    out[i].time_s = static_cast<double>(i) * period_s;
    out[i].joints = joints(out[i].time_s);
    const robot::ToolPose pose = machine.forward(out[i].joints);
    out[i].tip_m = pose.tip_m;
    out[i].axis = pose.axis;
    out[i].block = i == 0 ? 0 : (i - 1) / 2;
  }
  return out;
}

/// The program that these samples follow: a block every two of them.
program::Program program_of(const std::vector<Sample>& samples) {
  const auto pose = [](const Sample& sample) { return program::Pose{.tip_m = sample.tip_m, .axis = sample.axis}; };
  program::Program out{.start = pose(samples.front()), .blocks = {}};
  for (std::size_t i = 2; i < samples.size() + 1; i += 2) {
    program::Block block;
    block.end = pose(samples[std::min(i, samples.size() - 1)]);
    block.duration_s = 2.0 * period_s;
    out.blocks.push_back(block);
  }
  return out;
}

SmoothingOptions tolerances(double tip_m, double axis_rad) {
  SmoothingOptions out;
  out.tip_tolerance_m = tip_m;
  out.axis_tolerance_rad = axis_rad;
  out.max_velocity_m_per_s = out.max_acceleration_m_per_s2 = out.max_jerk_m_per_s3 = 1.0;
  out.max_angular_velocity_rad_per_s = out.max_angular_acceleration_rad_per_s2 = out.max_angular_jerk_rad_per_s3 = 1.0;
  out.sample_period_s = period_s;
  return out;
}

struct Written {
  ProgramRun run;
  std::string text;
  test::Parsed parsed;
};

Written written(const robomill::test::Folder& folder, const std::string& ending, double point_period_s,
                const std::vector<Sample>& samples, const robot::Kinematics& machine, const SmoothingOptions& options) {
  TrajectoryInfo info = test::arm_info();
  info.program_period_s = point_period_s;
  const auto path = folder.at("part" + ending);
  const auto file = open_sample_file(path, info);
  file->restart();
  file->add(samples);
  const program::Program program = program_of(samples);
  program::ProgramSource source(program);
  Written out;
  out.run = file->verify(source, machine, options, true, Progress::none()).value();
  file->commit();
  out.text = io::read_file(path);
  if (out.run.points < 10'000) out.parsed = test::parse(ending, out.text, point_period_s);
  return out;
}

struct Far {
  double tip_m = 0.0, axis_rad = 0.0;
};

/// How far straight lines in the joints between the points of a file leave a trajectory, in 64 looks a step.
template <class Joints>
Far dense(const Written& written, bool degrees, const robot::Kinematics& machine, Joints&& joints) {
  const auto held = [&](const test::Point& point) {
    Position6 out;
    for (int i = 0; i < 6; ++i) {
      const double number = point.joints[static_cast<std::size_t>(i)];
      out[i] = degrees ? static_cast<double>(static_cast<float>(number)) * units::deg : number;
    }
    return out;
  };
  Far far;
  for (std::size_t i = 1; i < written.parsed.points.size(); ++i) {
    const test::Point &from = written.parsed.points[i - 1], &to = written.parsed.points[i];
    for (int look = 0; look <= 64; ++look) {
      const double share = look / 64.0;
      const robot::ToolPose is = machine.forward(held(from) + share * (held(to) - held(from)));
      const robot::ToolPose ought = machine.forward(joints(from.time_s + share * (to.time_s - from.time_s)));
      far.tip_m = std::max(far.tip_m, (is.tip_m - ought.tip_m).norm());
      far.axis_rad = std::max(far.axis_rad, program::angle_between(is.axis, ought.axis));
    }
  }
  return far;
}

Far header_of(const std::string& text) {
  std::smatch match;
  const std::regex figures(
      R"(leave the trajectory by \d+\.\d+ degrees a joint, (\d+\.\d+) mm at the tip, (\d+\.\d+) deg)");
  if (!std::regex_search(text, match, figures)) return {};
  return {.tip_m = std::stod(match[1]) * units::mm, .axis_rad = std::stod(match[2]) * units::deg};
}

struct Language {
  const char* ending;
  double point_period_s;
  bool degrees;
};
constexpr std::array<Language, 4> languages = {
    {{".src", 0.020, true}, {".mod", 0.020, true}, {".script", 0.008, false}, {".servoj", 0.008, false}}};

// What is reported is never less than what forward kinematics of the file's own points give, however densely looked at.
TEST(JointRun, ReportsAtLeastWhatTheFilesPointsDoAtRandomPostures) {
  const robomill::test::Folder folder;
  const robot::SerialKinematics machine = arm();
  const SmoothingOptions loose = tolerances(0.1, 1.0);
  Random random(20);
  for (int round = 0; round < 12; ++round) {
    const Sines sines = random_sines(random);
    const auto joints = [&](double time_s) { return sines.at(time_s); };
    const auto samples = samples_of(machine, 1201, joints);
    for (const Language& language : languages) {
      const Written file = written(folder, language.ending, language.point_period_s, samples, machine, loose);
      ASSERT_EQ(file.parsed.trouble, "");
      const Far far = dense(file, language.degrees, machine, joints);
      const Far header = header_of(file.text);
      EXPECT_GE(file.run.distances.tip_deviation_m, far.tip_m - 1e-12) << language.ending << " round " << round;
      EXPECT_GE(file.run.distances.axis_deviation_rad, far.axis_rad - 1e-9) << language.ending << " round " << round;
      EXPECT_GE(header.tip_m, file.run.distances.tip_deviation_m);
      EXPECT_GE(header.axis_rad, file.run.distances.axis_deviation_rad);
      // … nor much more, unless the controller's corners or spline go farther.
      EXPECT_LE(file.run.distances.tip_deviation_m, 1.6 * far.tip_m + 1e-6) << language.ending << " round " << round;
    }
  }
}

/// The tool turns about its standing tip.
struct Turn {
  const robot::SerialKinematics& machine;
  std::vector<Position6> joints = {};
  Turn(const robot::SerialKinematics& kinematics, double rad_per_s, std::size_t count) : machine(kinematics) {
    Position6 at = Eigen::Map<const Position6>(robot::testing::kr210_posture().eval().data());
    const robot::ToolPose first = machine.forward(at);
    for (std::size_t i = 0; i < count; ++i) {
      robot::ToolPose pose = first;
      const double angle = rad_per_s * static_cast<double>(i) * period_s;
      pose.axis = Eigen::AngleAxisd(angle, first.axis.unitOrthogonal()) * first.axis;
      EXPECT_EQ(machine.follow(pose, at, at).status, robot::Reach::Status::found);
      joints.push_back(at);
    }
  }
  [[nodiscard]] Position6 operator()(double time_s) const {
    return joints[static_cast<std::size_t>(std::lround(time_s / period_s))];
  }
};

// The tip stands still in every sample, so the chord of two tips says nothing; the chord of the joints swings it.
TEST(JointRun, SeesTheTipSwingInAPureRotation) {
  const robomill::test::Folder folder;
  const robot::SerialKinematics machine = arm();
  const Turn turn(machine, 1.5, 401);
  const auto samples = samples_of(machine, 401, turn);
  for (const Sample& sample : samples) ASSERT_LT((sample.tip_m - samples.front().tip_m).norm(), 1e-9);
  const Written loose = written(folder, ".src", 0.020, samples, machine, tolerances(1e-3, 0.1));
  EXPECT_EQ(loose.run.longest_step_s, loose.run.shortest_step_s);
  EXPECT_GT(loose.run.distances.tip_deviation_m, 50e-6);
  EXPECT_GT(header_of(loose.text).tip_m, 50e-6);
  // With a tolerance of 20 µm points stand nearer to each other, in the file too.
  const Written tight = written(folder, ".src", 0.020, samples, machine, tolerances(20e-6, 0.1));
  ASSERT_TRUE(tight.run.holds());
  EXPECT_LT(tight.run.longest_step_s, 0.015);
  EXPECT_EQ(tight.parsed.points.size(), tight.run.points);
  double worst_m = 0.0;
  for (std::size_t i = 1; i < tight.parsed.points.size(); ++i) {
    Position6 middle;
    for (int joint = 0; joint < 6; ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      middle[joint] = 0.5 * (tight.parsed.points[i - 1].joints[j] + tight.parsed.points[i].joints[j]) * units::deg;
    }
    worst_m = std::max(worst_m, (machine.forward(middle).tip_m - samples.front().tip_m).norm());
  }
  EXPECT_LE(worst_m, 20e-6);
  EXPECT_GE(tight.run.distances.tip_deviation_m, worst_m - 1e-6);
}

TEST(JointRun, PutsPointsNearerOnlyWhereTheToleranceAsksForIt) {
  const robomill::test::Folder folder;
  const robot::SerialKinematics machine = arm();
  // Slow, but for a quick swing of joint 5 in the middle.
  const auto joints = [](double time_s) {
    Position6 out = Eigen::Map<const Position6>(robot::testing::kr210_posture().eval().data());
    out[0] += 0.02 * time_s;
    out[4] += 0.02 * std::exp(-std::pow((time_s - 1.0) / 0.1, 2));
    return out;
  };
  const auto samples = samples_of(machine, 2001, joints);
  for (const char* ending : {".src", ".mod"}) {
    const Written file = written(folder, ending, 0.020, samples, machine, tolerances(20e-6, 0.1));
    ASSERT_TRUE(file.run.holds());
    EXPECT_EQ(file.run.longest_step_s, 0.020);
    EXPECT_LT(file.run.shortest_step_s, 0.011);
    EXPECT_LT(file.run.points, 160U);
    ASSERT_EQ(file.parsed.trouble, "");
    EXPECT_LE(dense(file, true, machine, joints).tip_m, 20e-6);
    EXPECT_NE(file.text.find("ms apart"), std::string::npos);
  }
}

// A smoothed zigzag: chords of 64 ms miss its corners, points nearer to each other do not.
TEST(JointRun, KeepsTheCornersOfASmoothedProgram) {
  const robomill::test::Folder folder;
  robot::Cell cell;
  cell.arm = robot::testing::with_limits(robot::testing::kr210());
  cell.tool_length_m = 0.25;
  for (robot::Joint& joint : cell.arm.joints) {
    joint.max_velocity = 2.0;
    joint.max_acceleration = 8.0;
    joint.max_jerk = 200.0;
  }
  const robot::SerialKinematics machine(cell);
  Posture posture;
  posture.start = robot::testing::kr210_posture();
  const robot::ToolPose first = machine.forward(posture.start);
  posture.gamma_rad = {first.gamma_rad};
  program::Program zigzag{.start = {.tip_m = first.tip_m, .axis = first.axis}, .blocks = {}};
  for (int i = 0; i < 12; ++i) {
    program::Block block;
    block.end = i == 0 ? zigzag.start : zigzag.blocks.back().end;
    block.end.tip_m += 0.006 * Eigen::Vector3d::Unit(i % 3);
    block.end.axis = (block.end.axis + 0.01 * Eigen::Vector3d::Unit((i + 1) % 3)).normalized();
    block.duration_s = 0.15;
    zigzag.blocks.push_back(block);
  }
  SmoothingOptions options = tolerances(20e-6, 2e-3);
  options.max_velocity_m_per_s = 0.05;
  options.max_acceleration_m_per_s2 = 0.5;
  options.max_jerk_m_per_s3 = 10.0;
  options.max_angular_acceleration_rad_per_s2 = 10.0;
  options.max_angular_jerk_rad_per_s3 = 200.0;
  program::ProgramSource source(zigzag);
  for (const char* ending : {".src", ".mod"}) {
    TrajectoryInfo info = test::arm_info();
    info.program_period_s = 0.064;
    const auto file = open_sample_file(folder.at(std::string("zigzag") + ending), info);
    const Summary summary = smooth(
        source, machine, posture, options, [&](std::span<const Sample> samples) { file->add(samples); },
        [&] { file->restart(); }, Progress::none());
    ASSERT_EQ(summary.check.violations(), 0U);
    const ProgramRun far = file->verify(source, machine, options, false, Progress::none()).value();
    EXPECT_GT(far.distances.tip_error_m, 2.0 * options.tip_tolerance_m) << ending;
    const ProgramRun run = file->verify(source, machine, options, true, Progress::none()).value();
    EXPECT_TRUE(run.holds()) << ending << " " << run.distances.tip_error_m << " " << run.shortest_step_s;
    EXPECT_GT(run.shortest_step_s, 2.0 * period_s) << ending;
    EXPECT_LT(run.shortest_step_s, run.longest_step_s) << ending;
  }
}

// A cycle is the controller's: no point can be added, but which cycle would do is reported.
TEST(JointRun, ReportsTheCycleThatWouldHold) {
  const robomill::test::Folder folder;
  const robot::SerialKinematics machine = arm();
  const Turn turn(machine, 1.5, 401);
  const auto samples = samples_of(machine, 401, turn);
  const Written far = written(folder, ".servoj", 0.032, samples, machine, tolerances(20e-6, 0.1));
  EXPECT_FALSE(far.run.holds());
  EXPECT_EQ(far.run.points, 14U);
  EXPECT_NE(far.text.find("BEYOND THE TOLERANCE"), std::string::npos);
  ASSERT_GT(far.run.would_hold_s, 0.0);
  EXPECT_TRUE(written(folder, ".servoj", far.run.would_hold_s, samples, machine, tolerances(20e-6, 0.1)).run.holds());
}

// 66 s at 2 ms are 4 MB of URScript; rows that a client streams have no end.
TEST(JointRun, ReportsWhichProgramsNoControllerIsKnownToLoad) {
  const robomill::test::Folder folder;
  const robot::SerialKinematics machine = arm();
  const auto joints = [](double time_s) { return Position6::Constant(0.3 + 0.001 * time_s).eval(); };
  const auto samples = samples_of(machine, 66'003, joints);
  const SmoothingOptions loose = tolerances(1e-3, 0.1);
  const Written script = written(folder, ".script", 0.002, samples, machine, loose);
  EXPECT_TRUE(script.run.keeps_tolerances());
  EXPECT_EQ(script.run.points, 33'002U);
  EXPECT_TRUE(script.run.too_long());
  EXPECT_FALSE(script.run.holds());
  EXPECT_NEAR(static_cast<double>(script.text.size()), 4e6, 0.4e6);
  EXPECT_TRUE(written(folder, ".script", 0.008, samples, machine, loose).run.holds());
  const auto few = samples_of(machine, 101, joints);
  EXPECT_EQ(written(folder, ".src", 0.020, few, machine, loose).run.most_points, script.run.most_points);
  for (const char* ending : {".mod", ".servoj"}) {
    EXPECT_EQ(written(folder, ending, 0.020, few, machine, loose).run.most_points, 0U) << ending;
  }
}

// Thirty-two bits hold 150° to 8 millionths of a degree: more than the printed digits leave out.
TEST(JointRun, CountsWhatTheControllersNumbersLeaveOut) {
  const robomill::test::Folder folder;
  const robot::SerialKinematics machine = arm();
  Position6 at;
  at << 2.6180339, 0.2, 0.3, 2.7182818, -0.9, 3.0000007;
  const auto samples = samples_of(machine, 101, [&](double) { return at; });
  const Written kuka = written(folder, ".src", 0.020, samples, machine, tolerances(1e-3, 0.1));
  Position6 held;
  for (int i = 0; i < 6; ++i) {
    held[i] = static_cast<double>(static_cast<float>(kuka.parsed.points.front().joints[static_cast<std::size_t>(i)])) *
              units::deg;
  }
  const double off_m = (machine.forward(held).tip_m - machine.forward(at).tip_m).norm();
  EXPECT_GT(off_m, 2e-8);
  EXPECT_GE(kuka.run.distances.tip_deviation_m, off_m);
  EXPECT_LT(kuka.run.distances.tip_deviation_m, 1.1 * off_m);
  const Written ur = written(folder, ".servoj", 0.002, samples, machine, tolerances(1e-3, 0.1));
  EXPECT_LT(ur.run.distances.tip_deviation_m, 4e-9);
}

// Uneven steps: the spline follows a parabola exactly, the zone stays between corner and chord and ends on the chords.
TEST(JointStep, JoinsPointsAsItSays) {
  const auto parabola = [](double t) { return Position6::Constant(1.0 + 2.0 * t - 0.3 * t * t).eval(); };
  const JointStep step = {.points = {parabola(0.0), parabola(1.0), parabola(3.0), parabola(7.0)},
                          .lengths = {1.0, 2.0, 4.0}};
  for (const double share : {0.0, 0.2, 0.5, 0.9, 1.0}) {
    const double t = 1.0 + 2.0 * share;
    EXPECT_NEAR(step.at(Joining::spline, share)[0], parabola(t)[0], 1e-12);
    const double line = (1.0 - share) * parabola(1.0)[0] + share * parabola(3.0)[0];
    EXPECT_NEAR(step.at(Joining::line, share)[0], line, 1e-12);
    EXPECT_LE(step.at(Joining::zone, share)[0], line + 1e-12);  // below the chord, where the curve bends down
  }
  EXPECT_NEAR(step.at(Joining::zone, 0.5)[0], step.at(Joining::line, 0.5)[0], 1e-12);
  EXPECT_NEAR(step.at(Joining::zone, 0.5 + 1e-9)[0], step.at(Joining::zone, 0.5)[0], 1e-7);
  // A straight line at even speed stays one.
  const auto line = [](double t) { return Position6::Constant(3.0 * t).eval(); };
  const JointStep even = {.points = {line(0.0), line(1.0), line(3.0), line(7.0)}, .lengths = {1.0, 2.0, 4.0}};
  for (const double share : {0.1, 0.4, 0.6, 0.95}) {
    for (const Joining joining : {Joining::line, Joining::spline, Joining::zone}) {
      EXPECT_NEAR(even.at(joining, share)[2], 3.0 * (1.0 + 2.0 * share), 1e-12);
    }
  }
  // At rest it stops: no corner is cut and the spline begins with no speed.
  JointStep rest = step;
  rest.from_rests = true;
  EXPECT_EQ(rest.at(Joining::zone, 0.0)[0], parabola(1.0)[0]);
  EXPECT_NEAR((rest.at(Joining::spline, 1e-6)[0] - parabola(1.0)[0]) / 2e-6, 0.0, 1e-4);
}

}  // namespace joint_run_test
}  // namespace robomill::path
