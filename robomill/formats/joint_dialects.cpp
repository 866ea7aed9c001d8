#include "robomill/formats/joint_dialects.hpp"

#include <cmath>
#include <string_view>
#include <utility>

#include "robomill/formats/units.hpp"

namespace robomill::formats {
namespace {

constexpr const char* same_angles =
    "Joint angles are those of the cell's model: compare signs and zeros with the controller's before the first run.\n";

/// "{A1 1.5,A2 …}" or "1.5,…": six decimals of a degree, which is what a controller's 32-bit numbers hold.
void degrees(fmt::memory_buffer& out, const robot::Position6& joints, bool named) {
  for (int joint = 0; joint < 6; ++joint) {
    if (joint > 0) out.push_back(',');
    if (named) fmt::format_to(fmt::appender(out), "A{} ", joint + 1);
    fmt::format_to(fmt::appender(out), "{:.6f}", joints[joint] / units::deg);
  }
}

void radians(fmt::memory_buffer& out, const robot::Position6& joints, const char* parted) {
  for (int joint = 0; joint < 6; ++joint) {
    fmt::format_to(fmt::appender(out), "{}{:.9f}", joint > 0 ? parted : "", joints[joint]);
  }
}

void put(fmt::memory_buffer& out, std::string_view text) {
  out.append(text.data(), text.data() + text.size());
}

/// Spline blocks in joint space with a time for each segment.
class Krl final : public JointDialect {
 public:
  explicit Krl(std::string name) : name_(std::move(name)) {}
  [[nodiscard]] const char* comment() const override { return "; "; }
  void open(fmt::memory_buffer& out) override {
    fmt::format_to(fmt::appender(out), "&ACCESS RVP\n&REL 1\nDEF {}()\n", name_);
  }
  void start(fmt::memory_buffer& out, const robot::Position6& joints) override {
    put(out, "BAS(#INITMOV,0)\nBAS(#VEL_PTP,10)\n$APO.CDIS=0.1\n$APO.CPTP=1\n$ADVANCE=3\nPTP {");
    degrees(out, joints, true);
    put(out, "}\n");
  }
  void point(fmt::memory_buffer& out, const robot::Position6& joints, double seconds, bool rests) override {
    if (segments_ == 0) put(out, "PTP_SPLINE\n TIME_BLOCK START\n");
    put(out, " SPTP {");
    degrees(out, joints, true);
    fmt::format_to(fmt::appender(out), "}}\n TIME_BLOCK PART={:.6f}\n", seconds);
    ++segments_;
    seconds_ += seconds;
    if (rests || segments_ == longest) end_block(out, rests);
  }
  void wait(fmt::memory_buffer& out, const robot::Position6&, double seconds) override {
    fmt::format_to(fmt::appender(out), "WAIT SEC {:.6f}\n", seconds);
  }
  void close(fmt::memory_buffer& out) override { put(out, "END\n"); }
  [[nodiscard]] std::string advice() const override {
    return fmt::format(
        "Spline blocks of at most {} points (KSS 8.3 or newer), passed on the fly with $APO. The controller draws its\n"
        "own spline through the points and keeps the times only as far as its own limits let it.\n{}",
        longest, same_angles);
  }

 private:
  static constexpr int longest = 250;  // 5 s of points every 20 ms: a block is computed before it is run

  void end_block(fmt::memory_buffer& out, bool rests) {
    fmt::format_to(fmt::appender(out), " TIME_BLOCK END={:.6f}\nENDSPLINE{}\n", seconds_, rests ? "" : " C_SPL");
    segments_ = 0;
    seconds_ = 0.0;
  }

