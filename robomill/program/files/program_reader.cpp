#include "robomill/program/files/program_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"
#include "robomill/program/files/program_lines.hpp"

namespace robomill::program {
namespace {

constexpr double fastest = 1e9;  ///< beyond any machine in any unit
constexpr double largest_length_error = 1e-3;
constexpr double silent_length_error = 1e-6;  ///< of six printed decimals
constexpr double largest_turn_rad = 179.9 * units::deg;

/// The sentence of a count: "2 arcs …, the first in line 5…".
struct CountText {
  const char* one;
  const char* many;
  const char* more;  ///< behind the line, with the largest value
};
constexpr std::array<CountText, static_cast<std::size_t>(ProgramRemarks::Count::last)> count_texts = {{
    {"arc ends within a rounding of its begin and is read as almost a whole turn",
     "arcs end within a rounding of their begin and are read as almost whole turns",
     ": where a short arc is meant, give more decimals"},
    {"arc ends within a rounding of its begin and is read as almost nothing",
     "arcs end within a rounding of their begin and are read as almost nothing",
     ": where a whole turn is meant, let it end where it begins"},
    {"arc has another radius at its end than at its begin, as the program's few decimals make it",
     "arcs have another radius at their end than at their begin, as the program's few decimals make it",
     ", by up to {:.2g} mm: give more decimals"},
    {"line with a slash (block delete) is left out", "lines with a slash (block delete) are left out",
     ", as with the machine's switch on"},
    {"rapid is left out where the tool's position in the part is not known",
     "rapids are left out where the tool's position in the part is not known",
     ": the next position brings the tool back above the part"},
}};

}  // namespace

void ProgramRemarks::Counted::add(std::size_t line, double value) {
  if (count++ == 0) first_line = line;
  most = std::max(most, value);
}

void ProgramRemarks::skip(std::size_t line, std::string_view what) {
  if (repeated_) return;
  if (skipped_count_++ < most_) skipped_.push_back({.line = line, .what = std::string(what)});
}

void ProgramRemarks::normalised(std::size_t line, double error) {
  if (!repeated_) normalised_.add(line, error);
}

void ProgramRemarks::long_dwell(std::size_t line, double seconds) {
  if (!repeated_) long_dwells_.add(line, seconds);
}

void ProgramRemarks::operator_stop(std::size_t line) {
  if (!repeated_) operator_stops_.add(line, 0.0);
}

void ProgramRemarks::no_center_point(std::size_t line) {
  if (!repeated_) no_center_point_.add(line, 0.0);
}

std::vector<std::string> ProgramRemarks::notes() const {
  std::vector<std::string> out;
  if (normalised_.count > 0) {
    out.push_back(fmt::format("{} ax{} made a unit vector, off by up to {:.2g}, the first in line {}.",
                              normalised_.count, normalised_.count == 1 ? "is" : "es", normalised_.most,
                              normalised_.first_line));
  }
  if (long_dwells_.count > 0) {
    out.push_back(fmt::format(
        "{} dwell{} of up to {:g} s, the first in line {}: P counts in seconds here, on some controllers in ms.",
        long_dwells_.count, long_dwells_.count == 1 ? "" : "s", long_dwells_.most, long_dwells_.first_line));
  }
  if (operator_stops_.count > 0) {
    out.push_back(fmt::format(
        "{} stop{} for the operator (M0, M1), the first in line {}: the tool comes to rest there, and goes on at once "
        "in a trajectory.",
        operator_stops_.count, operator_stops_.count == 1 ? "" : "s", operator_stops_.first_line));
  }
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i].count == 0) continue;
    const CountText& text = count_texts[i];
    out.push_back(fmt::format("{} {}, the first in line {}{}.", counts_[i].count,
                              counts_[i].count == 1 ? text.one : text.many, counts_[i].first_line,
                              fmt::format(fmt::runtime(text.more), counts_[i].most)));
  }
  return out;
}

void ProgramRemarks::count(Count what, std::size_t line, double value) {
  if (!repeated_) counts_[static_cast<std::size_t>(what)].add(line, value);
}

void ProgramRemarks::assume(Assumption assumption) {
  add_assumed(assumed_, {std::move(assumption)});
}

std::vector<Assumption> ProgramRemarks::assumed() const {
  std::vector<Assumption> out = assumed_;
  if (no_center_point_.count > 0) {
    out.push_back(
        {.what = fmt::format("Positions with rotary axes turned, from line {} on", no_center_point_.first_line),
         .taken = "those of the tool's tip",
         .key = "G43.4, M128 or M428"});
  }
  if (mixed_points()) {
    out.push_back({.what = fmt::format("{} in line {}, without the point that other positions have", points_.whole_word,
                                       points_.whole_line),
                   .taken = whole_unit_ + ", where some controls count thousandths",
                   .key = fmt::format("{}.", points_.whole_word)});
  }
  return out;
}

std::optional<ProgramRemarks::MixedPoints> ProgramRemarks::mixed_points() const {
  return points_.point_line > 0 && points_.whole_line > 0 ? std::optional(points_) : std::nullopt;
}

