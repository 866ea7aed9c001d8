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

bool any(const std::array<std::optional<double>, 3>& words) {
  return words[0] || words[1] || words[2];
}

}  // namespace

GcodeReader::GcodeReader(std::string file, const ProgramReading& reading, ProgramRemarks& remarks)
    : ProgramReader(std::move(file), reading, remarks) {
  for (const WorkFrame& frame : reading.frames) {
    const int number = parse_work_frame(frame.code);
    tables_m_[number] = frame.origin_m;
    given_tables_.insert(number);
  }
}

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
          .rotary_deg = rotary_deg_,
          .origin_m = origin_m().value_or(Eigen::Vector3d::Zero()),
          .speed_rad_per_s = spindle_speed_rad_per_s_,
          .passes = passes(),
          .special = special_};
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
  special_ = false;
  if (!leaves_out_sub_.empty()) {
    const std::optional<OWord> control = o_word(words_.compact_line(statement, file_, line_));
    if (control && control->keyword == "endsub" && control->label == leaves_out_sub_) leaves_out_sub_.clear();
    return;
  }
  if (second_tool_) {
    list_tools(statement);
    return;
  }
  words_.scan(statement, file_, line_);
  if (words_.words().empty()) {
    read_wordless();
    return;
  }
  begun_ = true;
  Line line;
  for (const GcodeWords::Word& word : words_.words()) take_word(word, line);
  carry_out(line);
}

void GcodeReader::read_wordless() {
  const std::string_view compact = words_.compact();
  if (compact.empty()) return;
  if (const std::optional<OWord> control_word = o_word(compact)) {
    control(*control_word);
    return;
  }
  if (compact.front() != '%') skip(compact);
  const bool deleted = compact.front() == '/' || compact.front() == 'n';
  if (deleted && !compact.starts_with("//")) remarks_.count(ProgramRemarks::Count::deleted_block, line_);
  // What a lone % opens the next one closes.
  ended_ = compact == "%" && begun_;
  if (ended_ && depth_ > 0)
    reject({}, std::nullopt, "", "a % ends the program within a subprogram", "Is its M99 missing?");
  begun_ = true;
}

void GcodeReader::check_line(const Line& line) const {
  const auto has = [&](GcodeGroup group) { return (line.groups & static_cast<std::uint32_t>(group)) != 0; };
  if (line.cycle && has(GcodeGroup::motion)) {
    reject("G", line.cycle->number, "", "is the second code of motion on this line", "Only one of them can hold");
  }
  if (line.e && !(line.special == Special::noted && line.special_code->number == 187.0)) {
    reject("E", *line.e, "", "is a word not known here", "It is read with G187 alone");
  }
  if (!line.other_unit) return;
  for (const char letter : {'d', 'i', 'j', 'k', 'l', 'p', 'q', 'r'}) {
    if (!line.has(letter)) continue;
    reject("G", line.other_unit->number, "", "is a cycle where such words come with it, which is not read",
           "Write G20 for inches and G21 for mm; let the CAM system write cycles as straight moves");
  }
  remarks_.assume(
      {.what = fmt::format("G{:g}", line.other_unit->number),
       .taken = inches_ ? "inches, as DIN 66025 and Sinumerik read it" : "mm, as DIN 66025 and Sinumerik read it",
       .key = inches_ ? "G20" : "G21"});
}

void GcodeReader::leave_out_rest(Line& line) const {
  const bool goes_round = motion_ == Motion::clockwise || motion_ == Motion::counterclockwise;
  const bool drills = motion_ == Motion::cycle;
  const bool own = line.special != Special::none && line.special != Special::noted;
  if (line.l && !line.call && !own && !drills && !goes_round) line.leave_out(*line.l);
  if (line.q && !drills && !goes_round) line.leave_out(*line.q);
  if (line.p && !line.dwells && !line.call && !own && !drills && !(goes_round && line.moves())) line.leave_out(*line.p);
}

