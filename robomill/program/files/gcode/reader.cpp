#include "robomill/program/files/gcode/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"

namespace robomill::program {
namespace {

constexpr std::size_t letter_index(char letter) {
  return static_cast<std::size_t>(letter - 'a');
}

std::string letter_name(char letter) {
  return std::string(1, static_cast<char>(letter - 'a' + 'A'));
}

bool has_axis(Machine machine, std::size_t rotary) {
  return rotary == 2 || static_cast<Eigen::Index>(rotary) == tilt_index(machine);
}

bool any(const std::array<std::optional<double>, 3>& words) {
  return words[0] || words[1] || words[2];
}

}  // namespace

bool GcodeReader::Line::has(char letter) const {
  return (letters & (1U << letter_index(letter))) != 0;
}

bool GcodeReader::Line::moves() const {
  return any(position) || any(rotary) || any(vector) || radius;
}

void GcodeReader::Line::leave_out(const GcodeWords::Word& word) {
  if (!left_out.empty()) left_out += ' ';
  left_out += letter_name(word.letter);
  left_out += word.text.substr(1);
}

GcodeReader::Modes GcodeReader::modes() const {
  return {.motion = motion_,
          .feed_mode = feed_mode_,
          .inches = inches_,
          .incremental = incremental_,
          .centers_absolute = centers_absolute_,
          .feed_in_inches = feed_in_inches_,
          .feed = feed_,
          .rotary_deg = rotary_deg_};
}

double GcodeReader::unit_m() const {
  return inches_ ? units::inch : units::mm;
}

// Heidenhain ends a line that goes on with a tilde, Okuma begins the next one with a dollar sign.
ProgramReader::Part GcodeReader::part_of(std::string_view line, char ahead, bool continued) const {
  if (continued) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first != std::string_view::npos && line[first] == '$') line.remove_prefix(first + 1);
  }
  std::size_t end = line.size();
  while (end > 0 && (line[end - 1] == ' ' || line[end - 1] == '\t')) --end;
  const bool tilde = end > 0 && line[end - 1] == '~' && line.find(';') == std::string_view::npos;
  return {.text = tilde ? line.substr(0, end - 1) : line, .continues = tilde || ahead == '$'};
}

void GcodeReader::read(std::string_view statement) {
  if (spindle_after_) spindle_ = *std::exchange(spindle_after_, std::nullopt);
  if (coolant_after_) coolant_ = *std::exchange(coolant_after_, std::nullopt);
  words_.scan(statement, file_, line_);
  if (words_.words().empty()) {
    if (words_.compact().empty()) return;
    const char mark = words_.compact().front();
    if (mark != '%') skip(words_.compact());
    // What a lone % opens the next one closes.
    ended_ = words_.compact() == "%" && begun_;
    begun_ = true;
    return;
  }
  begun_ = true;
  Line line;
  for (const GcodeWords::Word& word : words_.words()) take_word(word, line);
  set_up(line);
  if (line.dwells) wait(line);
  const bool goes_round = motion_ == Motion::clockwise || motion_ == Motion::counterclockwise;
  if (line.p && !line.dwells && !(goes_round && line.moves())) line.leave_out(*line.p);
  if (!line.left_out.empty()) skip(line.left_out);
  take_feed(line);
  if (line.moves()) go(line);
  if (start_) stop_after_ = line.stop;
  if (!ready_) ready_ = advance();
}

void GcodeReader::take_word(const GcodeWords::Word& word, Line& line) {
  if (line.has(word.letter) && word.letter != 'g' && word.letter != 'm') {
    reject(letter_name(word.letter), word.number, "", "comes twice on one line");
  }
  line.letters |= 1U << letter_index(word.letter);
  switch (word.letter) {
    case 'x':
    case 'y':
    case 'z':
      line.position[letter_index(word.letter) - letter_index('x')] = word.number;
      remarks_.coordinate(line_, word.text, unit_name());
      return;
    case 'a':
    case 'b':
    case 'c':
      line.rotary[letter_index(word.letter)] = word.number;
      return;
    case 'i':
    case 'j':
    case 'k':
      line.vector[letter_index(word.letter) - letter_index('i')] = word.number;
      return;
    case 'r':
      line.radius = word.number;
      return;
    case 'f':
      line.feed = word.number;
      return;
    case 'p':
      line.p = word;
      return;
    case 's':
      if (!(word.number >= 0.0)) reject("S", word.number, "rpm", "must be >= 0");
      spindle_speed_rad_per_s_ = word.number * units::rpm;
      return;
    case 'g':
      take_g(word, line);
      return;
    case 'm':
      take_m(word, line);
      return;
    case 'n':
      return;
    case 't':
      line.tool = word.number;
      line.leave_out(word);
      return;
    case 'h':
      line.h = word.number;
      line.leave_out(word);
      return;
    case 'd':
    case 'q':
    case 'l':
      line.leave_out(word);
      return;
    case 'o':
      if (words_.words().size() == 1) {
        line.leave_out(word);
        return;
      }
      reject("O", word.number, "", "is a subroutine or its control, which are not read",
             "Let the CAM system write the program out");
    default:
      reject(letter_name(word.letter), word.number, "", "is a word not known here",
             line.dwells ? "Is it the time of the dwell? Give that as P, in seconds"
                         : "Known are A B C D F G H I J K L M N P Q R S T X Y Z");
  }
}