  std::string name_;
  int segments_ = 0;
  double seconds_ = 0.0;
};

/// Absolute joint moves with a time each, in procedures that main calls in turn.
class Rapid final : public JointDialect {
 public:
  explicit Rapid(std::string name) : name_(std::move(name)) {}
  [[nodiscard]] const char* comment() const override { return "! "; }
  void open(fmt::memory_buffer& out) override { fmt::format_to(fmt::appender(out), "MODULE {}\n", name_); }
  void start(fmt::memory_buffer& out, const robot::Position6& joints) override {
    put(out, "LOCAL CONST extjoint ext:=[9E9,9E9,9E9,9E9,9E9,9E9];\nLOCAL PROC go_to_start()\nMoveAbsJ [[");
    degrees(out, joints, false);
    put(out, "],ext]\\NoEOffs,v100,fine,tool0;\nENDPROC\n");
  }
  void point(fmt::memory_buffer& out, const robot::Position6& joints, double seconds, bool rests) override {
    next_line(out);
    put(out, "MoveAbsJ [[");
    degrees(out, joints, false);
    fmt::format_to(fmt::appender(out), "],ext]\\NoEOffs,v1000\\T:={:.6f},{},tool0;\n", seconds, rests ? "fine" : "z0");
  }
  void wait(fmt::memory_buffer& out, const robot::Position6&, double seconds) override {
    next_line(out);
    fmt::format_to(fmt::appender(out), "WaitTime {:.6f};\n", seconds);
  }
  void close(fmt::memory_buffer& out) override {
    if (lines_ > 0) put(out, "ENDPROC\n");
    put(out, "PROC main()\ngo_to_start;\n");
    for (int part = 1; part <= parts_; ++part) fmt::format_to(fmt::appender(out), "part_{};\n", part);
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

  void next_line(fmt::memory_buffer& out) {
    if (lines_ == longest) {
      put(out, "ENDPROC\n");
      lines_ = 0;
    }
    if (lines_ == 0) fmt::format_to(fmt::appender(out), "LOCAL PROC part_{}()\n", ++parts_);
    ++lines_;
  }

  std::string name_;
  int lines_ = 0, parts_ = 0;
};

class UrScript final : public JointDialect {
 public:
  UrScript(std::string name, double period_s) : name_(std::move(name)), period_s_(period_s) {}
  [[nodiscard]] const char* comment() const override { return "  # "; }
  void open(fmt::memory_buffer& out) override { fmt::format_to(fmt::appender(out), "def {}():\n", name_); }
  void start(fmt::memory_buffer& out, const robot::Position6& joints) override {
    put(out, "  movej([");
    radians(out, joints, ", ");
    put(out, "], a=0.5, v=0.2)\n");
  }
  void point(fmt::memory_buffer& out, const robot::Position6& joints, double seconds, bool) override {
    put(out, "  servoj([");
    radians(out, joints, ", ");
    fmt::format_to(fmt::appender(out), "], 0, 0, {:.6g}, 0.03, 2000)\n", seconds);
  }
  void wait(fmt::memory_buffer& out, const robot::Position6& joints, double seconds) override {
    point(out, joints, seconds, true);
  }
  void close(fmt::memory_buffer& out) override {
    fmt::format_to(fmt::appender(out), "  stopj(2.0)\nend\n{}()\n", name_);
  }
  [[nodiscard]] std::string advice() const override {
    return fmt::format(
        "servoj follows its targets with a lag of about its look-ahead (0.03 s) and rounds corners by it; a "
        "controller\n"
        "of {:.6g} Hz or faster runs a point a cycle. Very long programs are better streamed (.servoj).\n{}",
        1.0 / period_s_, same_angles);
  }

 private:
  std::string name_;
  double period_s_;
};

/// The joints alone, for a client that sends a row each cycle.
class Servoj final : public JointDialect {
 public:
  explicit Servoj(double period_s) : period_s_(period_s) {}
  [[nodiscard]] const char* comment() const override { return "# "; }
  void open(fmt::memory_buffer&) override {}
  void start(fmt::memory_buffer& out, const robot::Position6& joints) override { row(out, joints); }
  void point(fmt::memory_buffer& out, const robot::Position6& joints, double, bool) override { row(out, joints); }
  void wait(fmt::memory_buffer& out, const robot::Position6& joints, double seconds) override {
    for (long rows = std::lround(seconds / period_s_); rows > 0; --rows) row(out, joints);
  }
  void close(fmt::memory_buffer&) override {}
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

std::unique_ptr<JointDialect> krl_dialect(const std::string& name) {
  return std::make_unique<Krl>(name);
}
std::unique_ptr<JointDialect> rapid_dialect(const std::string& name) {
  return std::make_unique<Rapid>(name);
}
std::unique_ptr<JointDialect> urscript_dialect(const std::string& name, double period_s) {
  return std::make_unique<UrScript>(name, period_s);
}
std::unique_ptr<JointDialect> servoj_dialect(double period_s) {
  return std::make_unique<Servoj>(period_s);
}

}  // namespace robomill::formats
