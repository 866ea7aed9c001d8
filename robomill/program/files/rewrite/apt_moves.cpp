// Arcs, drilling cycles and retracts of an APT program that is rewritten.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "robomill/io/text.hpp"
#include "robomill/program/files/rewrite/apt.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr double same_tip_m = 1e-10;

}  // namespace

bool AptRewriter::is_unmoved(std::size_t index) const {
  const Statement& statement = statements()[index];
  const auto same = [](const Pose& a, const Pose& b) {
    return (a.tip_m - b.tip_m).norm() <= same_tip_m && same_axis(a.axis, b.axis);
  };
  if (!same(job().wanted.begin_of(statement.first_block), job().as_read.begin_of(statement.first_block))) return false;
  for (std::size_t i = statement.first_block; i < statement.first_block + statement.blocks; ++i) {
    if (!same(job().wanted.blocks[i].end, job().as_read.blocks[i].end)) return false;
  }
  return true;
}

void AptRewriter::check_unmoved(std::size_t index, const char* what) const {
  if (is_unmoved(index)) return;
  reject(statements()[index].line, word_, fmt::format("cannot be moved: its positions {}", what),
         "Let the CAM system write its moves as GOTO/");
}

bool AptRewriter::stays_round(std::size_t index) const {
  if (!is_unmoved(index)) return false;
  const Statement& statement = statements()[index];
  const Move move = move_of(statement);
  constexpr double one_feed = 0.5e-5;
  const Block& first = job().wanted.blocks[statement.first_block];
  for (std::size_t i = statement.first_block; i < statement.first_block + statement.blocks; ++i) {
    const Block& block = job().wanted.blocks[i];
    const double part_s = move.time_s / static_cast<double>(move.count);
    if (move.at_feed && !near_rate(block.duration_s, part_s, one_feed)) return false;
    const bool turns = block.spindle != Spindle::off;
    if (turns && !same_rate(block.spindle_speed_rad_per_s, first.spindle_speed_rad_per_s)) return false;
  }
  return true;
}

void AptRewriter::comment_out(const Statement& statement, Composed& composed) const {
  const std::string_view text = raw(statement);
  for (std::size_t at = 0; at < text.size();) {
    composed.edits.push_back({.begin = statement.begin + at, .end = statement.begin + at, .text = "$$ "});
    at = text.find_first_of("\r\n", at);
    if (at == std::string_view::npos) return;
    at += text.substr(at).starts_with("\r\n") ? 2 : 1;
  }
}

void AptRewriter::compose_opener(std::size_t index, Composed& composed) {
  const std::vector<std::size_t>& makers = arcs_.at(index);
  if (std::ranges::all_of(makers, [this](std::size_t maker) { return stays_round(maker); })) {
    add_speed(makers.front(), composed);
    add_feed(makers.front(), composed);
  } else {
    comment_out(statements()[index], composed);
  }
}

void AptRewriter::compose_arc(std::size_t index, Composed& composed) {
  const std::vector<std::size_t>& makers = arcs_.at(openers_[index]);
  if (std::ranges::all_of(makers, [this](std::size_t maker) { return stays_round(maker); })) {
    add_speed(index, composed);
    add_feed(index, composed);
  } else {
    set_chords(index, composed);
  }
}

std::string AptRewriter::chord_numbers(std::size_t index, const Pose& target, Pose& at) const {
  const Digits digits = position_digits(unit_m(index));
  std::vector<std::string> texts;
  for (Eigen::Index i = 0; i < 3; ++i) {
    texts.push_back(decimal_text(target.tip_m[i] / unit_m(index), digits.decimals, points_.position));
    at.tip_m[i] = io::parse_number(texts.back()).value() * unit_m(index);
  }
  const Vector3d plain = modes_[index].plain_axis.value_or(at.axis);
  at.axis = plain;
  if (!same_axis(plain, target.axis)) {
    check_says_axis(statements()[index].line);
    const AxisNumbers to = axis_numbers({}, target.axis);
    texts.insert(texts.end(), to.texts.begin(), to.texts.end());
    at.axis = to.axis;
  }
  return fmt::format("{}", fmt::join(texts, ","));
}

void AptRewriter::set_last_chord(std::size_t index, const Pose& target, const Pose& at, Composed& composed) {
  const Statement& statement = statements()[index];
  const Digits digits = position_digits(unit_m(index));
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Coordinate to =
        coordinate(io::parse_number(fields_[i].text), target.tip_m[axis], at.tip_m[axis], false, digits, false);
    if (to.act != Coordinate::Act::keep) set_field(statement, fields_[i], to.text, composed);
  }
  if (count_numbers() >= 6) {
    Vector3d numbers;
    for (std::size_t i = 0; i < 3; ++i) {
      numbers[static_cast<Eigen::Index>(i)] = io::parse_number(fields_[3 + i].text).value();
    }
    const AxisNumbers to = axis_numbers(numbers, target.axis);
    axis_ = to.written;
    for (std::size_t i = 0; i < 3 && !to.keep; ++i) set_field(statement, fields_[3 + i], to.texts[i], composed);
  } else if (!same_axis(modes_[index].plain_axis.value_or(at.axis), target.axis)) {
    check_says_axis(statement.line);
    const AxisNumbers to = axis_numbers({}, target.axis);
    axis_ = to.written;
    const std::size_t end = place_of_field(statement, fields_[2]) + (fields_[2].end - fields_[2].begin);
    composed.edits.push_back({.begin = end, .end = end, .text = fmt::format(",{}", fmt::join(to.texts, ","))});
  }
}

