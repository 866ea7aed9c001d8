#include "robomill/formats/gcode_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/formats/units.hpp"

namespace robomill::formats {
namespace {

using program::Machine;

constexpr double inch = 25.4 * units::mm;
constexpr double farthest_m = 1e3;

/// Modal groups: of each, a line may name one.
enum Group : std::uint32_t {
  motion_group = 1,
  distance_group = 2,
  unit_group = 4,
  feed_group = 8,
  plane_group = 16,
  radius_group = 32,
  length_group = 64,
  system_group = 128,
  path_group = 256,
  other_group = 512
};

/// G codes that move neither the tool nor its frame, in tenths.
struct Still {
  int code;
  Group group;
};
constexpr std::array<Still, 24> still = {
    {{40, other_group},   {80, other_group},   {150, other_group},  {170, plane_group},  {180, plane_group},
     {190, plane_group},  {400, radius_group}, {430, length_group}, {432, length_group}, {434, length_group},
     {435, length_group}, {490, length_group}, {500, other_group},  {610, path_group},   {611, path_group},
     {640, path_group},   {690, other_group},  {901, other_group},  {911, other_group},  {921, other_group},
     {922, other_group},  {970, other_group},  {980, other_group},  {990, other_group}}};

const char* hint_of_g(int code) {
  switch (code / 10) {
    case 2:
    case 3:
      return "Let the CAM system write arcs as straight moves";
    case 28:
    case 30:
    case 53:
      return "Where the machine's own positions lie in the part is not known here";
    case 10:
    case 52:
    case 92:
      return "It would move the program's frame";
    case 41:
    case 42:
      return "Let the CAM system write the path of the tool's tip";
    case 43:
      return "It would move the tip by the words that come with it";
    case 51:
    case 68:
    case 16:
    case 7:
      return "It would change what the words of positions mean";
    case 95:
    case 96:
      return "Use G93 or G94, with a spindle speed in rpm";
    default:
      return code >= 730 && code <= 890 ? "Let the CAM system write cycles as straight moves" : "";
  }
}

constexpr std::size_t letter_index(char letter) {
  return static_cast<std::size_t>(letter - 'a');
}

char upper(char letter) {
  return static_cast<char>(letter - 'a' + 'A');
}

bool has_axis(Machine machine, std::size_t rotary) {
  if (rotary == 2) return true;
  const bool with_a = machine == Machine::xyzac_trt || machine == Machine::xyzac_head;
  return with_a == (rotary == 0);
}

bool any(const std::array<std::optional<double>, 3>& words) {
  return words[0] || words[1] || words[2];
}

}  // namespace

bool GcodeReader::Line::moves() const {
  return any(position) || any(rotary) || any(axis);
}

void GcodeReader::Line::leave_out(const GcodeWords::Word& word) {
  if (!left_out.empty()) left_out += ' ';
  left_out += upper(word.letter);
  left_out += word.text.substr(1);
}

GcodeReader::GcodeReader(std::string file, std::optional<Machine> machine)
    : file_(std::move(file)), machine_(machine) {}

void GcodeReader::refuse(std::string field, std::optional<double> number, const char* unit, std::string rule,
                         std::string hint) const {
  throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file_, line_),
                                         .field = std::move(field),
                                         .number = number,
                                         .unit = unit,
                                         .rule = std::move(rule),
                                         .hint = std::move(hint)});
}

std::optional<program::Block> GcodeReader::next(std::string_view text) {
  ++line_;
  if (ended_) return std::nullopt;
  words_.scan(text, file_, line_);
  if (words_.deleted()) {
    skipped_.push_back({.line = line_, .what = std::string(words_.compact())});
    return std::nullopt;
  }
  if (words_.words().empty()) return std::nullopt;
  Line line;
  for (const GcodeWords::Word& word : words_.words()) take(word, line);
  if (line.dwells && line.moves()) {
    refuse("G", 4.0, "", "stands on a line with positions", "Is one of them the time of the dwell? Give that as P");
  }
  if (!line.left_out.empty()) skipped_.push_back({.line = line_, .what = std::move(line.left_out)});
  take_feed(line);
  return line.moves() ? move(line) : std::nullopt;
}

