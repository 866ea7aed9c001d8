#include "robomill/path/files/robot_programs/joint_programs.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/path/files/robot_programs/joint_dialects.hpp"
#include "robomill/path/files/robot_programs/joint_run.hpp"
#include "robomill/path/files/sample_spool.hpp"
#include "robomill/path/files/trajectory_parts.hpp"

namespace robomill::path {
namespace {

constexpr double usual_period_s = 0.020;
constexpr double standing = 1e-9;          // rad; less than any of these languages resolves
constexpr std::size_t listed = 20;         // codes of the program that a header names
constexpr double servoj_period_s = 0.002;  // the 500 Hz of an e-Series controller

/// Of a name, in the language's rules; none: without a limit.
std::optional<std::size_t> longest_name(JointLanguage language) {
  if (language == JointLanguage::krl) return 24;
  if (language == JointLanguage::rapid) return 32;
  return std::nullopt;
}

/// Words that are no names: keywords that a file may well be called, in capitals.
std::span<const std::string_view> reserved(JointLanguage language) {
  static constexpr std::array<std::string_view, 22> krl = {
      "AXIS", "BOOL", "CASE", "CHAR", "CIRC", "CONST", "DECL", "DEF",  "DEFDAT", "ELSE",   "END",
      "FOR",  "GOTO", "HALT", "LIN",  "LOOP", "POS",   "PTP",  "REAL", "REPEAT", "SWITCH", "WHILE"};
  static constexpr std::array<std::string_view, 20> rapid = {
      "ALIAS",  "CASE", "CONNECT", "DEFAULT", "ELSE",   "ERROR", "EXIT", "FUNC", "LOCAL", "MAIN",
      "MODULE", "PROC", "RAISE",   "RECORD",  "RETURN", "STEP",  "TEST", "TRAP", "UNDO",  "WITH"};
  static constexpr std::array<std::string_view, 16> urscript = {
      "BREAK", "CONTINUE", "DEF",    "ELSE", "END", "GLOBAL", "HALT",   "JOIN",
      "KILL",  "LOCAL",    "RETURN", "RUN",  "SEC", "SYNC",   "THREAD", "WHILE"};
  if (language == JointLanguage::krl) return krl;
  if (language == JointLanguage::rapid) return rapid;
  if (language == JointLanguage::urscript) return urscript;
  return {};
}

/// A name that all controllers take: letters, digits and underscores, a letter first. A longer one than the controller
/// takes is not cut off: two programs would be one to it.
std::string name_of(const std::filesystem::path& path, JointLanguage language) {
  std::string name;
  for (const char letter : path.stem().string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0;
    name += plain ? letter : '_';
  }
  if (name.empty() || std::isalpha(static_cast<unsigned char>(name.front())) == 0) name = 'p' + name;
  const std::optional<std::size_t> longest = longest_name(language);
  if (longest && name.size() > *longest) {
    throw InvalidInput(path.string(),
                       fmt::format("names its program {}, {} characters; {} takes at most {}", name, name.size(),
                                   language == JointLanguage::krl ? "KRL" : "RAPID", *longest),
                       "Give the file a shorter name");
  }
  std::string capitals = name;
  for (char& letter : capitals) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  if (std::ranges::count(reserved(language), capitals) > 0) {
    throw InvalidInput(path.string(), fmt::format("names its program {}, a word of the controller's language", name),
                       "Give the file another name");
  }
  return name;
}

std::string one_line(std::string text) {
  for (char& letter : text) {
    if (std::iscntrl(static_cast<unsigned char>(letter)) != 0) letter = ' ';
  }
  return text;
}

std::unique_ptr<JointDialect> dialect_of(JointLanguage language, const std::string& name, const EndEffector& end,
                                         double period_s) {
  switch (language) {
    case JointLanguage::krl:
      return krl_dialect(name, end);
    case JointLanguage::rapid:
      return rapid_dialect(name, end);
    case JointLanguage::urscript:
      return urscript_dialect(name, end, period_s);
    case JointLanguage::servoj:
      break;
  }
  return servoj_dialect(period_s);
}

/// KUKA and Universal Robots count their outputs, ABB names them.
void require_outputs(const TrajectoryInfo& info, JointLanguage language) {
  if (language == JointLanguage::servoj) return;
  const bool named = language == JointLanguage::rapid;
  const auto require = [&](const char* key, const DigitalOutput& output) {
    if (!output.given() || named != output.number.has_value()) return;
    InvalidInput::Parts parts;
    parts.field = key;
    parts.where = info.cell;
    parts.rule = named ? "must be a signal's name for ABB, in quotes"
                       : "must be an output's number for KUKA and Universal Robots";
    throw InvalidInput(std::move(parts));
  };
  require("spindle.output", info.end_effector.spindle);
  require("spindle.coolant_output", info.end_effector.coolant);
}

/// Whose controllers run the language, and the endings of what they run.
struct Controller {
  const char* maker;
  const char* endings;
};
constexpr Controller controllers[] = {
    {maker_kuka, ".src"}, {maker_abb, ".mod"}, {maker_universal_robots, ".script or .servoj"}};

const Controller& controller_of(JointLanguage language) {
  if (language == JointLanguage::krl) return controllers[0];
  return language == JointLanguage::rapid ? controllers[1] : controllers[2];
}

/// An arm's joints mean nothing to another maker's controller.
void require_maker(const std::filesystem::path& path, const TrajectoryInfo& info, JointLanguage language) {
  const Controller& wanted = controller_of(language);
  if (info.maker.empty() || info.maker == wanted.maker) return;
  const auto* own = std::ranges::find_if(controllers, [&](const Controller& c) { return info.maker == c.maker; });
  throw InvalidInput(path.string(),
                     fmt::format("is a program for {}'s controllers; the arm of {} is of {}", wanted.maker,
                                 info.cell.empty() ? "the cell" : info.cell, info.maker),
                     own != std::end(controllers)
                         ? fmt::format("Write {}, or the trajectory as .csv", own->endings)
                         : "No program is written for that controller; write the trajectory as .csv or .h5");
}

/// Samples from point to point.
std::size_t stride_of(const TrajectoryInfo& info, JointLanguage language) {
  const bool servo = language == JointLanguage::urscript || language == JointLanguage::servoj;
  const double usual = servo ? servoj_period_s : usual_period_s;
  const double wished = info.program_period_s > 0.0 ? info.program_period_s : usual;
  if (!(wished <= 10.0)) throw InvalidInput("program_period_s", wished, "s", "must be at most 10 s");
  const double ratio = wished / info.sample_period_s;
  const double whole = std::max(1.0, std::round(ratio));
  if (info.program_period_s > 0.0 && std::abs(ratio - whole) > 1e-6 * whole) {
    throw InvalidInput("program_period_s", wished, "s", "must be a multiple of the sample period");
  }
  return static_cast<std::size_t>(whole);
}

/// A length or an angle, rounded up to six decimals: never reported smaller than it is.
double up(double value, double unit) {
  return std::ceil(value / unit * 1e6) / 1e6;
}

/// What the controller makes of the program, for its header.
std::vector<std::string> reported(const std::optional<ProgramRun>& run, double period_s) {
  if (!run) {
    return {fmt::format("a point every {:.6g} ms; what the controller makes of them was not checked",
                        period_s / units::ms)};
  }
  std::vector<std::string> lines;
  const double shortest = run->shortest_step_s / units::ms, longest = run->longest_step_s / units::ms;
  if (run->shortest_step_s == run->longest_step_s) {
    lines.push_back(fmt::format("{} points, one every {:.6g} ms", run->points, longest));
  } else {
    lines.push_back(fmt::format("{} points, {:.6g} to {:.6g} ms apart", run->points, shortest, longest));
  }
  lines.push_back(
      fmt::format("joints interpolated between them leave the trajectory by {:.6f} degrees a joint, {:.6f} mm at the "
                  "tip, {:.6f} degrees of the tool's axis",
                  up(run->distances.joint_deviation_rad, units::deg), up(run->distances.tip_deviation_m, units::mm),
                  up(run->distances.axis_deviation_rad, units::deg)));
  lines.push_back(
      fmt::format("and the program by {:.6f} mm and {:.6f} degrees; tolerances {:.6g} mm and {:.6g} degrees{}",
                  up(run->distances.tip_error_m, units::mm), up(run->distances.axis_error_rad, units::deg),
                  run->tip_tolerance_m / units::mm, run->axis_tolerance_rad / units::deg,
                  run->keeps_tolerances() ? "" : ": BEYOND THE TOLERANCE"));
  return lines;
}

/// What the program commands beside motion.
struct Operation {
  Outputs outputs = {};
  std::vector<double> speeds_rad_per_s = {};  // ProgramRun::spindle_speeds_rad_per_s
  std::vector<std::string> reported = {};
};

bool turns(program::Spindle spindle) {
  return spindle == program::Spindle::clockwise || spindle == program::Spindle::counterclockwise;
}

bool runs(const program::Coolant& coolant) {
  return coolant != program::Coolant{};
}

/// "M3, 8000 rpm"
std::string spindle_text(const program::Block& block) {
  if (!turns(block.spindle)) return "spindle off (M5)";
  return fmt::format("spindle {}, {:.6g} rpm", block.spindle == program::Spindle::clockwise ? "M3" : "M4",
                     block.spindle_speed_rad_per_s / units::rpm);
}

std::string coolant_text(const program::Coolant& coolant) {
  if (!runs(coolant)) return "coolant off (M9)";
  return fmt::format("coolant on ({})", coolant.flood ? "M8" : (coolant.mist ? "M7" : "M88"));
}

/// What the program commands beside motion. A spindle that it starts runs from before the first move to after the last
/// one, as does coolant; what would change that on the way is reported and not carried out.
Operation operation_of(program::Source& program) {
  Operation out;
  std::size_t others = 0;
  const auto leave_out = [&](std::size_t line, const std::string& what) {
    if (++others <= listed) out.reported.push_back(fmt::format("NOT CARRIED OUT: before line {}, {}", line, what));
  };
  program.rewind();
  program::Block last;
  for (program::Block block; program.next(block); last = block) {
    const bool spindle_changes =
        block.spindle != last.spindle ||
        (turns(block.spindle) && block.spindle_speed_rad_per_s != last.spindle_speed_rad_per_s);
    if (turns(block.spindle) && std::ranges::count(out.speeds_rad_per_s, block.spindle_speed_rad_per_s) == 0) {
      out.speeds_rad_per_s.push_back(block.spindle_speed_rad_per_s);
    }
    if (!out.outputs.spindle && turns(block.spindle)) {
      out.outputs.spindle = true;
      out.reported.push_back(
          fmt::format("{}, before line {}: on before the first move, off after the last; set speed and direction at "
                      "its drive",
                      spindle_text(block), block.line));
    } else if (out.outputs.spindle && spindle_changes) {
      leave_out(block.line, spindle_text(block));
    }
    if (!out.outputs.coolant && runs(block.coolant)) {
      out.outputs.coolant = true;
      out.reported.push_back(fmt::format("{}, before line {}: on before the first move, off after the last",
                                         coolant_text(block.coolant), block.line));
    } else if (out.outputs.coolant && block.coolant != last.coolant) {
      leave_out(block.line, coolant_text(block.coolant));
    }
    if (block.operator_stop == program::OperatorStop::always) leave_out(block.line, "stop for the operator (M0)");
    if (block.operator_stop == program::OperatorStop::optional) leave_out(block.line, "optional stop (M1)");
  }
  if (others > listed) out.reported.push_back(fmt::format("NOT CARRIED OUT: {} more such codes", others - listed));
  if (!out.outputs.spindle) out.reported.emplace_back("NOT SET: the program starts no spindle (no M3 or M4).");
  return out;
}

class JointProgram final : public SampleFile {
 public:
  JointProgram(const std::filesystem::path& path, const TrajectoryInfo& info, JointLanguage language)
      : info_(info),
        stride_(stride_of(info, language)),
        dialect_(dialect_of(language, name_of(path, language), info.end_effector, period_s(stride_))),
        text_(path),
        samples_(path) {}