void AptRewriter::set_chords(std::size_t index, Composed& composed) {
  const Statement& statement = statements()[index];
  if (modes_[index].moved_frame) check_unmoved(index, "count in another system than the first ones");
  const bool is_goto = word_ == "GOTO";
  if (!statement.moves_at_feed) {
    reject(statement.line, word_, "ends an arc at rapid, which cannot be moved", "Write it as straight moves");
  }
  if (!is_goto) comment_out(statement, composed);
  std::vector<std::string>& lines = is_goto ? composed.before : composed.after;
  const AptReader::Modes modes = out_.modes();
  AptReader::FeedRate held = {
      .value = modes.feed, .inches = modes.feed_in_inches, .per_revolution = modes.feed_per_revolution};
  speed_rad_per_s_ = out_.spindle_speed_rad_per_s();
  Pose at = out_.pose();
  const std::size_t last = statement.first_block + statement.blocks;
  for (std::size_t i = statement.first_block; i < last; ++i) {
    const Block& wanted = job().wanted.blocks[i];
    if (wanted.spindle != Spindle::off) {
      std::string line = speed_line(statement, i, speed_rad_per_s_);
      if (!line.empty()) lines.push_back(std::move(line));
      speed_rad_per_s_ = wanted.spindle_speed_rad_per_s;
    }
    const double way_m = (wanted.end.tip_m - job().wanted.begin_of(i).tip_m).norm();
    const Feed needed = {.per_minute = way_m / units::mm / (wanted.duration_s / units::minute)};
    std::string line = feed_line(index, needed, held, speed_rad_per_s_ / units::rpm);
    if (!line.empty()) lines.push_back(std::move(line));
    if (is_goto && i + 1 == last) {
      set_last_chord(index, wanted.end, at, composed);
    } else {
      lines.push_back("GOTO/" + chord_numbers(index, wanted.end, at));
    }
  }
}

std::optional<double> AptRewriter::needed_cycle_feed(std::size_t index) const {
  const Statement& statement = statements()[index];
  const std::optional<AptReader::FeedRate>& feed = modes_[index].cycle_feed;
  std::optional<double> ratio;
  for (std::size_t i = statement.first_block; i < statement.first_block + statement.blocks; ++i) {
    const Block& read = job().as_read.blocks[i];
    const Block& wanted = job().wanted.blocks[i];
    if (read.kind != Block::Kind::feed) continue;
    double here = read.duration_s / wanted.duration_s;
    if (feed && feed->per_revolution) here *= read.spindle_speed_rad_per_s / wanted.spindle_speed_rad_per_s;
    if (!ratio) ratio = here;
    if (same_rate(here, *ratio)) continue;
    reject(statement.line, "feed", "must be one for all moves of the drilling cycle that this line says",
           "The cycle has one feed");
  }
  if (!ratio || same_rate(*ratio, 1.0)) return feed && ratio ? std::optional(feed->value) : std::nullopt;
  if (!feed) {
    reject(statement.line, "feed", "cannot be changed where a drilling cycle takes that of FEDRAT/",
           "Give the cycle a feed of its own");
  }
  return feed->value * *ratio;
}

const AptRewriter::Field& AptRewriter::cycle_feed_field(std::size_t index) const {
  const double value = modes_[index].cycle_feed->value;
  const auto unit = std::ranges::find_if(fields_, [](const Field& field) {
    return field.text == "MMPM" || field.text == "IPM" || field.text == "MMPR" || field.text == "IPR";
  });
  if (unit != fields_.end()) {
    const auto says = [&](const Field& field) { return io::parse_number(field.text) == value; };
    if (unit + 1 != fields_.end() && says(*(unit + 1))) return *(unit + 1);
    if (says(*(unit - 1))) return *(unit - 1);
  }
  reject(statements()[index].line, "CYCLE", "says its feed in a way that cannot be changed", "Give it as MMPM or IPM");
}

void AptRewriter::set_said_cycle(std::size_t index, Composed& composed) {
  for (std::size_t i = index + 1; i < statements().size() && cycles_[i] == index; ++i) {
    if (modes_[i].made != AptReader::Made::moves || !modes_[i].cycle_feed) continue;
    const std::optional<double> needed = needed_cycle_feed(i);
    if (!needed) continue;
    if (same_rate(*needed, modes_[index].cycle_feed->value)) return;
    const Field& field = cycle_feed_field(index);
    set_field(statements()[index], field, significant_text(*needed, field.text.find('.') != std::string::npos),
              composed);
    return;
  }
}

void AptRewriter::compose_moves(std::size_t index, Composed& composed) {
  check_unmoved(index, "are those of a drilling cycle or a retract");
  check_one_speed(statements()[index], "SPINDL");
  add_speed(index, composed);
  const std::optional<double> needed = needed_cycle_feed(index);
  const std::optional<AptReader::FeedRate> held = out_.modes().cycle_feed;
  if (!needed || !held || same_rate(*needed, held->value)) return;
  const std::size_t cycle = cycles_[index];
  split(statements()[cycle]);
  const Field& field = cycle_feed_field(cycle);
  std::string line(joined_text_);
  line.replace(field.begin, field.end - field.begin,
               significant_text(*needed, field.text.find('.') != std::string::npos));
  composed.before.emplace_back(io::trimmed(line));
}

}  // namespace robomill::program
