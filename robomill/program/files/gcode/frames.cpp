// Where a program's positions lie in W: work frames, offsets, and the machine's own positions.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/reader.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr std::array<const char*, 3> axis_names = {"X", "Y", "Z"};
Eigen::Index axis_of(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

std::string code_text(const GcodeWords::Word& word) {
  return fmt::format("G{:g}", word.number);
}

/// A frame's code; G54 where no line says one.
std::string frame_code(const std::string& said) {
  return said.empty() ? "G54" : said;
}

}  // namespace

const char* GcodeReader::unknown_axis() const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (!known_[i]) return axis_names[i];
  }
  return nullptr;
}

// G54 P3 is G54.1 P3 where no other code takes the P.
bool GcodeReader::is_frame_number(const Line& line) const {
  const bool other = line.dwells || line.call || line.special != Special::none || line.cycle ||
                     (line.groups & static_cast<std::uint32_t>(GcodeGroup::path)) != 0;
  return line.p && !other && motion_ != Motion::clockwise && motion_ != Motion::counterclockwise;
}

void GcodeReader::choose_system(const Line& line) {
  const GcodeWords::Word& word = *line.system;
  const int code = static_cast<int>(std::round(10.0 * word.number));
  std::string said = code_text(word);
  const bool numbered = code == 541 || code == 1540 || (code == first_work_frame && is_frame_number(line));
  const double number = line.p ? line.p->number : 0.0;
  const std::optional<int> frame = work_frame_number(code, numbered ? std::optional(number) : std::nullopt);
  if (!frame && numbered) {
    reject("P", number, "", fmt::format("must be a whole number from 1 to 300: it names the work frame of {}", said));
  }
  if (!frame) reject("G", word.number, "", "is no G code");
  if (numbered) said += fmt::format(" P{:g}", number);
  system_ = {.value = *frame, .line = line_, .code = std::move(said)};
}

std::optional<Vector3d> GcodeReader::offsets_m() const {
  const auto table = tables_m_.find(system_.value);
  if (table == tables_m_.end()) return std::nullopt;
  return table->second;
}

void GcodeReader::choose_base() {
  base_ = system_;
  base_table_m_ = offsets_m();
  if (!passed_system_ || passed_system_->value == system_.value) return;
  if (base_table_m_ && passed_table_m_) {
    base_ = passed_system_;
    base_table_m_ = passed_table_m_;
    return;
  }
  remarks_.assume({.what = "The program's frame",
                   .taken = fmt::format("{}, in which {} begins; the tools before it begin in {}",
                                        frame_code(system_.code), tools_.now().name, frame_code(passed_system_->code)),
                   .key = "workpiece.origin_mm of that frame"});
}

std::optional<Vector3d> GcodeReader::origin_m() const {
  if (shift_lost_.value) return std::nullopt;
  const Vector3d offset_m = local_m_ + shift_m_;
  if (!base_) return offset_m;
  const std::optional<Vector3d> table = offsets_m();
  // In W itself the difference is 0 to the last bit, whatever its offsets are.
  if (base_table_m_ && table) return Vector3d(offset_m + (*table - *base_table_m_));
  if (system_.value != base_->value || base_moved_line_ > 0) return std::nullopt;
  return offset_m;
}

void GcodeReader::set_local(const Line& line) {
  special_ = true;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.position[i]) continue;
    local_m_[axis_of(i)] = *line.position[i] * unit_m();
    check_coordinate(axis_names[i], local_m_[axis_of(i)], *line.position[i], unit_name());
  }
}

// The tool stays where it is, and its position has other numbers from here on.
void GcodeReader::shift(const Line& line) {
  special_ = true;
  if (line.has('s')) {
    reject("S", std::nullopt, "", "stands on a line with G92: on a lathe it would limit the spindle's speed",
           "Write a line of its own for S");
  }
  if (!base_) choose_base();
  const std::optional<Vector3d> origin = origin_m();
  Pose& at = pending_ ? *pending_ : pose_;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.position[i] || !origin) continue;
    const double there_m = *line.position[i] * unit_m() + (*origin)[axis_of(i)];
    check_coordinate(axis_names[i], there_m, *line.position[i], unit_name());
    if (known_[i]) {
      shift_m_[axis_of(i)] += at.tip_m[axis_of(i)] - there_m;
      if (!(std::abs(shift_m_[axis_of(i)]) <= farthest_m)) {
        reject(axis_names[i], *line.position[i], unit_name(), "moves the program's frame by more than 1 km");
      }
    } else if (!start_ && !lost_.value) {
      at.tip_m[axis_of(i)] = there_m;
      known_[i] = true;
      shift_declared_ = true;
    } else {
      shift_lost_ = {.value = true, .line = line_, .code = "G92"};
    }
  }
  if (!start_ && unknown_axis() == nullptr) begin_at(pose_);
}

