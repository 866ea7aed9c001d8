#include "robomill/path/files/joint_dialects.hpp"

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/append.hpp"

namespace robomill::path {
namespace {

constexpr const char* same_angles =
    "Joint angles are those of the cell's model: compare signs and zeros with the controller's before the first run.\n";

/// "{A1 1.5,A2 …}" or "1.5,…": six decimals of a degree, more than a controller's 32-bit numbers hold.
void degrees(fmt::memory_buffer& out, const robot::Position6& joints, bool named) {
  for (int joint = 0; joint < 6; ++joint) {
    if (joint > 0) out.push_back(',');
    if (named) io::append(out, "A{} ", joint + 1);
    io::append(out, "{:.6f}", joints[joint] / units::deg);
  }
}

void radians(fmt::memory_buffer& out, const robot::Position6& joints, const char* parted) {
  for (int joint = 0; joint < 6; ++joint) {
    io::append(out, "{}{:.9f}", joint > 0 ? parted : "", joints[joint]);
  }
}

/// About 4 MB of text at 120 bytes a point: what is known to fit into the memory of a KR C4. A Universal Robots
/// controller is known to fail at 18 MB; that it loads as much is an inference. docs/formats.md.
constexpr std::size_t points_in_memory = 33'000;

constexpr double degree_digits = 1e6, radian_digits = 1e9;

/// The nearest 32-bit number. Volatile: where it vectorises, g++ 12 drops the conversion there and back.
double as_real(double value) {
  const volatile float real = static_cast<float>(value);
  return static_cast<double>(real);
}

/// Written by degrees(), read as a 32-bit number.
robot::Position6 held_degrees(const robot::Position6& joints) {
  const robot::Position6 written = (joints / units::deg * degree_digits).array().round() / degree_digits;
  return written.unaryExpr(&as_real) * units::deg;
}

/// Written by radians().
robot::Position6 held_radians(const robot::Position6& joints) {
  return (joints * radian_digits).array().round() / radian_digits;
}

constexpr std::array line = {Joining::line};
constexpr std::array line_or_spline = {Joining::line, Joining::spline};
constexpr std::array line_or_zone = {Joining::line, Joining::zone};

void put(fmt::memory_buffer& out, std::string_view text) {
  out.append(text.data(), text.data() + text.size());
}

constexpr const char* wrong_load =
    "With a wrong load the arm sags, its dynamics are wrong, and it may leave its path by far more than is stated "
    "here.";

/// Lines about outputs that the cell does not name.
void add_missing_outputs(const EndEffector& end, const Outputs& wanted, std::vector<std::string>& lines) {
  if (wanted.spindle && !end.spindle.given()) {
    lines.emplace_back("NOT SET: the spindle (spindle.output in the cell). Start it by hand before this program runs.");
  }
  if (wanted.coolant && !end.coolant.given()) {
    lines.emplace_back("NOT SET: coolant (spindle.coolant_output in the cell).");
  }
}

/// What the file gives the controller for the load although nobody measured it.
void add_assumed_load(const EndEffector& end, std::vector<std::string>& lines) {
  lines.push_back(fmt::format("ASSUMED of the load of {:.6g} kg: {}no moments of inertia", *end.mass_kg,
                              end.center_m ? "" : "its centre half-way to the tip (tool.center_mm), "));
}

/// "1,2,3", in mm or m.
std::string three(const Eigen::Vector3d& value, double unit, const char* form = "{:.6g},{:.6g},{:.6g}") {
  const Eigen::Vector3d v = value / unit + Eigen::Vector3d::Zero();  // no -0
  return fmt::format(fmt::runtime(form), v.x(), v.y(), v.z());
}

/// Spline blocks in joint space with a time for each segment.
class Krl final : public JointDialect {
 public:
  Krl(std::string name, const EndEffector& end) : name_(std::move(name)), end_(end) {}
  [[nodiscard]] const char* comment() const override { return "; "; }
  [[nodiscard]] std::span<const Joining> joinings() const override { return line_or_spline; }
  [[nodiscard]] JointPoints::Held held() const override { return held_degrees; }
  [[nodiscard]] bool fixed_cycle() const override { return false; }
  [[nodiscard]] std::size_t most_points() const override { return points_in_memory; }
  void open(fmt::memory_buffer& out) override { io::append(out, "&ACCESS RVP\n&REL 1\nDEF {}()\n", name_); }
  [[nodiscard]] std::vector<std::string> not_set(const Outputs& wanted) const override {
    std::vector<std::string> lines;
    if (!end_.tool_number)
      lines.emplace_back("NOT SET: the tool (tool.number in the cell). The one selected last counts.");
    if (!end_.tool_number && !end_.load_number && !end_.mass_kg) {
      lines.emplace_back("NOT SET: the load (tool.load_number or tool.mass_kg in the cell).");
      lines.emplace_back(wrong_load);
    }
    if (end_.mass_kg && !end_.load_number) add_assumed_load(end_, lines);
    add_missing_outputs(end_, wanted, lines);
    return lines;
  }
  void start(fmt::memory_buffer& out, const robot::Position6& joints, const Outputs& on) override {
    put(out, "BAS(#INITMOV,0)\n");
    if (end_.tool_number) io::append(out, "BAS(#TOOL,{})\n", *end_.tool_number);
    write_load(out);
    put(out, "BAS(#VEL_PTP,10)\n$APO.CDIS=0.1\n$APO.CPTP=1\n$ADVANCE=3\nPTP {");
    degrees(out, joints, true);
    put(out, "}\n");
    if (on.coolant) switch_output(out, end_.coolant, true);
    if (on.spindle && switch_output(out, end_.spindle, true)) wait(out, joints, end_.spin_up_s);
  }
  void point(fmt::memory_buffer& out, const robot::Position6& joints, double seconds, bool rests) override {
    if (segments_ == 0) put(out, "PTP_SPLINE\n TIME_BLOCK START\n");
    put(out, " SPTP {");
    degrees(out, joints, true);
    io::append(out, "}}\n TIME_BLOCK PART={:.6f}\n", seconds);
    ++segments_;
    seconds_ += seconds;
    if (rests || segments_ == longest) end_block(out, rests);
  }
  void wait(fmt::memory_buffer& out, const robot::Position6&, double seconds) override {
    io::append(out, "WAIT SEC {:.6f}\n", seconds);
  }
  void close(fmt::memory_buffer& out, const Outputs& off) override {
    if (off.spindle) switch_output(out, end_.spindle, false);
    if (off.coolant) switch_output(out, end_.coolant, false);
    put(out, "END\n");
  }
  [[nodiscard]] std::string advice() const override {
    return fmt::format(
        "Spline blocks of at most {} points (KSS 8.3 or newer), passed on the fly with $APO. The controller draws its\n"
        "own spline through the points and keeps the times only as far as its own limits let it.\n{}",
        longest, same_angles);
  }