void GcodeReader::take(const GcodeWords::Word& word, Line& line) {
  const std::uint32_t bit = 1U << letter_index(word.letter);
  if ((line.letters & bit) != 0 && word.letter != 'g' && word.letter != 'm') {
    refuse(std::string(1, upper(word.letter)), word.number, "", "comes twice on one line");
  }
  line.letters |= bit;
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
      line.axis[letter_index(word.letter) - letter_index('i')] = word.number;
      return;
    case 'f':
      line.feed = word.number;
      return;
    case 's':
      if (!(word.number >= 0.0)) refuse("S", word.number, "rpm", "must be >= 0");
      spindle_speed_rad_per_s_ = word.number * units::rpm;
      return;
    case 'g':
      take_g(word, line);
      return;
    case 'm':
      if (word.number == 98.0) {
        refuse("M", word.number, "", "calls a subroutine, which is not read", "Let the CAM system write it out");
      }
      ended_ = ended_ || word.number == 2.0 || word.number == 30.0 || word.number == 99.0;
      line.leave_out(word);
      return;
    case 'n':
      return;
    case 't':
    case 'd':
    case 'h':
    case 'p':
    case 'q':
    case 'l':
      line.leave_out(word);
      return;
    case 'o':
      if (words_.words().size() == 1) {
        line.leave_out(word);
        return;
      }
      refuse("O", word.number, "", "is a subroutine or its control, which are not read",
             "Let the CAM system write the program out");
    default:
      refuse(std::string(1, upper(word.letter)), word.number, "", "is a word not known here",
             "Known are A B C D F G H I J K L M N P Q S T X Y Z");
  }
}

void GcodeReader::take_g(const GcodeWords::Word& word, Line& line) {
  const double tenths = 10.0 * word.number;
  const double whole = std::round(tenths);
  if (!(whole >= 0.0 && whole < 10000.0 && std::abs(tenths - whole) < 1e-6)) {
    refuse("G", word.number, "", "is no G code");
  }
  const int code = static_cast<int>(whole);
  const auto claim = [&](Group group) {
    if (group != other_group && (line.groups & group) != 0) {
      refuse("G", word.number, "", "is the second code of its modal group on this line", "Only one of them can hold");
    }
    line.groups |= group;
  };
  switch (code) {
    case 0:
    case 10:
      claim(motion_group);
      motion_ = code == 0 ? Motion::rapid : Motion::feed;
      return;
    case 200:
    case 210:
      claim(unit_group);
      inches_ = code == 200;
      return;
    case 900:
    case 910:
      claim(distance_group);
      incremental_ = code == 910;
      return;
    case 930:
    case 940: {
      claim(feed_group);
      const FeedMode mode = code == 930 ? FeedMode::inverse_time : FeedMode::per_minute;
      if (mode != feed_mode_) feed_.reset();  // F of the other mode means something else
      feed_mode_ = mode;
      return;
    }
    case 800:
      claim(motion_group);
      motion_ = Motion::none;
      break;
    default:
      if (code >= 540 && code <= 593) {
        claim(system_group);
        choose_system(code, word);
        break;
      }
      const auto* const found = std::ranges::find(still, code, &Still::code);
      if (found == still.end()) {
        refuse("G", word.number, "", "is not read: it may move the tool or its frame", hint_of_g(code));
      }
      claim(found->group);
      line.dwells = line.dwells || code == 40;
  }
  line.leave_out(word);
}

void GcodeReader::choose_system(int code, const GcodeWords::Word& word) {
  const bool numbered = code <= 590 ? code % 10 == 0 : true;  // G54 … G59, G59.1 … G59.3
  if (!numbered) refuse("G", word.number, "", "is no G code");
  const bool moved = known_[0] || known_[1] || known_[2];
  if (moved && code != system_ && !(system_ == 0 && code == 540)) {
    refuse("G", word.number, "", "changes the coordinate system within the program",
           "One system holds from the first position on; where another one lies in it is not known here");
  }
  system_ = code;
}

void GcodeReader::take_feed(const Line& line) {
  if (!line.feed) return;
  constexpr double most = 1e9;  // beyond any machine in any unit
  if (!(*line.feed >= 0.0)) refuse("F", *line.feed, "", "must be > 0");
  if (!(*line.feed <= most)) refuse("F", *line.feed, "", "is too large for any machine");
  feed_ = line.feed;
  feed_in_inches_ = inches_;
}

Eigen::Vector3d GcodeReader::position_after(const Line& line) {
  static constexpr std::array<const char*, 3> names = {"X", "Y", "Z"};
  const double unit_m = inches_ ? inch : units::mm;
  Eigen::Vector3d position = pose_.tip_m;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.position[i]) continue;
    const auto axis = static_cast<Eigen::Index>(i);
    if (incremental_ && !known_[i]) {
      refuse(names[i], *line.position[i], "", "is a step (G91) from a position that no line has given",
             "Begin with G90 and a G0 to X, Y and Z");
    }
    position[axis] = *line.position[i] * unit_m + (incremental_ ? position[axis] : 0.0);
    known_[i] = true;
    if (!(std::abs(position[axis]) <= farthest_m)) {
      refuse(names[i], *line.position[i], inches_ ? "in" : "mm", "must lie within 1 km");
    }
  }
  return position;
}