void ProgramRemarks::coordinate(std::size_t line, std::string_view word, std::string_view unit) {
  const bool ends_in_point = word.ends_with('.');
  if (ends_in_point ? points_.point_line > 0 : points_.whole_line > 0) return;
  if (!ends_in_point && word.find('.') != std::string_view::npos) return;
  if (!ends_in_point && word.find_first_of("123456789") == std::string_view::npos) return;  // 0 is 0
  std::string& shown = ends_in_point ? points_.point_word : points_.whole_word;
  for (const char letter : word) shown += static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  (ends_in_point ? points_.point_line : points_.whole_line) = line;
  if (!ends_in_point) whole_unit_ = unit;
}

std::string printable(std::string_view text, std::size_t most) {
  std::string shown;
  for (const char letter : text.substr(0, most)) {
    const bool plain = letter >= 0x20 && letter < 0x7f;
    shown += plain ? std::string(1, letter) : fmt::format("\\x{:02x}", static_cast<unsigned char>(letter));
  }
  return shown;
}

ProgramReader::ProgramReader(std::string file, const ProgramReading& reading, ProgramRemarks& remarks)
    : file_(std::move(file)), reading_(reading), remarks_(remarks), tools_(reading.tool) {}

void ProgramReader::take(std::string_view line, char ahead) {
  ++count_;
  const Part part = part_of(line, ahead, continued_);
  if (!continued_) line_ = count_;
  if (!part.continues && !continued_) {
    read_counted(part.text);
    return;
  }
  joined_.append(part.text).push_back(' ');
  if (joined_.size() > ProgramLines::longest) {
    reject({}, std::nullopt, "", fmt::format("begins a statement of more than {} bytes", ProgramLines::longest));
  }
  continued_ = part.continues;
  if (!continued_) read_joined();
}

void ProgramReader::finish() {
  read_joined();
  at_end();
  note_passed(tools_.now().lines);
  check_chosen();
}

void ProgramReader::read_counted(std::string_view statement) {
  if (statement.find_first_not_of(" \t\r") != std::string_view::npos) tools_.count_statement();
  read(statement);
}

void ProgramReader::mount_tool(std::optional<int> number, std::string name) {
  if (tools_.is_mounted(number, name)) return;
  note_passed(tools_.now().lines - std::min<std::size_t>(tools_.now().lines, 1));
  tools_.mount(number, std::move(name), line_);
}

void ProgramReader::begin_part_move() {
  tools_.move(line_);
  const ToolPart* const other = tools_.between();
  if (other == nullptr) return;
  reject(tools_.now().name, std::nullopt, "",
         fmt::format("moves again in this line after {} (line {}) has moved: what that one cuts would be missing "
                     "between the two parts",
                     other->name, other->line),
         "program.tool_part = 1 in the cell reads the part before it alone, 2 the one that begins here");
}

void ProgramReader::note_passed(std::size_t lines) const {
  const ToolPart& part = tools_.now();
  if (!passes() || !part.moves) return;
  remarks_.skip(part.line, fmt::format("the part of {}, {} line{}", part.name, lines, lines == 1 ? "" : "s"));
}

void ProgramReader::check_chosen() const {
  const ToolChoice& chosen = reading_.tool;
  if (!chosen.given() || start_) return;
  std::vector<std::string> listed;
  std::size_t tools = 0;
  bool mounted = false;
  for (const NumberedPart& one : numbered_parts(tools_.parts())) {
    mounted = mounted || chosen.is(one.part.number, one.part.name);
    if (one.number > 1 || !one.part.can_be_chosen()) continue;
    ++tools;
    if (listed.size() < most_named_tools) listed.push_back(fmt::format("{} (line {})", one.part.name, one.part.line));
  }
  InvalidInput::Parts parts = {.where = file_};
  if (chosen.number) {
    parts.field = "program.tool";
    parts.number = *chosen.number;
  } else {
    parts.field = "program.tool_name";
    parts.value = fmt::format("\"{}\"", chosen.name);
  }
  const int moved = tools_.moved_parts();
  if (mounted && chosen.part && moved > 0 && *chosen.part > moved) {
    parts.field = "program.tool_part";
    parts.number = *chosen.part;
    parts.value = {};
    parts.rule = fmt::format("is no part of {}, which moves in {} part{}",
                             text_of({.number = chosen.number, .name = chosen.name}), moved, moved == 1 ? "" : "s");
  } else if (mounted) {
    parts.rule = "comes to no complete position: X, Y and Z after its change";
  } else if (listed.empty()) {
    parts.rule = "is no tool of this program, which names none";
    parts.hint = "Take the key out to read the whole program";
  } else {
    parts.rule = "is no tool of this program: it has " + list_text(listed, tools - listed.size());
  }
  throw InvalidInput(std::move(parts));
}

void ProgramReader::read_joined() {
  continued_ = false;
  if (joined_.empty()) return;
  read_counted(joined_);
  joined_.clear();
}