  void restart() override { samples_.clear(); }

  void add(std::span<const Sample> samples) override {
    for (const Sample& sample : samples) samples_.add(sample);
  }

  std::optional<ProgramRun> verify(program::Source& program, const robot::Kinematics& machine,
                                   const SmoothingOptions& options, bool refine, const Progress& progress) override {
    const auto follow = [&](std::vector<bool>& beyond) {
      RunDistances worst;
      for (const Joining joining : dialect_->joinings()) {
        worst.include(follow_points(points_, joining, samples_, program, machine, options, beyond, progress));
      }
      return worst;
    };
    operation_ = operation_of(program);
    place_points(stride_);
    ProgramRun run{.tip_tolerance_m = options.tip_tolerance_m, .axis_tolerance_rad = options.axis_tolerance_rad};
    for (;;) {
      std::vector<bool> beyond(points_.steps());
      run.distances = follow(beyond);
      if (run.keeps_tolerances() || !refine || dialect_->fixed_cycle() || !split(beyond)) break;
    }
    for (std::size_t stride = stride_; refine && dialect_->fixed_cycle() && !run.keeps_tolerances() && stride > 1;) {
      stride /= 2;
      place_points(stride);
      std::vector<bool> beyond(points_.steps());
      ProgramRun nearer = run;
      nearer.distances = follow(beyond);
      if (!nearer.keeps_tolerances()) continue;
      run.would_hold_s = period_s(stride);
      break;
    }
    if (dialect_->fixed_cycle()) place_points(stride_);
    measure_steps(run);
    run.spindle_speeds_rad_per_s = operation_.speeds_rad_per_s;
    run_ = run;
    return run;
  }