void GcodeReader::reset_shift(const Line& line) {
  special_ = true;
  shift_m_.setZero();
  if (shift_declared_) shift_lost_ = {.value = true, .line = line_, .code = code_text(*line.special_code)};
}

void GcodeReader::set_table(const Line& line) {
  special_ = true;
  const double kind = line.l ? line.l->number : 0.0;
  const double number = line.p ? line.p->number : 0.0;
  const bool tool = kind == 1.0 || (kind >= 10.0 && kind <= 13.0);
  if (tool && !cutting_) {
    skip(fmt::format("G10 L{:g} P{:g}", kind, number));
    return;
  }
  if (kind != 2.0) {
    reject("L", kind, "",
           tool          ? "changes a tool's length after moves at feed"
           : kind == 20. ? "sets an extended work frame (Fanuc, Haas) or moves one to where the tool is (LinuxCNC)"
                         : "is not read with G10: it may move the program's frame",
           "Work frames are given by G10 L2 P1 X Y Z, or by program.frames in the cell");
  }
  const std::optional<int> frame = work_frame_of_table(number);
  if (!frame) reject("P", number, "", "must be a whole number from 1 to 9: G10 L2 P1 gives G54, P6 G59, P9 G59.3");
  const bool turned = line.rotary[0].value_or(0.0) != 0.0 || line.rotary[1].value_or(0.0) != 0.0 ||
                      line.rotary[2].value_or(0.0) != 0.0 || line.radius.value_or(0.0) != 0.0;
  if (turned) reject("G", 10.0, "", "turns a work frame, which is not read");
  const auto found = tables_m_.find(*frame);
  Vector3d table_m = found == tables_m_.end() ? Vector3d::Zero().eval() : found->second;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.position[i] && found == tables_m_.end()) {
      reject(axis_names[i], std::nullopt, "", "is missing: G10 L2 gives a work frame by X, Y and Z");
    }
    if (!line.position[i]) continue;
    if (incremental_) reject("G", 10.0, "", "changes a work frame by a step (G91), which is not read", "Write G90");
    table_m[axis_of(i)] = *line.position[i] * unit_m();
    check_coordinate(axis_names[i], table_m[axis_of(i)], *line.position[i], unit_name());
  }
  constexpr double same_m = 1e-9;  // as inches round
  if (given_tables_.contains(*frame) && (table_m - found->second).norm() > same_m) {
    given_tables_.erase(*frame);
    remarks_.assume({.what = fmt::format("Offsets of G{:g}", 0.1 * *frame),
                     .taken = fmt::format("those of the program's G10 L2 from line {} on; the cell has others", line_),
                     .key = "program.frames"});
  }
  tables_m_[*frame] = table_m;
  if (base_ && base_->value == *frame && !base_table_m_) base_moved_line_ = line_;
}

void GcodeReader::lose(std::size_t axis, const std::string& code) {
  if (start_ && !pending_) pending_ = pose_;
  lose_machine_axis(axis);
  lost_ = {.value = true, .line = line_, .code = code};
}

void GcodeReader::go_home(const Line& line) {
  special_ = true;
  const std::string code = code_text(*line.special_code);
  const bool named = line.position[0] || line.position[1] || line.position[2];
  const bool turns = line.rotary[0] || line.rotary[1] || line.rotary[2];
  std::string said = code;
  // By the point that the line names: a step of nothing in what posts write.
  const std::optional<Vector3d> origin = origin_m();
  Pose point = pose_;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.position[i]) continue;
    said += fmt::format(" {}{:g}", axis_names[i], *line.position[i]);
    const Eigen::Index axis = axis_of(i);
    if (tilted_ && !(incremental_ && *line.position[i] == 0.0)) {
      reject(axis_names[i], *line.position[i], unit_name(),
             fmt::format("is a point on the way of {} while {} (line {}) is on, which is not read", code, tilted_->code,
                         tilted_->line),
             fmt::format("Write G91 {} Z0", code));
    }
    if (origin && !tilted_)
      point.tip_m[axis] = *line.position[i] * unit_m() + (incremental_ ? pose_.tip_m : *origin)[axis];
    check_coordinate(axis_names[i], point.tip_m[axis], *line.position[i], unit_name());
  }
  skip(said);
  const bool known = start_ && !pending_ && !is_over();
  if (known && !setup_change(line) && moves_to(point)) move(Block::Kind::rapid, point, 0.0);
  for (std::size_t i = 0; i < 3; ++i) {
    if (line.position[i] || (!named && !turns)) lose(i, code);
    if (line.rotary[i] || (!named && !turns)) lost_rotary_[i] = true;
  }
}

