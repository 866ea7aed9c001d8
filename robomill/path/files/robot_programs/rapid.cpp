#include "robomill/path/files/robot_programs/joint_dialects.hpp"

#include <array>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/system/append.hpp"

namespace robomill::path {
namespace {

constexpr std::array line_or_zone = {Joining::line, Joining::zone};

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
  [[nodiscard]] std::string pose(const Eigen::Isometry3d& frame) const override {
    const Eigen::Quaterniond turn(frame.linear());
    return fmt::format("[[{}],[{:.6f},{:.6f},{:.6f},{:.6f}]]", three(frame.translation(), units::mm), turn.w(),
                       turn.x(), turn.y(), turn.z());
  }
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

}  // namespace

std::unique_ptr<JointDialect> rapid_dialect(const std::string& name, const EndEffector& end) {
  return std::make_unique<Rapid>(name, end);
}

}  // namespace robomill::path