Eigen::Vector3d GcodeReader::axis_of_words(const Line& line) const {
  static constexpr std::array<const char*, 3> names = {"I", "J", "K"};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.axis[i]) refuse(names[i], std::nullopt, "", "is missing; I, J and K come together, the axis of the tool");
  }
  const Eigen::Vector3d axis(*line.axis[0], *line.axis[1], *line.axis[2]);
  const double length = axis.norm();
  if (!(std::abs(length - 1.0) <= 0.01)) {
    refuse("I, J, K", length, "", "must be a vector of length 1", "They are the axis of the tool, not an arc's centre");
  }
  return axis / length;
}

Eigen::Vector3d GcodeReader::axis_after(const Line& line) {
  static constexpr std::array<const char*, 3> names = {"A", "B", "C"};
  by_rotary_ = by_rotary_ || any(line.rotary);
  by_vector_ = by_vector_ || any(line.axis);
  if (by_rotary_ && by_vector_) {
    refuse(any(line.axis) ? "I, J, K" : "A, B, C", std::nullopt, "",
           "stand in a program that gives its axis the other way as well", "Use A, B and C or I, J and K");
  }
  if (any(line.axis)) return axis_of_words(line);
  if (!any(line.rotary)) return pose_.axis;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!line.rotary[i]) continue;
    if (!machine_) {
      refuse(names[i], *line.rotary[i], "deg", "turns an axis of a machine that is not stated",
             "Give program.machine: \"xyzac-trt\", \"xyzbc-trt\", \"xyzac-head\" or \"xyzbc-head\"");
    }
    if (!has_axis(*machine_, i)) {
      refuse(names[i], *line.rotary[i], "deg", "turns an axis that the stated machine does not have",
             "Is it the other machine, with A in place of B or B in place of A?");
    }
    const auto axis = static_cast<Eigen::Index>(i);
    rotary_deg_[axis] = *line.rotary[i] + (incremental_ ? rotary_deg_[axis] : 0.0);
    if (!(std::abs(rotary_deg_[axis]) <= 1e6)) {
      refuse(names[i], *line.rotary[i], "deg", "must lie within a million degrees");
    }
  }
  const Eigen::Vector3d angles = rotary_deg_ * units::deg;
  return program::tool_axis(*machine_, angles.x(), angles.y(), angles.z());
}

double GcodeReader::duration_s(const Line& line, const program::Pose& end, double rotary_change_deg) const {
  constexpr double minute_s = 60.0;
  if (feed_mode_ == FeedMode::inverse_time) {
    if (!line.feed) {
      refuse("F", std::nullopt, "", "is missing: under G93 every G1 line gives its own",
             "F is 1 / minutes of the move; is the program meant to be in G94?");
    }
    if (!(*line.feed > 0.0)) refuse("F", *line.feed, "1/min", "must be > 0 on a G1 line");
    return minute_s / *line.feed;
  }
  if (!feed_) refuse("F", std::nullopt, "", "is missing: no line up to this G1 gives a feed under G94");
  if (!(*feed_ > 0.0)) refuse("F", *feed_, feed_in_inches_ ? "in/min" : "mm/min", "must be > 0 on a G1 line");
  const double length_m = (end.tip_m - pose_.tip_m).norm();
  if (length_m > 0.0) return minute_s * length_m / (*feed_ * (feed_in_inches_ ? inch : units::mm));
  return minute_s * rotary_change_deg / *feed_;
}

std::optional<program::Block> GcodeReader::move(const Line& line) {
  if (motion_ == Motion::none) {
    refuse("G", std::nullopt, "", "is missing: neither G0 nor G1 holds where this line gives a position");
  }
  const Eigen::Vector3d rotary_before = rotary_deg_;
  program::Block block;
  block.end = {.tip_m = position_after(line), .axis = axis_after(line)};
  block.line = line_;
  block.kind = motion_ == Motion::rapid ? program::Block::Kind::rapid : program::Block::Kind::feed;
  block.spindle_speed_rad_per_s = spindle_speed_rad_per_s_;
  const bool complete = known_[0] && known_[1] && known_[2];
  if (!complete && motion_ == Motion::feed) {
    refuse(!known_[0]   ? "X"
           : !known_[1] ? "Y"
                        : "Z",
           std::nullopt, "", "is not known where the first G1 begins", "Begin with a G0 to X, Y and Z");
  }
  if (!complete || !start_) {
    pose_ = block.end;
    if (complete) start_ = pose_;
    return std::nullopt;
  }
  if (block.end.tip_m == pose_.tip_m && block.end.axis == pose_.axis) return std::nullopt;
  const double turned = program::angle_between(pose_.axis, block.end.axis);
  if (turned > 179.9 * units::deg) {
    refuse("axis", turned / units::deg, "deg", "turns by half a circle in one move, which could go any way round",
           "Split the move");
  }
  if (block.kind == program::Block::Kind::feed) {
    const double rotary_change_deg = any(line.rotary) ? (rotary_deg_ - rotary_before).norm() : turned / units::deg;
    block.duration_s = duration_s(line, block.end, rotary_change_deg);
  }
  pose_ = block.end;
  return block;
}

}  // namespace robomill::formats