void GcodeReader::go_to_machine(const Line& line) {
  special_ = true;
  std::string said = "G53";
  for (std::size_t i = 0; i < 3; ++i) {
    if (line.position[i]) {
      said += fmt::format(" {}{:g}", axis_names[i], *line.position[i]);
      lose(i, "G53");
    }
    if (line.rotary[i]) lost_rotary_[i] = true;
  }
  skip(said);
}

GcodeReader::Change GcodeReader::frame_change() const {
  if (shift_lost_.value) {
    return {.line = shift_lost_.line,
            .code = shift_lost_.code,
            .what = "moves the program's frame by a position that is not known here",
            .hint = "Let the CAM system write positions in one work frame"};
  }
  const Said<int>& base = base_.value();
  std::vector<std::string> missing;
  bool extended = false;
  const auto add = [&](const Said<int>& frame) {
    missing.push_back(frame_code(frame.code));
    extended = extended || is_extended_frame(frame.value);
  };
  if (!base_table_m_) add(base);
  if (system_.value != base.value && !offsets_m()) add(system_);
  const std::string line = base.line > 0 ? fmt::format(" (line {})", base.line) : "";
  Change out = {.line = system_.line, .code = system_.code};
  if (system_.value == base.value) {
    out.line = base_moved_line_;
    out.code = "G10";
    out.what = fmt::format("moves {}{} after positions in it; its offsets before are not known", missing[0], line);
  } else {
    out.what = fmt::format("is another work frame than {}{} of the positions before; the offsets of {} are not known",
                           frame_code(base.code), line, fmt::join(missing, " and "));
  }
  out.hint = fmt::format(
      "Give them as the control's table has them, in the cell: [[program.frames]] code = \"{}\", "
      "origin_mm = [x, y, z]{}{}",
      missing[0], missing.size() > 1 ? fmt::format(", and the same for \"{}\"", missing[1]) : "",
      extended ? "" : "; or by G10 L2 P X Y Z before the first position");
  return out;
}

bool GcodeReader::is_elsewhere(const Line& line) {
  std::optional<Change> change = setup_change(line);
  const bool of_length = change && !center_point_lost(line);
  if (!change && !origin_m()) change = frame_change();
  if (!change) return false;
  if (motion_ != Motion::rapid) {
    if (change->other_tool) {
      second_tool_ = std::move(change);
      second_tool_line_ = line_;
      return true;
    }
    reject_change(*change);
  }
  // A machine may add the length of the tool, or another frame: only where that comes back positions are known again.
  for (std::size_t i = 0; i < 3; ++i) {
    const bool loses = of_length ? i == 2 : line.position[i].has_value();
    if (loses || tilted_) lose(i, change->code);
  }
  if (of_length && pending_ && !tilted_) {
    for (std::size_t i = 0; i < 2; ++i) {
      const auto axis = axis_of(i);
      const std::optional<Vector3d> origin = origin_m();
      if (!line.position[i] || !origin) continue;
      if (incremental_) {
        lose(i, change->code);
      } else {
        pending_->tip_m[axis] = *line.position[i] * unit_m() + (*origin)[axis];
        known_[i] = true;
      }
    }
  }
  special_ = true;
  remarks_.count(ProgramRemarks::Count::lost_rapid, line_);
  return true;
}

void GcodeReader::reject_change(const Change& change) const {
  throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file_, change.line),
                                         .field = change.code,
                                         .rule = fmt::format("{}, and line {} cuts", change.what, line_),
                                         .hint = change.hint});
}

void GcodeReader::come_back(const Pose& end) {
  special_ = true;
  pending_.reset();
  lost_ = {};
  begin_return(end, std::max({highest_m_, pose_.tip_m.z(), end.tip_m.z()}));
}

}  // namespace robomill::program
