#include "robomill/path/files/robot_programs/joint_dialects.hpp"

#include <array>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/system/append.hpp"

namespace robomill::path {
namespace {

constexpr std::array line_or_spline = {Joining::line, Joining::spline};

/// Spline blocks in joint space with a time for each segment.
class Krl final : public JointDialect {
 public:
  Krl(std::string name, const EndEffector& end) : name_(std::move(name)), end_(end) {}
  [[nodiscard]] const char* comment() const override { return "; "; }
  [[nodiscard]] std::span<const Joining> joinings() const override { return line_or_spline; }
  [[nodiscard]] JointPoints::Held held() const override { return held_degrees; }
  [[nodiscard]] bool fixed_cycle() const override { return false; }
  [[nodiscard]] std::size_t most_points() const override { return points_in_memory; }
  [[nodiscard]] std::string pose(const Eigen::Isometry3d& frame) const override {
    return '{' + euler_pose(frame) + '}';
  }
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

}  // namespace

std::unique_ptr<JointDialect> krl_dialect(const std::string& name, const EndEffector& end) {
  return std::make_unique<Krl>(name, end);
}

}  // namespace robomill::path
