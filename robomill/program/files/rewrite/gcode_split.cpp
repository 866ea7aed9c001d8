// A move said by several lines: an arc, or one of turning axes.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/program/files/rewrite/gcode.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr std::string_view position_letters = "xyz";
constexpr std::string_view rotary_letters = "abc";
constexpr std::string_view vector_letters = "ijk";

/// What an M code does when the line's move has ended.
bool comes_late(double code) {
  const Mcode* const known = find_mcode(static_cast<int>(code));
  if (known == nullptr) return false;
  switch (known->act) {
    case McodeAct::end:
    case McodeAct::stop:
    case McodeAct::optional_stop:
    case McodeAct::spindle_off:
    case McodeAct::coolant_off:
    case McodeAct::through_tool_off:
      return true;
    default:
      return false;
  }
}

}  // namespace

void GcodeRewriter::say(const Statement& statement, char letter, const std::string& number, SplitLine& line,
                        Composed& composed) const {
  constexpr std::string_view placed = "xyzabcijk";
  const Word* const word = find(letter);
  const bool of_arc = statement.round && letter >= 'i' && letter <= 'k';  // has been removed
  if (!line.first) {
    line.text += " " + word_text(letter, number);
  } else if (word != nullptr && !of_arc) {
    set_number(statement, *word, number, composed);
  } else if (placed.find(letter) != std::string_view::npos) {
    add_axis(letter, number, composed);
  } else {
    add(letter, number, composed);
  }
}

void GcodeRewriter::split_tip(std::size_t index, const Piece& piece, Running& running, Composed& composed,
                              SplitLine& line) const {
  const Modes& modes = modes_[index];
  const double unit_m = modes.inches ? units::inch : units::mm;
  const Vector3d& begin_m = job().wanted.begin_of(piece.block).tip_m;
  const Vector3d& end_m = job().wanted.blocks[piece.block].end.tip_m;
  const Vector3d target_m = piece.end == 1.0 ? end_m : Vector3d(begin_m + piece.end * (end_m - begin_m));
  Digits digits = position_digits(unit_m);
  // A short piece of a way must not vanish in its digits.
  constexpr int most = 9;
  const double tenth_m = 0.1 * (piece.end - piece.begin) * (end_m - begin_m).norm();
  while (piece.end - piece.begin < 1.0 && digits.resolution() > tenth_m && digits.decimals < most) ++digits.decimals;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Word* const word = line.first ? find(position_letters[i]) : nullptr;
    const double origin_m = modes.origin_m[axis];
    const Coordinate to = coordinate(word != nullptr ? std::optional(word->number) : std::nullopt, target_m[axis],
                                     running.tip_m[axis], modes.incremental, digits, false, origin_m);
    running.tip_m[axis] = to.end;
    if (to.act != Coordinate::Act::keep) say(statements()[index], position_letters[i], to.text, line, composed);
  }
}

double GcodeRewriter::split_axis(std::size_t index, const Piece& piece, Running& running, Composed& composed,
                                 SplitLine& line) const {
  const Statement& statement = statements()[index];
  const Modes& modes = modes_[index];
  if (by_vector_) {
    const Vector3d from = running.axis;
    const Word* const word = line.first && !statement.round ? find('i') : nullptr;
    const Vector3d& target = job().wanted.blocks[piece.block].end.axis;
    if (word == nullptr && same_axis(target, from)) return 0.0;
    const AxisNumbers to = axis_numbers({}, target);
    for (std::size_t i = 0; i < 3; ++i) say(statement, vector_letters[i], to.texts[i], line, composed);
    running.axis = to.axis;
    return angle_between(from, to.axis) / units::deg;
  }
  const Vector3d from_deg = running.rotary_deg;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Word* const word = find(rotary_letters[i]);
    const Coordinate to =
        coordinate(line.first && word != nullptr ? std::optional(word->number) : std::nullopt, piece.rotary_deg[axis],
                   running.rotary_deg[axis], modes.incremental, {.decimals = rotary_decimals}, false);
    if (to.act == Coordinate::Act::keep) {
      running.rotary_deg[axis] = to.end;
      continue;
    }
    // The program's own number stays the end's.
    const bool own = line.last && !modes.incremental && word != nullptr && word->number == piece.rotary_deg[axis];
    running.rotary_deg[axis] = own ? word->number : to.end;
    say(statement, rotary_letters[i], own ? std::string(word->text.substr(1)) : to.text, line, composed);
  }
  return (running.rotary_deg - from_deg).norm();
}