 private:
  static bool switch_output(fmt::memory_buffer& out, const DigitalOutput& output, bool on) {
    if (!output.number) return false;
    io::append(out, "$OUT[{}]={}\n", *output.number, on ? "TRUE" : "FALSE");
    return true;
  }

  /// BAS(#TOOL,n) does not set the load.
  void write_load(fmt::memory_buffer& out) const {
    const std::optional<int> number = end_.load_number ? end_.load_number : end_.tool_number;
    if (end_.load_number || (number && !end_.mass_kg)) {
      io::append(out, "$LOAD=LOAD_DATA[{}]\n", *number);
    } else if (end_.mass_kg) {
      io::append(out, "$LOAD={{M {:.6g},CM {{{},A 0.0,B 0.0,C 0.0}},J {{X 0.0,Y 0.0,Z 0.0}}}}\n", *end_.mass_kg,
                 three(end_.center(), units::mm, "X {:.6g},Y {:.6g},Z {:.6g}"));
    }
  }

  static constexpr int longest = 250;  // 5 s of points every 20 ms: a block is computed before it is run

  void end_block(fmt::memory_buffer& out, bool rests) {
    io::append(out, " TIME_BLOCK END={:.6f}\nENDSPLINE{}\n", seconds_, rests ? "" : " C_SPL");
    segments_ = 0;
    seconds_ = 0.0;
  }

