// What a program in G-code says to its machine: M codes, lengths, the tool centre point, rotary axes.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"
#include "robomill/program/files/gcode/reader.hpp"

namespace robomill::program {
namespace {

/// What a code does and where: "calls a subprogram (LinuxCNC, Fanuc and Haas)".
std::string meaning_of(const Mcode& code) {
  struct Meaning {
    std::string_view control, text;
  };
  const std::array<Meaning, 3> meanings = {
      {{"LinuxCNC", code.linuxcnc}, {"Fanuc and Haas", code.fanuc_haas}, {"Heidenhain", code.heidenhain}}};
  std::string out;
  for (std::size_t i = 0; i < meanings.size(); ++i) {
    if (meanings[i].text.empty()) continue;
    const bool again = i > 0 && meanings[i].text == meanings[i - 1].text;
    if (again) {
      out.back() = ',';
      out += fmt::format(" {})", meanings[i].control);
    } else {
      out += fmt::format("{}{} ({})", out.empty() ? "" : ", ", meanings[i].text, meanings[i].control);
    }
  }
  return out;
}

bool has_axis(Machine machine, std::size_t rotary) {
  return rotary == 2 || static_cast<Eigen::Index>(rotary) == tilt_index(machine);
}

}  // namespace

void GcodeReader::take_m(const GcodeWords::Word& word, Line& line) {
  constexpr double above_all = 1000.0;
  const bool whole = word.number >= 0.0 && word.number < above_all && word.number == std::round(word.number);
  const Mcode* const code = whole ? find_mcode(static_cast<int>(word.number)) : nullptr;
  if (code == nullptr) {
    const bool users = word.number >= 100.0 && word.number < 200.0;
    reject("M", word.number, "", "is not known to be harmless",
           users ? "In LinuxCNC it is the user's own code. Take it out if it moves nothing"
                 : "Take it out if it moves nothing");
  }
  switch (code->act) {
    case McodeAct::rejected:
      if (calls_allowed_ && (code->code == 97 || code->code == 98)) {
        line.call = word;
        return;
      }
      reject("M", word.number, "", fmt::format("is not carried out here: {}", meaning_of(*code)),
             "Let the CAM system write the program without it");
    case McodeAct::nothing:
      break;
    case McodeAct::end:
      line.begins_again = code->code == 99;
      returns_ = line.begins_again && depth_ > 0;
      if (returns_) return;
      ended_ = true;
      if (!line.begins_again) return;
      break;
    case McodeAct::stop:
      line.stop = OperatorStop::always;
      return;
    case McodeAct::optional_stop:
      line.stop = OperatorStop::optional;
      return;
    case McodeAct::spindle_clockwise:
      spindle_ = Spindle::clockwise;
      return;
    case McodeAct::spindle_counterclockwise:
      spindle_ = Spindle::counterclockwise;
      return;
    case McodeAct::spindle_off:
      spindle_after_ = Spindle::off;
      return;
    case McodeAct::mist:
      coolant_.mist = true;
      return;
    case McodeAct::flood:
      coolant_.flood = true;
      return;
    case McodeAct::through_tool:
      coolant_.through_tool = true;
      return;
    case McodeAct::coolant_off:
      coolant_after_ = Coolant{};
      return;
    case McodeAct::through_tool_off:
      coolant_after_ = Coolant{.mist = coolant_.mist, .flood = coolant_.flood};
      return;
    case McodeAct::tool_change:
      line.tool_change = true;
      break;
    case McodeAct::tcp_on:
    case McodeAct::tcp_off:
      line.center_point = word;
      return;
  }
  line.leave_out(word);
}

// The order of a line's words does not count.
void GcodeReader::set_up(const Line& line) {
  if (line.begins_again && line.has('p')) {
    reject("M", 99.0, "", "jumps to another line", "Let the CAM system write the program without it");
  }
  if (line.scaling_off && line.moves()) {
    reject("G", 50.0, "", "stands on a line with positions: on a lathe it would set the frame by them");
  }
  constexpr double unknown = -1.0;
  if (line.tool) name_tool(*line.tool);
  if (line.tool_change) mount(prepared_tool_.value_or(unknown), "M6");
  if (line.length) set_length(*line.length, line);
  if (line.center_point) {
    const int code = static_cast<int>(line.center_point->number);
    const bool on = find_mcode(code)->act == McodeAct::tcp_on;
    center_point_ = {.value = on ? CenterPoint::on : CenterPoint::off, .line = line_, .code = fmt::format("M{}", code)};
  }
}

void GcodeReader::set_length(const GcodeWords::Word& word, const Line& line) {
  constexpr double own = -1.0;
  const std::string code = fmt::format("G{:g}", word.number);
  const bool on = word.number != 49.0;
  length_ = {.value = on ? std::optional(line.h.value_or(own)) : std::nullopt, .line = line_, .code = code};
  if (on && word.number != 43.0) {
    center_point_ = {.value = CenterPoint::on_by_length, .line = line_, .code = code};
  } else if (center_point_.value == CenterPoint::on_by_length) {
    center_point_ = {.value = CenterPoint::off, .line = line_, .code = code};
  }
}

void GcodeReader::begin_cutting() {
  if (!m6_has_come_ && !named_cutting_.value) {
    named_cutting_ = named_;
  } else if (!m6_has_come_ && named_.value != named_cutting_.value && !second_named_) {
    second_named_ = {.line = named_.line,
                     .code = named_.code,
                     .what = "names another tool than the one that has cut, in a program without M6",
                     .hint = "Write a program for each tool, or M6 where the tool changes"};
    second_named_line_ = line_;
  }
  if (reading_.tool.given() && !cutting_ && length_.value && length_.line < tool_.line) {
    remarks_.assume({.what = fmt::format("The tool's length in line {}", line_),
                     .taken = fmt::format("that of {}, though {} in line {} comes before its change", tools_.now().name,
                                          length_.code, length_.line),
                     .key = "G43 H behind M6"});
  }
  if (!cutting_) {
    cutting_ = true;
    cutting_tool_ = tool_.value;
    cutting_length_ = length_.value;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (!lost_rotary_[i] || !reading_.machine) continue;
    constexpr std::array<const char*, 3> names = {"A", "B", "C"};
    const bool has = i == 2 || static_cast<Eigen::Index>(i) == tilt_index(*reading_.machine);
    if (has)
      reject(names[i], std::nullopt, "deg", "is not known where this line cuts: it went to the machine's own position",
             "Give the angle by G0 before it");
  }
  const bool in_plane = tilted_ && tilted_->plane;
  if (center_point_.value == CenterPoint::not_said && !rotary_deg_.isZero() && !in_plane)
    remarks_.no_center_point(line_);
}

bool GcodeReader::center_point_lost(const Line& line) const {
  const bool turned = line.rotary[0] || line.rotary[1] || line.rotary[2] || !rotary_deg_.isZero();
  const bool in_plane = tilted_ && tilted_->plane;  // which positions count in, whichever axes have turned
  return center_point_.value == CenterPoint::off && turned && !in_plane;
}

std::optional<GcodeReader::Change> GcodeReader::setup_change(const Line& line) const {
  const auto change = [](const auto& said, const char* what, const char* hint, bool tool = false) {
    return Change{.line = said.line, .code = said.code, .what = what, .hint = hint, .other_tool = tool};
  };
  if (center_point_lost(line)) {
    return change(center_point_, "turns the tool centre point off: positions are the machine's then, not the tip's",
                  "Let the CAM system write positions of the tip");
  }
  if (cutting_ && tool_.value != cutting_tool_) {
    return change(tool_, "mounts another tool than the one that has cut, whose length is not known here",
                  "Write a program for each tool", true);
  }
  if (cutting_ && length_.value != cutting_length_) {
    return change(length_, "changes the tool's length after moves at feed",
                  "One length holds from the first move at feed on");
  }
  return std::nullopt;
}

void GcodeReader::turn_rotary(const Line& line) {
  static constexpr std::array<const char*, 3> names = {"A", "B", "C"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.rotary[i]) continue;
    if (!reading_.machine) {
      reject(names[i], *line.rotary[i], "deg", "turns an axis of a machine that is not stated",
             fmt::format("Give program.machine: \"xyzac-trt\", \"xyzbc-trt\", \"xyzac-head\" or \"xyzbc-head\"{}",
                         i == 2 ? ". A corner is cut off by ,C with its comma" : ""));
    }
    if (!has_axis(*reading_.machine, i)) {
      reject(names[i], *line.rotary[i], "deg", "turns an axis that the stated machine does not have",
             "Is it the other machine, with A in place of B or B in place of A?");
    }
    const auto axis = static_cast<Eigen::Index>(i);
    if (incremental_ && lost_rotary_[i]) {
      reject(names[i], *line.rotary[i], "deg", "is a step (G91) from an angle that is not known here", "Write G90");
    }
    lost_rotary_[i] = false;
    rotary_deg_[axis] = *line.rotary[i] + (incremental_ ? rotary_deg_[axis] : 0.0);
    if (!(std::abs(rotary_deg_[axis]) <= 1e6)) {
      reject(names[i], *line.rotary[i], "deg", "must lie within a million degrees");
    }
  }
}

RotaryMove GcodeReader::turn_from(const Eigen::Vector3d& rotary_before_deg) const {
  return {
      .machine = *reading_.machine, .begin_rad = rotary_before_deg * units::deg, .end_rad = rotary_deg_ * units::deg};
}

void GcodeReader::check_shortest(const RotaryMove& turn) const {
  constexpr double half_deg = 180.0;
  const double turn_deg = (turn.end_rad.z() - turn.begin_rad.z()) / units::deg;
  const bool leaves = turn.parts(reading_.axis_tolerance_rad) > 1.0;
  if (motion_ != Motion::feed || std::abs(turn_deg) < half_deg || !leaves) return;
  reject("C", io::round_15(turn_deg), "deg", "turns by half a circle or more, which no shortest way does",
         "program.rotary = \"machine\" turns the axes as far as the words say");
}

}  // namespace robomill::program