void GcodeReader::carry_out(Line& line) {
  check_line(line);
  if (line.cycle_off && (line.groups & static_cast<std::uint32_t>(GcodeGroup::motion)) == 0) motion_ = Motion::none;
  check_points(line);
  if (line.corner || corner_) check_corner(line);
  set_up(line);
  if (line.frame_off) end_tilt();
  if (line.system) choose_system(line);
  check_frame_stays(line);
  if (passes()) {
    take_feed(line);
    pass_over(line);
  } else {
    carry_out_part(line);
  }
  if (line.call) call_program(line);
}

void GcodeReader::carry_out_part(Line& line) {
  if (line.dwells) wait(line);
  leave_out_rest(line);
  if (!line.left_out.empty()) skip(line.left_out);
  take_feed(line);
  switch (line.special) {
    case Special::home:
      go_home(line);
      break;
    case Special::machine:
      go_to_machine(line);
      break;
    case Special::local:
      set_local(line);
      break;
    case Special::turned:
      turn_plane(line);
      break;
    case Special::tilted:
      tilt(line);
      break;
    case Special::along_plane:
      turn_to_plane(line);
      break;
    case Special::shift:
      shift(line);
      break;
    case Special::shift_reset:
      reset_shift(line);
      break;
    case Special::table:
      set_table(line);
      break;
    case Special::noted:
      special_ = true;
      check_noted(line);
      break;
    case Special::none:
      if (motion_ == Motion::cycle && !line.dwells) update_cycle(line);
      if (line.moves() || line.cycle) go(line);
  }
  if (start_ && !pending_ && unknown_axis() == nullptr) {
    const double begin_m = pose_.tip_m.z();
    highest_m_ = highest_known_ ? std::max(highest_m_, begin_m) : begin_m;
    highest_known_ = true;
  }
  if (start_ && !is_over()) stop_after_ = line.stop;
  if (!ready_) ready_ = advance();
}

void GcodeReader::take_word(const GcodeWords::Word& word, Line& line) {
  if (word.letter == ',') {
    take_corner(word, line);
    return;
  }
  if (line.has(word.letter) && word.letter != 'g' && word.letter != 'm') {
    reject(letter_name(word.letter), word.number, "", "comes twice on one line");
  }
  line.letters |= 1U << letter_index(word.letter);
  switch (word.letter) {
    case 'x':
    case 'y':
    case 'z':
      line.position[letter_index(word.letter) - letter_index('x')] = word.number;
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
      line.leave_out(word);
      return;
    case 'q':
      line.q = word;
      return;
    case 'l':
      line.l = word;
      return;
    case 'e':
      line.e = word.number;
      return;
    case 'o':
      if (words_.words().size() == 1) {
        if (start_) {
          reject("O", word.number, "", "begins another program before this one has ended",
                 depth_ > 0 ? "Is an M99 missing before it?" : "Is an M2 or M30 missing before it?");
        }
        line.leave_out(word);
        return;
      }
      reject("O", word.number, "", "is a subroutine or its control, which are not read",
             "Let the CAM system write the program out");
    default:
      reject(letter_name(word.letter), word.number, "", "is a word not known here",
             line.dwells ? "Is it the time of the dwell? Give that as P, in seconds"
                         : "Known are A B C D E F G H I J K L M N O P Q R S T X Y Z");
  }
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
  const double time_s = seconds_of(*line.p, long_s);
  check_dwell("P", time_s, "P counts in seconds here");
  if (!start_ || is_over() || time_s == 0.0) {
    skip(fmt::format("G4 P{:g}", time_s));
    return;
  }
  if (time_s >= long_s) remarks_.long_dwell(line_, time_s);
  dwell(time_s);
}

