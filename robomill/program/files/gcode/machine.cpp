// What a program in G-code says to its machine: M codes, tools, lengths, the tool centre point.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/base/error.hpp"
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
  if (line.tool) prepared_tool_ = *line.tool;
  if (line.tool_change) mount(prepared_tool_.value_or(unknown));
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

void GcodeReader::mount(double number) {
  constexpr std::size_t most = 100;
  tool_ = {.value = number, .line = line_, .code = "M6"};
  ++mounted_count_;
  if (mounted_.size() < most) mounted_.push_back({.number = number, .line = line_});
}

// What follows the first cut of a second tool is not carried out.
void GcodeReader::list_tools(std::string_view statement) {
  try {
    words_.scan(statement, file_, line_);
  } catch (const InvalidInput&) {
    return;  // names no tool
  }
  bool changes = false;
  for (const GcodeWords::Word& word : words_.words()) {
    if (word.letter == 't') prepared_tool_ = word.number;
    if (word.letter != 'm') continue;
    changes = changes || word.number == 6.0 || word.number == 16.0;
    ended_ = ended_ || word.number == 2.0 || word.number == 30.0;
  }
  if (changes) mount(prepared_tool_.value_or(-1.0));
}

void GcodeReader::at_end() {
  if (!leaves_out_sub_.empty()) {
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file_, sub_line_),
                                           .field = fmt::format("o{} sub", leaves_out_sub_),
                                           .rule = "begins a subprogram that does not end",
                                           .hint = "Is its endsub missing?"});
  }
  if (!second_tool_) return;
  constexpr std::size_t most_named = 12;
  std::string tools;
  for (std::size_t i = 0; i < std::min(mounted_.size(), most_named); ++i) {
    const Mounted& tool = mounted_[i];
    tools +=
        fmt::format("{}{} (line {})", i == 0 ? "" : ", ",
                    tool.number < 0.0 ? std::string("one without a T") : fmt::format("T{:g}", tool.number), tool.line);
  }
  if (mounted_count_ > most_named) tools += fmt::format(" and {} more", mounted_count_ - most_named);
  throw InvalidInput(InvalidInput::Parts{
      .where = fmt::format("{}:{}", file_, second_tool_->line),
      .field = second_tool_->code,
      .rule = fmt::format("{}, and line {} cuts; the program mounts {}", second_tool_->what, second_tool_line_, tools),
      .hint = second_tool_->hint});
}

void GcodeReader::begin_cutting() {
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
  if (center_point_.value == CenterPoint::not_said && !rotary_deg_.isZero()) remarks_.no_center_point(line_);
}

bool GcodeReader::center_point_lost(const Line& line) const {
  const bool turned = line.rotary[0] || line.rotary[1] || line.rotary[2] || !rotary_deg_.isZero();
  return center_point_.value == CenterPoint::off && turned;
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

}  // namespace robomill::program