void GcodeReader::claim(GcodeGroup group, const GcodeWords::Word& word, Line& line) const {
  const auto bit = static_cast<std::uint32_t>(group);
  if (group != GcodeGroup::other && (line.groups & bit) != 0) {
    reject("G", word.number, "", "is the second code of its modal group on this line", "Only one of them can hold");
  }
  line.groups |= bit;
}

void GcodeReader::take_g(const GcodeWords::Word& word, Line& line) {
  const double tenths = 10.0 * word.number;
  const double whole = std::round(tenths);
  if (!(whole >= 0.0 && whole < 10000.0 && std::abs(tenths - whole) < 1e-6)) {
    reject("G", word.number, "", "is no G code");
  }
  const int code = static_cast<int>(whole);
  if (set_mode(code, word, line)) return;
  if (code >= 540 && code <= 593) {
    claim(GcodeGroup::system, word, line);
    choose_system(code, word);
  } else {
    const GcodeGroup* const group = still_gcode(code);
    if (group == nullptr) {
      const bool unit = code == 700 || code == 710;
      reject("G", word.number, "",
             unit ? "is a unit to some, and not read" : "is not read: it may move the tool or its frame",
             gcode_hint(code));
    }
    claim(*group, word, line);
    if (*group == GcodeGroup::length) {
      line.length = word;
      if (code != 430 && code != 490) return;  // those that turn the tool centre point on are obeyed
    }
    line.scaling_off = line.scaling_off || code == 500;
  }
  line.leave_out(word);
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
    case 800:
      line.leave_out(word);
      return moves(Motion::none);
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
    default:
      return false;
  }
}

void GcodeReader::choose_system(int code, const GcodeWords::Word& word) {
  const bool numbered = code <= 590 ? code % 10 == 0 : true;  // G54 … G59, G59.1 … G59.3
  if (!numbered) reject("G", word.number, "", "is no G code");
  const bool moved = known_[0] || known_[1] || known_[2];
  if (moved && code != system_ && !(system_ == 0 && code == 540)) {
    reject("G", word.number, "", "changes the coordinate system within the program",
           "One system holds from the first position on; where another one lies in it is not known here");
  }
  system_ = code;
}

void GcodeReader::take_feed(const Line& line) {
  if (!line.feed) return;
  check_feed("F", *line.feed);
  feed_ = line.feed;
  feed_in_inches_ = inches_;
}

void GcodeReader::wait(const Line& line) {
  if (line.moves()) {
    reject("G", 4.0, "", "stands on a line with positions", "Is one of them the time of the dwell? Give that as P");
  }
  if (!line.p) {
    reject("P", std::nullopt, "", "is missing: the time of the dwell G4, in seconds",
           line.feed || line.has('s') ? "F and S are a feed and a speed here" : "");
  }
  constexpr double long_s = 100.0;
  const double time_s = line.p->number;
  check_dwell("P", time_s, "P counts in seconds here");
  if (!start_ || time_s == 0.0) {
    skip(fmt::format("G4 P{:g}", time_s));
    return;
  }
  if (time_s >= long_s) remarks_.long_dwell(line_, time_s);
  dwell(time_s);
}

Eigen::Vector3d GcodeReader::position_after(const Line& line) {
  static constexpr std::array<const char*, 3> names = {"X", "Y", "Z"};
  Eigen::Vector3d position = pose_.tip_m;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.position[i]) continue;
    const auto axis = static_cast<Eigen::Index>(i);
    if (incremental_ && !known_[i]) {
      reject(names[i], *line.position[i], "", "is a step (G91) from a position that no line has given",
             "Begin with G90 and a G0 to X, Y and Z");
    }
    position[axis] = *line.position[i] * unit_m() + (incremental_ ? position[axis] : 0.0);
    known_[i] = true;
    check_coordinate(names[i], position[axis], *line.position[i], unit_name());
  }
  return position;
}

Eigen::Vector3d GcodeReader::axis_of_vector(const Line& line) const {
  static constexpr std::array<const char*, 3> names = {"I", "J", "K"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.vector[i]) {
      reject(names[i], std::nullopt, "", "is missing; I, J and K come together, the axis of the tool",
             "With G2 and G3 they are the centre of the arc");
    }
  }
  return unit_axis("I, J, K", {*line.vector[0], *line.vector[1], *line.vector[2]});
}