  std::string name_;
  EndEffector end_;
  int segments_ = 0;
  double seconds_ = 0.0;
};

/// Absolute joint moves with a time each, in procedures that main calls in turn.
class Rapid final : public JointDialect {
 public:
  Rapid(std::string name, const EndEffector& end) : name_(std::move(name)), end_(end) {
    tool_ = !end.tool_name.empty() ? end.tool_name : (end.mass_kg ? "tool_of_cell" : "tool0");
  }
  [[nodiscard]] const char* comment() const override { return "! "; }
  [[nodiscard]] std::span<const Joining> joinings() const override { return line_or_zone; }
  [[nodiscard]] JointPoints::Held held() const override { return held_degrees; }
  [[nodiscard]] bool fixed_cycle() const override { return false; }
  [[nodiscard]] std::size_t most_points() const override { return 0; }
  void open(fmt::memory_buffer& out) override { io::append(out, "MODULE {}\n", name_); }
  [[nodiscard]] std::vector<std::string> not_set(const Outputs& wanted) const override {
    std::vector<std::string> lines;
    if (tool_ == "tool0") {
      lines.emplace_back(
          "NOT SET: tool and load (tool.mass_kg, or tool.name of a tooldata, in the cell). tool0 has no load.");
      lines.emplace_back(wrong_load);
    }
    if (tool_ == "tool_of_cell") add_assumed_load(end_, lines);
    add_missing_outputs(end_, wanted, lines);
    return lines;
  }
  void start(fmt::memory_buffer& out, const robot::Position6& joints, const Outputs& on) override {
    if (tool_ == "tool_of_cell") write_tool(out);
    put(out, "LOCAL CONST extjoint ext:=[9E9,9E9,9E9,9E9,9E9,9E9];\nLOCAL PROC go_to_start()\nMoveAbsJ [[");
    degrees(out, joints, false);
    io::append(out, "],ext]\\NoEOffs,v100,fine,{};\n", tool_);
    if (on.coolant) switch_output(out, end_.coolant, true);
    if (on.spindle && switch_output(out, end_.spindle, true)) {
      io::append(out, "WaitTime {:.6f};\n", end_.spin_up_s);
    }
    put(out, "ENDPROC\n");
  }
  void point(fmt::memory_buffer& out, const robot::Position6& joints, double seconds, bool rests) override {
    next_line(out);
    put(out, "MoveAbsJ [[");
    degrees(out, joints, false);
    io::append(out, "],ext]\\NoEOffs,v1000\\T:={:.6f},{},{};\n", seconds, rests ? "fine" : "z0", tool_);
  }
  void wait(fmt::memory_buffer& out, const robot::Position6&, double seconds) override {
    next_line(out);
    io::append(out, "WaitTime {:.6f};\n", seconds);
  }
  void close(fmt::memory_buffer& out, const Outputs& off) override {
    if (lines_ > 0) put(out, "ENDPROC\n");
    put(out, "PROC main()\ngo_to_start;\n");
    for (int part = 1; part <= parts_; ++part) io::append(out, "part_{};\n", part);
    if (off.spindle) switch_output(out, end_.spindle, false);
    if (off.coolant) switch_output(out, end_.coolant, false);
    put(out, "ENDPROC\nENDMODULE\n");
  }
  [[nodiscard]] std::string advice() const override {
    return std::string(
               "The controller joins the moves by its own path and keeps their times only as far as it can;\n"
               "zone z0 rounds each point within 0.3 mm.\n") +
           same_angles;
  }

 private:
  static constexpr int longest = 1000;  // lines of a procedure

  static bool switch_output(fmt::memory_buffer& out, const DigitalOutput& output, bool on) {
    if (output.signal.empty()) return false;
    io::append(out, "SetDO {},{};\n", output.signal, on ? 1 : 0);
    return true;
  }

  /// robhold, tframe, tload: [mass, cog, aom, inertia].
  void write_tool(fmt::memory_buffer& out) const {
    const Eigen::Quaterniond turn(end_.tip.linear());
    io::append(out,
               "LOCAL PERS tooldata {}:=[TRUE,[[{}],[{:.8f},{:.8f},{:.8f},{:.8f}]],[{:.6g},[{}],[1,0,0,0],0,0,0]];\n",
               tool_, three(end_.tip.translation(), units::mm), turn.w(), turn.x(), turn.y(), turn.z(), *end_.mass_kg,
               three(end_.center(), units::mm));
  }

  void next_line(fmt::memory_buffer& out) {
    if (lines_ == longest) {
      put(out, "ENDPROC\n");
      lines_ = 0;
    }
    if (lines_ == 0) io::append(out, "LOCAL PROC part_{}()\n", ++parts_);
    ++lines_;
  }

  std::string name_;
  EndEffector end_;
  std::string tool_;
  int lines_ = 0, parts_ = 0;
};

class UrScript final : public JointDialect {
 public:
  UrScript(std::string name, const EndEffector& end, double period_s)
      : name_(std::move(name)), end_(end), period_s_(period_s) {}
  [[nodiscard]] const char* comment() const override { return "  # "; }
  [[nodiscard]] std::span<const Joining> joinings() const override { return line; }
  [[nodiscard]] JointPoints::Held held() const override { return held_radians; }
  [[nodiscard]] bool fixed_cycle() const override { return true; }
  [[nodiscard]] std::size_t most_points() const override { return points_in_memory; }
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

std::unique_ptr<JointDialect> krl_dialect(const std::string& name, const EndEffector& end) {
  return std::make_unique<Krl>(name, end);
}
std::unique_ptr<JointDialect> rapid_dialect(const std::string& name, const EndEffector& end) {
  return std::make_unique<Rapid>(name, end);
}
std::unique_ptr<JointDialect> urscript_dialect(const std::string& name, const EndEffector& end, double period_s) {
  return std::make_unique<UrScript>(name, end, period_s);
}
std::unique_ptr<JointDialect> servoj_dialect(double period_s) {
  return std::make_unique<Servoj>(period_s);
}

}  // namespace robomill::path
