#include "robomill/path/files/robot_programs/joint_dialects.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "robomill/io/system/append.hpp"

namespace robomill::path {
namespace {

constexpr std::array line = {Joining::line};
constexpr double radian_digits = 1e9;

void radians(fmt::memory_buffer& out, const robot::Position6& joints, const char* parted) {
  for (int joint = 0; joint < 6; ++joint) {
    io::append(out, "{}{:.9f}", joint > 0 ? parted : "", joints[joint]);
  }
}

/// Written by radians().
robot::Position6 held_radians(const robot::Position6& joints) {
  return (joints * radian_digits).array().round() / radian_digits;
}

/// "p[x,y,z,rx,ry,rz]": m and the turn's axis times its angle in rad.
std::string vector_pose(const Eigen::Isometry3d& frame) {
  const Eigen::AngleAxisd angle_axis(frame.linear());
  const Eigen::Vector3d at_m = frame.translation() + Eigen::Vector3d::Zero();
  const Eigen::Vector3d turn = angle_axis.angle() * angle_axis.axis() + Eigen::Vector3d::Zero();
  return fmt::format("p[{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}]", at_m.x(), at_m.y(), at_m.z(), turn.x(), turn.y(),
                     turn.z());
}

class UrScript final : public JointDialect {
 public:
  UrScript(std::string name, const EndEffector& end, double period_s)
      : name_(std::move(name)), end_(end), period_s_(period_s) {}
  [[nodiscard]] const char* comment() const override { return "  # "; }
  [[nodiscard]] std::span<const Joining> joinings() const override { return line; }
  [[nodiscard]] JointPoints::Held held() const override { return held_radians; }
  [[nodiscard]] bool fixed_cycle() const override { return true; }
  [[nodiscard]] std::size_t most_points() const override { return points_in_memory; }
  [[nodiscard]] std::string pose(const Eigen::Isometry3d& frame) const override { return vector_pose(frame); }
  void open(fmt::memory_buffer& out) override { io::append(out, "def {}():\n", name_); }
  [[nodiscard]] std::vector<std::string> not_set(const Outputs& wanted) const override {
    std::vector<std::string> lines;
    if (!end_.mass_kg) {
      lines.emplace_back("NOT SET: tool and load (tool.mass_kg in the cell). Those of the installation count.");
      lines.emplace_back(wrong_load);
    } else {
      add_assumed_load(end_, lines);
    }
    add_missing_outputs(end_, wanted, lines);
    return lines;
  }
  void start(fmt::memory_buffer& out, const robot::Position6& joints, const Outputs& on) override {
    if (end_.mass_kg) {
      const Eigen::AngleAxisd turn(end_.tip.linear());
      io::append(out, "  set_tcp(p[{},{}])\n  set_payload({:.6g}, [{}])\n", three(end_.tip.translation(), 1.0),
                 three(turn.angle() * turn.axis(), 1.0), *end_.mass_kg, three(end_.center(), 1.0));
    }
    put(out, "  movej([");
    radians(out, joints, ", ");
    put(out, "], a=0.5, v=0.2)\n");
    if (on.coolant) switch_output(out, end_.coolant, true);
    if (on.spindle && switch_output(out, end_.spindle, true)) {
      io::append(out, "  sleep({:.6g})\n", end_.spin_up_s);
    }
  }
  void point(fmt::memory_buffer& out, const robot::Position6& joints, double seconds, bool) override {
    put(out, "  servoj([");
    radians(out, joints, ", ");
    io::append(out, "], 0, 0, {:.6g}, 0.03, 2000)\n", seconds);
  }
  void wait(fmt::memory_buffer& out, const robot::Position6& joints, double seconds) override {
    point(out, joints, seconds, true);
  }
  void close(fmt::memory_buffer& out, const Outputs& off) override {
    put(out, "  stopj(2.0)\n");
    if (off.spindle) switch_output(out, end_.spindle, false);
    if (off.coolant) switch_output(out, end_.coolant, false);
    io::append(out, "end\n{}()\n", name_);
  }
  [[nodiscard]] std::string advice() const override {
    return fmt::format(
        "servoj follows its targets with a lag of about its look-ahead (0.03 s) and rounds corners by it; a "
        "controller\n"
        "of {:.6g} Hz or faster runs a point a cycle. Very long programs are better streamed (.servoj).\n{}",
        1.0 / period_s_, same_angles);
  }

 private:
  static bool switch_output(fmt::memory_buffer& out, const DigitalOutput& output, bool on) {
    if (!output.number) return false;
    io::append(out, "  set_standard_digital_out({}, {})\n", *output.number, on ? "True" : "False");
    return true;
  }

  std::string name_;
  EndEffector end_;
  double period_s_;
};

/// The joints alone, for a client that sends a row each cycle.
class Servoj final : public JointDialect {
 public:
  explicit Servoj(double period_s) : period_s_(period_s) {}
  [[nodiscard]] const char* comment() const override { return "# "; }
  [[nodiscard]] std::span<const Joining> joinings() const override { return line; }
  [[nodiscard]] JointPoints::Held held() const override { return held_radians; }
  [[nodiscard]] bool fixed_cycle() const override { return true; }
  [[nodiscard]] std::size_t most_points() const override { return 0; }
  [[nodiscard]] std::string pose(const Eigen::Isometry3d& frame) const override { return vector_pose(frame); }
  void open(fmt::memory_buffer&) override {}
  [[nodiscard]] std::vector<std::string> not_set(const Outputs& wanted) const override {
    std::vector<std::string> lines = {
        "NOT SET: tool and load, which the client must set before. Rows hold joints alone.", wrong_load};
    if (wanted.spindle) lines.emplace_back("NOT SET: the spindle, which the client must start before the second row.");
    if (wanted.coolant) lines.emplace_back("NOT SET: coolant.");
    return lines;
  }
  void start(fmt::memory_buffer& out, const robot::Position6& joints, const Outputs&) override { row(out, joints); }
  void point(fmt::memory_buffer& out, const robot::Position6& joints, double, bool) override { row(out, joints); }
  void wait(fmt::memory_buffer& out, const robot::Position6& joints, double seconds) override {
    for (long rows = std::lround(seconds / period_s_); rows > 0; --rows) row(out, joints);
  }
  void close(fmt::memory_buffer&, const Outputs&) override {}
  [[nodiscard]] std::string advice() const override {
    return std::string(
               "q1 q2 q3 q4 q5 q6 in rad, a row a cycle; the first row is where the robot must stand before.\n") +
           same_angles;
  }

 private:
  static void row(fmt::memory_buffer& out, const robot::Position6& joints) {
    radians(out, joints, " ");
    out.push_back('\n');
  }
  double period_s_;
};

}  // namespace

std::unique_ptr<JointDialect> urscript_dialect(const std::string& name, const EndEffector& end, double period_s) {
  return std::make_unique<UrScript>(name, end, period_s);
}
std::unique_ptr<JointDialect> servoj_dialect(double period_s) {
  return std::make_unique<Servoj>(period_s);
}

}  // namespace robomill::path