  void state_collisions(const std::string& found) override { collisions_ = found; }

  io::PendingFile& finish() override {
    if (points_.at.empty()) place_points(stride_);
    write_header();
    write_points();
    return text_.finish();
  }

 private:
  [[nodiscard]] double period_s(std::size_t samples) const {
    return static_cast<double>(samples) * info_.sample_period_s;
  }

  /// A point each so many samples, and the last sample.
  void place_points(std::size_t stride) {
    if (samples_.size() == 0) throw InvalidInput("samples", "must hold at least one");
    points_.held = dialect_->held();
    points_.at.clear();
    for (std::size_t sample = 0; sample + 1 < samples_.size(); sample += stride) points_.at.push_back(sample);
    points_.at.push_back(samples_.size() - 1);
    find_rests();
  }

  /// Another point in the middle of each of these steps. @return false where none has room for one
  bool split(const std::vector<bool>& steps) {
    std::vector<std::size_t> more;
    for (std::size_t i = 0; i < points_.steps(); ++i) {
      more.push_back(points_.at[i]);
      const std::size_t length = points_.at[i + 1] - points_.at[i];
      if (steps[i] && length > 1) more.push_back(points_.at[i] + length / 2);
    }
    more.push_back(points_.at.back());
    if (more.size() == points_.at.size()) return false;
    points_.at = std::move(more);
    find_rests();
    return true;
  }

