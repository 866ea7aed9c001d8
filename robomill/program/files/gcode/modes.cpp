// The G codes of a GcodeReader's line.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/reader.hpp"

namespace robomill::program {
namespace {

/// G54 … G59.3, G54.1, G154, G110 … G129.
bool is_system(int code) {
  return (code >= 540 && code <= 593 && code != 542 && code != 544) || code == 1540 || (code >= 1100 && code <= 1290);
}

bool is_cycle(int code) {
  constexpr std::array<int, 9> cycles = {730, 740, 810, 820, 830, 840, 850, 860, 890};
  return std::ranges::find(cycles, code) != cycles.end() || code == 880;
}

/// Codes that are left out whatever the words on their line are, where those words are their own.
bool takes_words(int code) {
  constexpr std::array<int, 8> takers = {50, 51, 80, 220, 501, 542, 1000, 1870};
  return std::ranges::find(takers, code) != takers.end();
}

/// As LinuxCNC and GRBL do, whose endings these are: mm and seconds, with or without a point.
bool counts_whole_units(std::string_view file) {
  return file.ends_with(".ngc") || file.ends_with(".gcode");
}

}  // namespace

void GcodeReader::claim(GcodeGroup group, const GcodeWords::Word& word, Line& line) const {
  const auto bit = static_cast<std::uint32_t>(group);
  if (group != GcodeGroup::other && (line.groups & bit) != 0) {
    reject("G", word.number, "", "is the second code of its modal group on this line", "Only one of them can hold");
  }
  line.groups |= bit;
}

void GcodeReader::make_special(Special special, const GcodeWords::Word& word, Line& line) const {
  if (line.special != Special::none) {
    reject("G", word.number, "", "stands on a line with another code that takes its words", "Write a line for each");
  }
  line.special = special;
  line.special_code = word;
}

void GcodeReader::take_g(const GcodeWords::Word& word, Line& line) {
  const double tenths = 10.0 * word.number;
  const double whole = std::round(tenths);
  if (!(whole >= 0.0 && whole < 10000.0 && std::abs(tenths - whole) < 1e-6)) {
    reject("G", word.number, "", "is no G code");
  }
  const int code = static_cast<int>(whole);
  if (set_mode(code, word, line) || set_frame(code, word, line)) return;
  const GcodeGroup* const group = still_gcode(code);
  if (group == nullptr) {
    reject("G", word.number, "", "is not read: it may move the tool or its frame", gcode_hint(code));
  }
  claim(*group, word, line);
  if (*group == GcodeGroup::length) {
    line.length = word;
    if (code != 430 && code != 490) return;  // those that turn the tool centre point on are obeyed
  }
  line.scaling_off = line.scaling_off || code == 500;
  if (takes_words(code)) make_special(Special::noted, word, line);
  line.leave_out(word);
}

bool GcodeReader::set_frame(int code, const GcodeWords::Word& word, Line& line) {
  const auto takes = [&](Special special) {
    make_special(special, word, line);
    return true;
  };
  switch (code) {
    case 100:
      return takes(Special::table);
    case 280:
    case 300:
      return takes(Special::home);
    case 520:
      return takes(Special::local);
    case 531:
      return takes(Special::along_plane);
    case 680:
      return takes(Special::turned);
    case 682:
      return takes(Special::tilted);
    case 690:
      line.frame_off = true;
      line.leave_out(word);
      return true;
    case 530:
      return takes(Special::machine);
    case 920:
      return takes(Special::shift);
    case 921:
    case 922:
      return takes(Special::shift_reset);
    default:
      break;
  }
  if (!is_system(code)) return false;
  claim(GcodeGroup::system, word, line);
  line.system = word;
  line.leave_out(word);
  return true;
}

bool GcodeReader::set_mode(int code, const GcodeWords::Word& word, Line& line) {
  const auto holds = [&](GcodeGroup group) {
    claim(group, word, line);
    return true;
  };
  const auto moves = [&](Motion motion) {
    motion_ = motion;
    return holds(GcodeGroup::motion);
  };
  const auto lies = [&](const Plane& plane) {
    plane_ = plane;
    return holds(GcodeGroup::plane);
  };
  const auto feeds = [&](FeedMode mode) {
    if (mode != feed_mode_) feed_.reset();  // F of the other mode means something else
    feed_mode_ = mode;
    return holds(GcodeGroup::feed);
  };
  if (is_cycle(code)) {
    choose_cycle(code, word, line);
    return holds(GcodeGroup::cycle);
  }
  switch (code) {
    case 0:
      return moves(Motion::rapid);
    case 10:
      return moves(Motion::feed);
    case 20:
      return moves(Motion::clockwise);
    case 30:
      return moves(Motion::counterclockwise);
    case 40:
      line.dwells = true;
      return true;
    case 170:
      return lies({});
    case 180:
      return lies({.first = 2, .second = 0, .normal = 1, .centers = "K, I", .name = "G18"});
    case 190:
      return lies({.first = 1, .second = 2, .normal = 0, .centers = "J, K", .name = "G19"});
    case 200:
    case 210:
      inches_ = code == 200;
      return holds(GcodeGroup::unit);
    case 700:
    case 710:
      inches_ = code == 700;
      line.other_unit = word;
      return holds(GcodeGroup::unit);
    case 800:
      line.leave_out(word);
      line.cycle_off = true;
      return holds(GcodeGroup::cycle);
    case 900:
    case 910:
      incremental_ = code == 910;
      return holds(GcodeGroup::distance);
    case 901:
    case 911:
      centers_absolute_ = code == 901;
      return holds(GcodeGroup::center);
    case 930:
      return feeds(FeedMode::inverse_time);
    case 940:
      return feeds(FeedMode::per_minute);
    case 980:
    case 990:
      cycle_.to_r = code == 990;
      return holds(GcodeGroup::retract);
    default:
      return false;
  }
}

void GcodeReader::check_noted(const Line& line) const {
  const double code = line.special_code->number;
  const auto is = [&](double number) { return std::abs(code - number) < 1e-6; };
  const auto only = [&](bool well, const char* rule, const char* hint) {
    if (!well) reject("G", code, "", rule, hint);
  };
  constexpr const char* curves = "Let the CAM system write curves as arcs G2, G3 or straight moves";
  const bool curve = line.vector[0] || line.vector[1] || line.vector[2];
  bool zeros = true;
  for (const std::optional<double>& word : line.position) zeros = zeros && word.value_or(0.0) == 0.0;
  if (is(5.0)) {
    only(line.p && !line.q && !line.moves(), "is a curve unless P alone stands with it (look-ahead of Fanuc)", curves);
  } else if (is(5.1)) {
    only(line.q && !curve && zeros, "is a curve unless Q stands with it (look-ahead of Fanuc)", curves);
  } else if (is(8.0)) {
    only(line.p && !line.moves(), "changes what X means on a lathe unless P stands with it (look-ahead of Fanuc)",
         "Write G8 P1");
  } else if (is(54.2)) {
    only(line.p && line.p->number == 0.0 && !line.moves(),
         "moves the program's frame with the rotary axes; P0 alone, which turns it off, is read",
         "Let the CAM system write positions of the tip");
  } else if (is(187.0)) {
    only(!line.moves(), "stands on a line with positions", "Write a line of its own for it");
  } else if (is(22.0)) {
    only(!curve && !line.moves(), "sets limits of the machine by the positions on its line", "Take it out");
  }
}

void GcodeReader::check_points(const Line& line) {
  const bool arc = motion_ == Motion::clockwise || motion_ == Motion::counterclockwise;
  const std::string_view letters = arc ? "xyzijkr" : motion_ == Motion::cycle ? "xyzrq" : "xyz";
  // A retract's zeros say little of how positions are written.
  if (line.special == Special::noted || line.special == Special::home || line.special == Special::machine) return;
  constexpr int most = 9;
  int fewest = most;
  int largest = 0;
  for (const GcodeWords::Word& word : words_.words()) {
    if (letters.find(word.letter) == std::string_view::npos) continue;
    remarks_.coordinate(line_, word.text, unit_name());
    const std::size_t point = word.text.find('.');
    const int decimals = point == std::string_view::npos ? 0 : static_cast<int>(word.text.size() - point - 1);
    fewest = std::min(fewest, decimals);
    largest = std::max(largest, std::min(most, decimals));
  }
  decimals_ = std::max(decimals_, largest);
  fixed_decimals_ = fewest == largest ? fewest : most;
  if (counts_whole_units(file_)) return;
  const std::optional<ProgramRemarks::MixedPoints> mixed = remarks_.mixed_points();
  if (!mixed) return;
  const double number = std::strtod(mixed->whole_word.c_str() + 1, nullptr);
  const double least = inches_ ? 1e-4 : 1e-3;
  throw InvalidInput(InvalidInput::Parts{
      .where = fmt::format("{}:{}", file_, mixed->whole_line),
      .field = mixed->whole_word,
      .rule =
          fmt::format("has no point, and {} in line {} has one: it is {:g} {}, or {:g} {} on controls that count the "
                      "smallest step (Fanuc, Haas)",
                      mixed->point_word, mixed->point_line, number, unit_name(), number * least, unit_name()),
      .hint = fmt::format("Write {}. or {}{:g}", mixed->whole_word, mixed->whole_word.front(), number * least)});
}

double GcodeReader::seconds_of(const GcodeWords::Word& p, double least_ms) {
  const bool whole = p.text.find('.') == std::string_view::npos;
  if (!whole || p.number < least_ms || counts_whole_units(file_)) return p.number;
  remarks_.assume(
      {.what = fmt::format("Times of dwells that are whole numbers without a point, from {:g} on", least_ms),
       .taken = "milliseconds, as Fanuc and Haas count; LinuxCNC counts seconds",
       .key = "P with a point, in seconds"});
  return p.number * units::ms;
}

}  // namespace robomill::program