void GcodeRewriter::split_rates(std::size_t index, const Piece& piece, const Motions& motions, Running& running,
                                Composed& composed, SplitLine& line) const {
  const Statement& statement = statements()[index];
  const Modes& modes = modes_[index];
  const Block& wanted = job().wanted.blocks[piece.block];
  const double rpm = wanted.spindle_speed_rad_per_s / units::rpm;
  const Word* const speed = line.first ? find('s') : nullptr;
  const double held_rpm = speed != nullptr ? speed->number : running.speed_rad_per_s / units::rpm;
  if (wanted.spindle != Spindle::off && !same_rate(held_rpm, rpm)) {
    say(statement, 's', significant_text(rpm, points_.speed), line, composed);
  }
  running.speed_rad_per_s = wanted.spindle_speed_rad_per_s;
  if (wanted.kind != Block::Kind::feed) return;

  const double share = piece.end - piece.begin;
  const double minutes = share * wanted.duration_s / units::minute;
  if (modes.feed_mode == GcodeReader::FeedMode::inverse_time) {
    say(statement, 'f', significant_text(1.0 / minutes, points_.feed), line, composed);
    return;
  }
  const double way_m = share * (wanted.end.tip_m - job().wanted.begin_of(piece.block).tip_m).norm();
  const bool stands = motions.stands();
  // What digits add to one piece of a block they take from the next.
  const double counted_m = share < 1.0 ? way_m : motions.counted_way_m(way_m);
  const double needed = (stands ? motions.turn_deg : counted_m / units::mm) / minutes;
  const Word* const word = line.first ? find('f') : nullptr;
  if (word != nullptr) {
    running.feed = word->number;
    running.feed_in_inches = modes.inches;
  }
  if (running.feed && same_rate(per_minute(*running.feed, running.feed_in_inches, stands), needed)) return;
  const std::string number = feed_text(needed, modes.inches, stands, word);
  double written = 0.0;
  std::from_chars(number.data(), number.data() + number.size(), written);
  running.feed = written;
  running.feed_in_inches = modes.inches;
  say(statement, 'f', number, line, composed);
}

// M codes that wait for the move's end go to its last line.
std::string GcodeRewriter::take_late_codes(const Statement& statement, Composed& composed) const {
  std::string late;
  for (const Word& word : words_) {
    if (word.letter != 'm' || !comes_late(word.number)) continue;
    late += " " + word_text('m', word.text.substr(1));
    remove(statement, word, composed);
  }
  return late;
}

Rewriter::Composed GcodeRewriter::split(std::size_t index, const std::vector<Piece>& pieces) const {
  const Statement& statement = statements()[index];
  const Modes held = out_->modes();
  const Motion motion = statement.round ? Motion::feed : modes_[index].motion;
  const std::string code = motion == Motion::rapid ? "0" : "1";
  Composed composed;
  if (const Word* const word = find_g(0.0, 3.0); word == nullptr) {
    if (held.motion != motion) add_first('g', code, composed);
  } else if (statement.round) {
    set_number(statement, *word, code, composed);
  }
  for (const Word& word : words_) {
    const bool of_arc = word.letter == 'r' || word.letter == 'p' || (word.letter >= 'i' && word.letter <= 'k');
    if (statement.round && of_arc) remove(statement, word, composed);
  }
  Running running = {.tip_m = out_->pose().tip_m,
                     .axis = out_->pose().axis,
                     .rotary_deg = held.rotary_deg,
                     .speed_rad_per_s = out_->spindle_speed_rad_per_s(),
                     .feed = held.feed,
                     .feed_in_inches = held.feed_in_inches};
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    SplitLine line = {.first = i == 0, .last = i + 1 == pieces.size(), .text = word_text('g', code)};
    const Vector3d from_m = running.tip_m;
    split_tip(index, pieces[i], running, composed, line);
    const double turn_deg = split_axis(index, pieces[i], running, composed, line);
    const Motions motions = {.way_m = (running.tip_m - from_m).norm(), .turn_deg = turn_deg};
    split_rates(index, pieces[i], motions, running, composed, line);
    if (!line.first) composed.after.push_back(line.text);
  }
  if (!composed.after.empty()) composed.after.back() += take_late_codes(statement, composed);
  return composed;
}

}  // namespace robomill::program
