// The tools of a program in G-code: which is mounted, and what is followed while another one is chosen.
#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "robomill/program/files/program_lines.hpp"

namespace robomill::program {
namespace {

bool any_tool_word(const std::array<std::optional<double>, 3>& words) {
  return words[0] || words[1] || words[2];
}

}  // namespace

bool GcodeReader::changes_tool_by_t(ProgramLines lines, const std::string& file) {
  GcodeWords words;
  std::string_view line;
  bool names = false;
  while (lines.next(line)) {
    try {
      words.scan(line, file, lines.number());
    } catch (const InvalidInput&) {
      continue;  // rejected when it is read
    }
    for (const GcodeWords::Word& word : words.words()) {
      if (word.letter == 'm' && (word.number == 6.0 || word.number == 16.0)) return false;
      names = names || word.letter == 't';
    }
  }
  return names;
}

void GcodeReader::mount(double number, const char* code) {
  const bool again = tool_.value == std::optional(number);
  tool_ = {.value = number, .line = line_, .code = code};
  if (!m6_has_come_ && !by_t_) tools_.forget();  // T words before it have mounted nothing
  m6_has_come_ = true;
  mount_tool(whole_tool(number), number < 0.0 ? std::string(nameless_tool) : fmt::format("T{:g}", number));
  if (!reading_.tool.given() || again || passes() || start_ || !tools_.moved()) return;
  // The change moves the tool by itself.
  known_ = {};
  lost_ = {.value = true, .line = line_, .code = code};
}

// Without an M6 in the whole program, T may be what changes the tool.
void GcodeReader::name_tool(double number) {
  prepared_tool_ = number;
  if (by_t_) {
    remarks_.assume({.what = "T without an M6", .taken = "a change of the tool", .key = "M6"});
    mount(number, "T");
  } else if (!m6_has_come_ && !reading_.tool.given()) {
    named_ = {.value = number, .line = line_, .code = fmt::format("T{:g}", number)};
    mount_tool(whole_tool(number), named_.code);
  }
}

// What follows the first cut of a second tool is not carried out.
void GcodeReader::list_tools(std::string_view statement) {
  try {
    words_.scan(statement, file_, line_);
  } catch (const InvalidInput&) {
    return;  // names no tool
  }
  const std::optional<OWord> control_word = o_word(words_.compact());
  if (control_word && control_word->keyword == "endsub" && depth_ > 0) returns_ = true;
  bool changes = false;
  for (const GcodeWords::Word& word : words_.words()) {
    if (word.letter == 't') name_tool(word.number);
    if (word.letter != 'm') continue;
    if (word.number == 99.0) (depth_ > 0 ? returns_ : ended_) = true;
    changes = changes || word.number == 6.0 || word.number == 16.0;
    ended_ = ended_ || word.number == 2.0 || word.number == 30.0;
  }
  if (changes) mount(prepared_tool_.value_or(-1.0), "M6");
}

void GcodeReader::at_end() {
  if (!leaves_out_sub_.empty()) {
    throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file_, sub_line_),
                                           .field = fmt::format("o{} sub", leaves_out_sub_),
                                           .rule = "begins a subprogram that does not end",
                                           .hint = "Is its endsub missing?"});
  }
  if (corner_) reject_corner("has no move behind it", "");
  const bool named = !second_tool_ && !m6_has_come_ && second_named_;
  if (!second_tool_ && !named) return;
  const Change& change = named ? *second_named_ : *second_tool_;
  const std::size_t cuts = named ? second_named_line_ : second_tool_line_;
  throw SeveralTools({.where = fmt::format("{}:{}", file_, change.line),
                      .field = change.code,
                      .rule = fmt::format("{}, and line {} cuts", change.what, cuts),
                      .hint = change.hint},
                     tools_.parts(), tools_.count());
}

void GcodeReader::pass_over(const Line& line) {
  special_ = true;
  const bool named = any_tool_word(line.position) || any_tool_word(line.rotary);
  switch (line.special) {
    case Special::home:
    case Special::machine:
      for (std::size_t i = 0; i < 3; ++i) lost_rotary_[i] = lost_rotary_[i] || line.rotary[i] || !named;
      tools_.move(line_);
      return;
    case Special::local:
      set_local(line);
      return;
    case Special::turned:
      turn_plane(line);
      return;
    case Special::tilted:
      tilt(line);
      return;
    case Special::along_plane:
      turn_to_plane(line);
      tools_.move(line_);
      return;
    case Special::shift:
      // Where the tool stands is not followed here.
      if (any_tool_word(line.position)) shift_lost_ = {.value = true, .line = line_, .code = "G92"};
      return;
    case Special::shift_reset:
      shift_m_.setZero();
      shift_lost_ = {};
      return;
    case Special::table:
      set_table(line);
      return;
    case Special::noted:
      check_noted(line);
      return;
    case Special::none:
      break;
  }
  if (line.dwells || !(line.moves() || line.cycle)) return;
  if (any_tool_word(line.position) && !passed_system_) {
    passed_system_ = system_;
    passed_table_m_ = offsets_m();
  }
  tools_.move(line_);
  const bool straight = motion_ == Motion::rapid || motion_ == Motion::feed;
  if (straight) {
    pose_.axis = axis_after(line);
  } else if (any_tool_word(line.rotary)) {
    by_rotary_ = true;
    turn_rotary(line);
    pose_.axis = turn_from(rotary_deg_).axis_at(1.0);
  }
}

}  // namespace robomill::program