bool ProgramReader::pop(Block& out) {
  while (ready_ && passes()) ready_ = advance();
  if (!ready_) return false;
  out = block_;
  ready_ = advance();
  return true;
}

void ProgramReader::reject(std::string field, std::optional<double> number, const char* unit, std::string rule,
                           std::string hint) const {
  throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file_, line_),
                                         .field = std::move(field),
                                         .number = number,
                                         .unit = unit,
                                         .rule = std::move(rule),
                                         .hint = std::move(hint)});
}

void ProgramReader::reject_text(std::string field, std::string_view value, std::string rule, std::string hint) const {
  throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", file_, line_),
                                         .field = std::move(field),
                                         .value = fmt::format("\"{}\"", printable(value, 40)),
                                         .rule = std::move(rule),
                                         .hint = std::move(hint)});
}

void ProgramReader::check_coordinate(const char* name, double coordinate_m, double written, const char* unit) const {
  if (!(std::abs(coordinate_m) <= farthest_m)) reject(name, written, unit, "must lie within 1 km");
}

void ProgramReader::check_dwell(const char* name, double time_s, const char* hint) const {
  constexpr double day_s = 86400.0;
  if (!(time_s >= 0.0 && time_s <= day_s)) reject(name, time_s, "s", "must lie between 0 and a day", hint);
}

void ProgramReader::check_feed(const char* name, double feed) const {
  if (!(feed >= 0.0)) reject(name, feed, "", "must be > 0");
  if (!(feed <= fastest)) reject(name, feed, "", "is too large for any machine");
}

Eigen::Vector3d ProgramReader::unit_axis(const char* names, const Eigen::Vector3d& written) const {
  const double length = written.norm();
  const double error = std::abs(length - 1.0);
  if (!(error <= largest_length_error)) {
    reject(names, io::round_15(length), "", "must be a vector of length 1, within 1e-3", "It is the axis of the tool");
  }
  if (error > silent_length_error) remarks_.normalised(line_, error);
  return written / length;
}

double ProgramReader::turn_to(const Eigen::Vector3d& axis) const {
  const double turn = axis == pose_.axis ? 0.0 : angle_between(pose_.axis, axis);
  if (turn > largest_turn_rad) {
    reject("axis", io::round_15(turn / units::deg), "deg",
           "turns by half a circle in one move, which could go any way round", "Split the move");
  }
  return turn;
}

void ProgramReader::begin_at(const Pose& pose) {
  pose_ = pose;
  if (!passes()) start_ = pose;
}

bool ProgramReader::moves_to(const Pose& end) const {
  return end.tip_m != pose_.tip_m || end.axis != pose_.axis;
}

void ProgramReader::move(Block::Kind kind, const Pose& end, double duration_s, Deviation deviation) {
  block_ = {.kind = kind,
            .line = line_,
            .end = end,
            .duration_s = duration_s,
            .spindle_speed_rad_per_s = spindle_speed_rad_per_s_,
            .spindle = spindle_,
            .coolant = coolant_,
            .tip_deviation_m = deviation.tip_m,
            .axis_deviation_rad = deviation.axis_rad};
  pose_ = end;
  ready_ = true;
}

void ProgramReader::dwell(double duration_s, OperatorStop operator_stop) {
  move(Block::Kind::dwell, pose_, duration_s);
  block_.operator_stop = operator_stop;
  if (operator_stop != OperatorStop::none && !passes()) remarks_.operator_stop(line_);
}

void ProgramReader::begin_steps() {
  next_step_ = 0;
  ready_ = advance();
}

void ProgramReader::begin_return(const Pose& end, double height_m) {
  static_cast<void>(turn_to(end.axis));
  const auto lifted = [&](const Eigen::Vector3d& tip_m) { return Eigen::Vector3d(tip_m.x(), tip_m.y(), height_m); };
  steps_.clear();
  steps_.push_back({.tip_m = lifted(pose_.tip_m)});
  steps_.push_back({.tip_m = lifted(end.tip_m), .axis = end.axis});
  steps_.push_back({.tip_m = end.tip_m});
  begin_steps();
}

bool ProgramReader::take_step() {
  while (next_step_ < steps_.size()) {
    const MoveStep& step = steps_[next_step_++];
    if (step.spindle) spindle_ = *step.spindle;
    const Pose end = {.tip_m = step.tip_m, .axis = step.axis.value_or(pose_.axis)};
    if (step.kind == Block::Kind::dwell) {
      dwell(step.duration_s, step.stop);
      return true;
    }
    if (!moves_to(end)) continue;
    move(step.kind, end, step.duration_s, {.tip_m = step.tip_deviation_m, .axis_rad = 0.0});
    if (step.line > 0) block_.line = step.line;
    if (step.running) {
      block_.spindle_speed_rad_per_s = step.running->speed_rad_per_s;
      block_.spindle = step.running->spindle;
      block_.coolant = step.running->coolant;
    }
    return true;
  }
  return false;
}

}  // namespace robomill::program
