// A move of several blocks, an arc or one of turning axes, said by a line for each of them.
#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/program/files/rewrite_gcode.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr std::string_view position_letters = "xyz";
constexpr std::string_view rotary_letters = "abc";
constexpr int rotary_decimals = 7;  ///< of a degree

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

void GcodeRewriter::split_axes(std::size_t index, const Move& move, std::size_t part, Running& running,
                               Composed& composed, std::string& line) const {
  const Statement& statement = statements()[index];
  const Modes& modes = modes_[index];
  const double unit_m = modes.inches ? units::inch : units::mm;
  const Vector3d target_m = job().wanted.blocks[move.first + part].end.tip_m;
  const auto say = [&](char letter, const Word* word, const std::string& number) {
    if (part > 0) {
      line += " " + word_text(letter, number);
    } else if (word != nullptr) {
      set_number(statement, *word, number, composed);
    } else {
      add_axis(letter, number, composed);
    }
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Word* const word = part == 0 ? find(position_letters[i]) : nullptr;
    const Coordinate to = coordinate(word != nullptr ? std::optional(word->number) : std::nullopt, target_m[axis],
                                     running.tip_m[axis], modes.incremental, unit_m, false);
    running.tip_m[axis] = to.end_m;
    if (to.act != Coordinate::Act::keep) say(position_letters[i], word, to.text);
  }
  const Vector3d begin_deg = modes_before(index).rotary_deg;
  const double share = static_cast<double>(part + 1) / static_cast<double>(move.count);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Word* const word = find(rotary_letters[i]);
    if (word == nullptr) continue;
    const double angle_deg = begin_deg[axis] + share * (modes.rotary_deg[axis] - begin_deg[axis]);
    const bool last = part + 1 == move.count;
    const double base_deg = modes.incremental ? running.rotary_deg[axis] : 0.0;
    const std::string number = last && !modes.incremental
                                   ? std::string(word->text.substr(1))
                                   : decimal_text(angle_deg - base_deg, rotary_decimals, points_.position);
    double written = 0.0;
    std::from_chars(number.data(), number.data() + number.size(), written);
    running.rotary_deg[axis] = base_deg + written;
    say(rotary_letters[i], word, number);
  }
}

void GcodeRewriter::split_rates(std::size_t index, const Move& move, std::size_t part, double way_m, Running& running,
                                Composed& composed, std::string& line) const {
  const Statement& statement = statements()[index];
  const Modes& modes = modes_[index];
  const Block& wanted = job().wanted.blocks[move.first + part];
  const auto say = [&](char letter, const std::string& number) {
    const Word* const word = find(letter);
    if (part > 0) {
      line += " " + word_text(letter, number);
    } else if (word != nullptr) {
      set_number(statement, *word, number, composed);
    } else {
      add(letter, number, composed);
    }
  };
  const double rpm = wanted.spindle_speed_rad_per_s / units::rpm;
  const Word* const speed = part == 0 ? find('s') : nullptr;
  const double held_rpm = speed != nullptr ? speed->number : running.speed_rad_per_s / units::rpm;
  if (wanted.spindle != Spindle::off && !same_rate(held_rpm, rpm)) say('s', significant_text(rpm, points_.speed));
  running.speed_rad_per_s = wanted.spindle_speed_rad_per_s;
  if (!move.at_feed) return;

  const double minutes = wanted.duration_s / units::minute;
  if (modes.feed_mode == GcodeReader::FeedMode::inverse_time) {
    say('f', significant_text(1.0 / minutes, points_.feed));
    return;
  }
  const double wanted_way_m = (wanted.end.tip_m - job().wanted.begin_of(move.first + part).tip_m).norm();
  const bool stands = way_m == 0.0;
  const double needed =
      (stands ? turn_deg(index) / static_cast<double>(move.count) : wanted_way_m / units::mm) / minutes;
  const Word* const word = part == 0 ? find('f') : nullptr;
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
  say('f', number);
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

Rewriter::Composed GcodeRewriter::split(std::size_t index, const Move& move) const {
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
                     .rotary_deg = held.rotary_deg,
                     .speed_rad_per_s = out_->spindle_speed_rad_per_s(),
                     .feed = held.feed,
                     .feed_in_inches = held.feed_in_inches};
  for (std::size_t part = 0; part < move.count; ++part) {
    std::string line = word_text('g', code);
    const Vector3d from_m = running.tip_m;
    split_axes(index, move, part, running, composed, line);
    split_rates(index, move, part, (running.tip_m - from_m).norm(), running, composed, line);
    if (part > 0) composed.after.push_back(line);
  }
  if (!composed.after.empty()) composed.after.back() += take_late_codes(statement, composed);
  return composed;
}

}  // namespace robomill::program