void GcodeReader::turn_rotary(const Line& line) {
  static constexpr std::array<const char*, 3> names = {"A", "B", "C"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.rotary[i]) continue;
    if (!reading_.machine) {
      reject(names[i], *line.rotary[i], "deg", "turns an axis of a machine that is not stated",
             "Give program.machine: \"xyzac-trt\", \"xyzbc-trt\", \"xyzac-head\" or \"xyzbc-head\"");
    }
    if (!has_axis(*reading_.machine, i)) {
      reject(names[i], *line.rotary[i], "deg", "turns an axis that the stated machine does not have",
             "Is it the other machine, with A in place of B or B in place of A?");
    }
    const auto axis = static_cast<Eigen::Index>(i);
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

Eigen::Vector3d GcodeReader::axis_after(const Line& line) {
  by_rotary_ = by_rotary_ || any(line.rotary);
  by_vector_ = by_vector_ || any(line.vector);
  if (by_rotary_ && by_vector_) {
    reject(any(line.vector) ? "I, J, K" : "A, B, C", std::nullopt, "",
           "stand in a program that gives its axis the other way as well", "Use A, B and C or I, J and K");
  }
  if (any(line.vector)) return axis_of_vector(line);
  if (!any(line.rotary)) return pose_.axis;
  turn_rotary(line);
  return turn_from(rotary_deg_).axis_at(1.0);
}

double GcodeReader::feed_duration_s(const Line& line, double length_m, double turn_deg) const {
  if (feed_mode_ == FeedMode::inverse_time) {
    if (!line.feed) {
      reject("F", std::nullopt, "", "is missing: under G93 every move at feed gives its own",
             "F is 1 / minutes of the move; is the program meant to be in G94?");
    }
    if (!(*line.feed > 0.0)) reject("F", *line.feed, "1/min", "must be > 0 for a move at feed");
    return units::minute / *line.feed;
  }
  if (!feed_) reject("F", std::nullopt, "", "is missing: no line up to this move at feed gives one under G94");
  if (!(*feed_ > 0.0)) reject("F", *feed_, feed_in_inches_ ? "in/min" : "mm/min", "must be > 0 for a move at feed");
  if (length_m > 0.0) return units::minute * length_m / (*feed_ * (feed_in_inches_ ? units::inch : units::mm));
  return units::minute * turn_deg / *feed_;
}

void GcodeReader::go(const Line& line) {
  check_setup(line);
  switch (motion_) {
    case Motion::none:
      reject("G", std::nullopt, "", "is missing: none of G0 to G3 holds where this line gives a position");
    case Motion::rapid:
    case Motion::feed:
      go_straight(line);
      return;
    case Motion::clockwise:
    case Motion::counterclockwise:
      go_round(line);
  }
}

void GcodeReader::go_straight(const Line& line) {
  if (line.radius) {
    reject("R", *line.radius, unit_name(), "stands on a line that is no arc", "Is a G2 or G3 missing before it?");
  }
  const Eigen::Vector3d rotary_before_deg = rotary_deg_;
  const Pose end = {.tip_m = position_after(line), .axis = axis_after(line)};
  const bool complete = known_[0] && known_[1] && known_[2];
  if (!complete && motion_ == Motion::feed) {
    reject(!known_[0]   ? "X"
           : !known_[1] ? "Y"
                        : "Z",
           std::nullopt, "", "is not known where the first move at feed begins", "Begin with a G0 to X, Y and Z");
  }
  if (!complete) {
    pose_ = end;
    return;
  }
  if (!start_) {
    begin_at(end);
    return;
  }
  PartedMove parted = {.kind = motion_ == Motion::rapid ? Block::Kind::rapid : Block::Kind::feed,
                       .begin_m = pose_.tip_m,
                       .end_m = end.tip_m};
  if (any(line.rotary)) parted.turn = turn_from(rotary_before_deg);
  const bool evenly = parted.turn && reading_.rotary == Rotary::machine;
  // A turn may end where it began.
  if (!moves_to(end) && !(evenly && parted.turn->parts(reading_.axis_tolerance_rad) > 1.0)) return;
  const double turn_rad = evenly ? 0.0 : turn_to(end.axis);
  if (parted.turn && !evenly) check_shortest(*parted.turn);
  double duration_s = 0.0;
  if (motion_ == Motion::feed) {
    begin_cutting();
    const double turn_deg = parted.turn ? (rotary_deg_ - rotary_before_deg).norm() : turn_rad / units::deg;
    duration_s = feed_duration_s(line, (end.tip_m - pose_.tip_m).norm(), turn_deg);
  }
  if (evenly) {
    split(std::move(parted), duration_s, "A, B, C");
  } else {
    move(parted.kind, end, duration_s);
  }
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