  void find_rests() {
    points_.still.assign(points_.steps(), true);
    for (std::size_t i = 0; i < points_.steps(); ++i) {
      const robot::Position6 from = samples_.row(points_.at[i]).position();
      for (std::size_t sample = points_.at[i] + 1; sample <= points_.at[i + 1] && points_.still[i]; ++sample) {
        if ((samples_.row(sample).position() - from).cwiseAbs().maxCoeff() >= standing) points_.still[i] = false;
      }
    }
  }

  void measure_steps(ProgramRun& run) const {
    run.points = points_.at.size();
    run.fixed_cycle = dialect_->fixed_cycle();
    run.most_points = dialect_->most_points();
    std::size_t shortest = points_.steps() > 1 ? stride_ : points_.at.back(), longest = 0;
    for (std::size_t i = 0; i < points_.steps(); ++i) {
      const std::size_t length = points_.at[i + 1] - points_.at[i];
      if (i + 1 < points_.steps()) shortest = std::min(shortest, length);  // the last one ends with the program
      longest = std::max(longest, length);
    }
    run.shortest_step_s = period_s(shortest);
    run.longest_step_s = period_s(longest);
  }

  void comment(const std::string& line) { io::append(text_.buffer(), "{}{}\n", dialect_->comment(), line); }