Eigen::Vector3d GcodeReader::position_after(const Line& line) {
  static constexpr std::array<const char*, 3> names = {"X", "Y", "Z"};
  const Eigen::Vector3d from_m = corner_ ? corner_->at_m : pending_ ? pending_->tip_m : pose_.tip_m;
  if (!base_ && any(line.position)) choose_base();
  // In a turned plane they count from its own zero.
  const Eigen::Vector3d origin = tilted_ ? Eigen::Vector3d::Zero() : origin_m().value_or(Eigen::Vector3d::Zero());
  Eigen::Vector3d position = in_program(from_m);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.position[i]) continue;
    const auto axis = static_cast<Eigen::Index>(i);
    if (incremental_ && !known_[i]) {
      if (lost_.value && motion_ == Motion::rapid) continue;
      if (lost_.value) reject_unknown(names[i]);
      reject(names[i], *line.position[i], "", "is a step (G91) from a position that no line has given",
             "Begin with G90 and a G0 to X, Y and Z");
    }
    position[axis] = *line.position[i] * unit_m() + (incremental_ ? position[axis] : origin[axis]);
    known_[i] = true;
    check_coordinate(names[i], position[axis], *line.position[i], unit_name());
  }
  if (!tilted_) return position;
  return any(line.position) ? out_of_program(position) : from_m;
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

Eigen::Vector3d GcodeReader::axis_after(const Line& line) {
  by_rotary_ = by_rotary_ || any(line.rotary);
  by_vector_ = by_vector_ || any(line.vector);
  if (by_rotary_ && by_vector_) {
    reject(any(line.vector) ? "I, J, K" : "A, B, C", std::nullopt, "",
           "stand in a program that gives its axis the other way as well", "Use A, B and C or I, J and K");
  }
  if (any(line.vector)) return axis_of_vector(line);
  if (!any(line.rotary)) return pending_ ? pending_->axis : pose_.axis;
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

void GcodeReader::reject_unknown(const char* axis) const {
  if (lost_.value) {
    reject(axis, std::nullopt, "",
           fmt::format("is not known where this line cuts: {} in line {} left the positions of the program", lost_.code,
                       lost_.line),
           "Give X, Y and Z by G0 in G90 before it");
  }
  reject(axis, std::nullopt, "",
         fmt::format("is not known where the first {} begins", motion_ == Motion::feed    ? "move at feed"
                                                               : motion_ == Motion::cycle ? "drilling cycle"
                                                                                          : "arc"),
         "Begin with a G0 to X, Y and Z");
}

void GcodeReader::go(const Line& line) {
  if (motion_ == Motion::none) {
    reject("G", std::nullopt, "", "is missing: none of G0 to G3 holds where this line gives a position");
  }
  begin_part_move();
  if (tilted_) special_ = true;
  if (is_elsewhere(line)) return;
  switch (motion_) {
    case Motion::none:
    case Motion::rapid:
    case Motion::feed:
      go_straight(line);
      return;
    case Motion::clockwise:
    case Motion::counterclockwise:
      go_round(line);
      return;
    case Motion::cycle:
      drill(line);
  }
}

void GcodeReader::go_straight(const Line& line) {
  if (line.radius) {
    reject("R", *line.radius, unit_name(), "stands on a line that is no arc",
           "Is a G2 or G3 missing before it? A corner is rounded by ,R with its comma");
  }
  const Eigen::Vector3d rotary_before_deg = rotary_deg_;
  if (pending_ && motion_ == Motion::feed) reject_unknown(unknown_axis() == nullptr ? "X, Y, Z" : unknown_axis());
  // From a height that the change of the tool has left unknown no move at feed begins.
  const bool begins_unknown = !start_ && reading_.tool.given() && lost_.value && motion_ == Motion::feed;
  if (const char* const first = unknown_axis(); begins_unknown && first != nullptr) reject_unknown(first);
  const Pose end = {.tip_m = position_after(line), .axis = axis_after(line)};
  const char* const unknown = unknown_axis();
  if (unknown != nullptr && motion_ == Motion::feed) reject_unknown(unknown);
  if (unknown != nullptr) {
    (pending_ ? *pending_ : pose_) = end;
    if (!pending_) return;
    special_ = true;
    remarks_.count(ProgramRemarks::Count::lost_rapid, line_);
    return;
  }
  if (!start_) {
    if (line.corner) reject_no_begin(*line.corner);
    lost_ = {};
    begin_at(end);
    return;
  }
  if (pending_) {
    come_back(end);
    return;
  }
  if (line.corner || corner_) {
    go_by_corner(line, end.tip_m);
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

}  // namespace robomill::program
