// What a program in G-code says to its machine: M codes, tools, lengths, the tool centre point.
#include <fmt/format.h>

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
      reject("M", word.number, "", fmt::format("is not carried out here: {}", meaning_of(*code)),
             "Let the CAM system write the program without it");
    case McodeAct::nothing:
      break;
    case McodeAct::end:
      ended_ = true;
      line.begins_again = code->code == 99;
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
  if (line.tool_change) tool_ = {.value = prepared_tool_.value_or(unknown), .line = line_, .code = "M6"};
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
  if (!cutting_) {
    cutting_ = true;
    cutting_tool_ = tool_.value;
    cutting_length_ = length_.value;
  }
  if (center_point_.value == CenterPoint::not_said && !rotary_deg_.isZero()) remarks_.no_center_point(line_);
}

void GcodeReader::check_setup(const Line& line) const {
  const auto reject_of = [&](const auto& said, const char* what, const char* hint) {
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file_, said.line),
                                           .field = said.code,
                                           .rule = fmt::format("{}, and line {} moves", what, line_),
                                           .hint = hint});
  };
  if (cutting_ && tool_.value != cutting_tool_) {
    reject_of(tool_, "mounts another tool than the one that has cut, whose length is not known here",
              "Write a program for each tool");
  }
  if (cutting_ && length_.value != cutting_length_) {
    reject_of(length_, "changes the tool's length after moves at feed",
              "One length holds from the first move at feed on");
  }
  const bool turned = line.rotary[0] || line.rotary[1] || line.rotary[2] || !rotary_deg_.isZero();
  if (center_point_.value == CenterPoint::off && turned) {
    reject_of(center_point_, "turns the tool centre point off: positions are the machine's then, not the tip's",
              "Let the CAM system write positions of the tip");
  }
}

}  // namespace robomill::program