  void write_header() {
    dialect_->open(text_.buffer());
    for (const std::string& line : dialect_->not_set(operation_.outputs)) comment(line);
    for (const std::string& line : operation_.reported) comment(line);
    comment(fmt::format("cell {}, program {}", one_line(info_.cell), one_line(info_.program)));
    comment(fmt::format("tool (tip in the flange frame): {}", dialect_->pose(info_.end_effector.tip)));
    comment(load_text());
    comment(fmt::format("base (the program's frame in the robot's base frame): {}", dialect_->pose(info_.workpiece)));
    comment("These joints were computed with tool and base: compare them with the pendant's before the first run.");
    comment("collisions: " + one_line(collisions_));
    comment(fmt::format("duration {:.6f} s", period_s(points_.at.back())));
    for (const std::string& line : reported(run_, period_s(stride_))) comment(line);
    std::string advice = dialect_->advice();
    for (std::size_t from = 0; from < advice.size();) {
      const std::size_t to = std::min(advice.find('\n', from), advice.size());
      comment(advice.substr(from, to - from));
      from = to + 1;
    }
  }

  [[nodiscard]] std::string load_text() const {
    const EndEffector& end = info_.end_effector;
    if (!end.mass_kg) return "load: not given by the cell (tool.mass_kg)";
    const Eigen::Vector3d center_mm = end.center() / units::mm + Eigen::Vector3d::Zero();
    return fmt::format("load: {:.6g} kg, centre of mass in the flange frame X {:.3f} Y {:.3f} Z {:.3f} mm{}",
                       *end.mass_kg, center_mm.x(), center_mm.y(), center_mm.z(),
                       end.center_m ? "" : ", assumed half-way to the tip");
  }

  /// Steps in which the robot stands still become a wait.
  void write_points() {
    fmt::memory_buffer& out = text_.buffer();
    const auto joints = [&](std::size_t point) { return samples_.row(points_.at[point]).position(); };
    dialect_->start(out, joints(0), operation_.outputs);
    bool moved = false;     // to the point that is not written yet
    double step_s = 0.0;    // … in this time
    double waited_s = 0.0;  // at it
    const auto write = [&](std::size_t point, bool rests) {
      if (moved) dialect_->point(out, joints(point), step_s, rests);
      text_.drain();
    };
    for (std::size_t i = 0; i < points_.steps(); ++i) {
      const bool still = points_.still[i];
      write(i, still);
      step_s = period_s(points_.at[i + 1] - points_.at[i]);
      if (still) {
        waited_s += step_s;
      } else if (waited_s > 0.0) {
        dialect_->wait(out, joints(i), std::exchange(waited_s, 0.0));
      }
      moved = !still;
    }
    write(points_.steps(), true);
    if (waited_s > 0.0) dialect_->wait(out, joints(points_.steps()), waited_s);
    dialect_->close(out, operation_.outputs);
  }

  TrajectoryInfo info_;
  std::size_t stride_;
  std::unique_ptr<JointDialect> dialect_;
  PendingText text_;
  SampleSpool samples_;
  JointPoints points_;
  Operation operation_;
  std::string collisions_ = unchecked_collisions;
  std::optional<ProgramRun> run_;
};

}  // namespace

std::unique_ptr<SampleFile> open_joint_program(const std::filesystem::path& path, const TrajectoryInfo& info,
                                               JointLanguage language) {
  if (info.joints != 6 || std::ranges::count(info.prismatic, true) > 0) {
    throw InvalidInput(path.string(), "is a program of an arm with six revolute joints; this machine is none",
                       "Write .csv or .h5");
  }
  require_maker(path, info, language);
  require_outputs(info, language);
  return std::make_unique<JointProgram>(path, info, language);
}

}  // namespace robomill::path
