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
constexpr int extended = 100'000;

Eigen::Index axis_of(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

std::string code_text(const GcodeWords::Word& word) {
  return fmt::format("G{:g}", word.number);
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
  int id = code;
  if (code >= 1100 && code <= 1290) {
    if (code % 10 != 0) reject("G", word.number, "", "is no G code");
    id = extended + code / 10 - 109;  // Haas: G110 is G154 P1
  } else if (code == 541 || code == 1540 || (code == 540 && is_frame_number(line))) {
    constexpr double most = 300.0;
    const double number = line.p ? line.p->number : 0.0;
    if (!(number >= 1.0 && number <= most && number == std::round(number))) {
      reject("P", number, "", fmt::format("must be a whole number from 1 to 300: it names the work frame of {}", said));
    }
    id = extended + static_cast<int>(number);
    said += fmt::format(" P{:g}", number);
  } else if (code <= 590 && code % 10 != 0) {
    reject("G", word.number, "", "is no G code");
  }
  system_ = {.value = id, .line = line_, .code = std::move(said)};
}

void GcodeReader::note_other_base() const {
  if (!passed_system_ || passed_system_->value == system_.value) return;
  const auto name = [](const Said<int>& system) { return system.code.empty() ? std::string("G54") : system.code; };
  remarks_.assume({.what = "The program's frame",
                   .taken = fmt::format("{}, in which {} begins; the tools before it begin in {}", name(system_),
                                        tools_.now().name, name(*passed_system_)),
                   .key = "workpiece.origin_mm of that frame"});
}

std::optional<Vector3d> GcodeReader::origin_m() const {
  if (shift_lost_.value) return std::nullopt;
  const Vector3d offset_m = local_m_ + shift_m_;
  if (!base_) return offset_m;
  const auto table = tables_m_.find(system_.value);
  if (base_table_m_ && table != tables_m_.end()) return Vector3d(offset_m + table->second - *base_table_m_);
  if (system_.value != base_->value || base_table_m_ || table != tables_m_.end()) return std::nullopt;
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
  if (!base_) base_ = system_;
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
           "Work frames are given by G10 L2 P1 X Y Z");
  }
  if (!(number >= 1.0 && number <= 9.0 && number == std::round(number))) {
    reject("P", number, "", "must be a whole number from 1 to 9: G10 L2 P1 gives G54, P6 G59, P9 G59.3");
  }
  const bool turned = line.rotary[0].value_or(0.0) != 0.0 || line.rotary[1].value_or(0.0) != 0.0 ||
                      line.rotary[2].value_or(0.0) != 0.0 || line.radius.value_or(0.0) != 0.0;
  if (turned) reject("G", 10.0, "", "turns a work frame, which is not read");
  const int frame = static_cast<int>(number);
  constexpr int of_g59 = 6;
  const int id = frame <= of_g59 ? first_system + 10 * (frame - 1) : 590 + frame - of_g59;
  const auto found = tables_m_.find(id);
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
  tables_m_[id] = table_m;
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
  const bool known = start_ && !pending_ && tools_.between() == nullptr;
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

bool GcodeReader::is_elsewhere(const Line& line) {
  std::optional<Change> change = setup_change(line);
  const bool of_length = change && !center_point_lost(line);
  if (!change && !origin_m()) {
    const Said<int> base = base_.value_or(system_);
    change =
        Change{.line = system_.line,
               .code = system_.code,
               .what = fmt::format("is another work frame than {} of the positions before{}; where the one lies in "
                                   "the other is not known here",
                                   base.code.empty() ? "that" : base.code,
                                   base.line > 0 ? fmt::format(" (line {})", base.line) : ""),
               .hint = "Write a program for each frame, or give both by G10 L2 P X Y Z before the first position"};
    if (shift_lost_.value) {
      change->line = shift_lost_.line;
      change->code = shift_lost_.code;
      change->what = "moves the program's frame by a position that is not known here";
      change->hint = "Let the CAM system write positions in one work frame";
    }
  }
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
  static_cast<void>(turn_to(end.axis));
  const double height_m = std::max({highest_m_, pose_.tip_m.z(), end.tip_m.z()});
  const auto lifted = [&](const Vector3d& tip_m) { return Vector3d(tip_m.x(), tip_m.y(), height_m); };
  steps_.clear();
  steps_.push_back({.tip_m = lifted(pose_.tip_m)});
  steps_.push_back({.tip_m = lifted(end.tip_m), .axis = end.axis});
  steps_.push_back({.tip_m = end.tip_m});
  begin_steps();
}

}  // namespace robomill::program
