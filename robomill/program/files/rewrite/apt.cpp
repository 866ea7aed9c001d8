#include "robomill/program/files/rewrite/apt.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <span>
#include <utility>

#include "robomill/io/text.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

bool is_apt_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

bool begins_with_letter(std::string_view field) {
  return !field.empty() && ((field.front() >= 'A' && field.front() <= 'Z'));
}

}  // namespace

void AptRewriter::split(const Statement& statement) {
  joined_text_ = join(statement);
  const std::string_view text = joined_text_;
  const auto plain = [&](std::size_t begin, std::size_t end) {
    std::string out;
    for (std::size_t i = begin; i < end; ++i) {
      const char c = text[i];
      if (!is_apt_blank(c)) out += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    }
    return out;
  };
  fields_.clear();
  const std::size_t slash = std::min(text.find('/'), text.size());
  word_ = plain(0, slash);
  if (const std::size_t end = word_.find(')'); end != std::string::npos && end < word_.find('('))
    word_.erase(0, end + 1);
  for (std::size_t at = slash + 1; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    Field field = {.begin = at, .end = comma, .text = plain(at, comma)};
    while (field.begin < field.end && is_apt_blank(text[field.begin])) ++field.begin;
    while (field.end > field.begin && is_apt_blank(text[field.end - 1])) --field.end;
    fields_.push_back(std::move(field));
    at = comma + 1;
  }
}

const AptRewriter::Field* AptRewriter::number_field() const {
  const Field* number = nullptr;
  for (const Field& field : fields_) {
    if (field.text.empty() || begins_with_letter(field.text)) continue;
    if (number != nullptr) return nullptr;
    number = &field;
  }
  return number;
}

bool AptRewriter::says_speed() const {
  const bool known = std::ranges::all_of(fields_, [this](const Field& field) {
    if (field.text.empty()) return &field == &fields_.back();
    return !begins_with_letter(field.text) || field.text == "RPM" || field.text == "CLW" || field.text == "CCLW";
  });
  return word_ == "SPINDL" && known && number_field() != nullptr;
}

void AptRewriter::note(Statement& statement) {
  modes_.push_back(in_.modes());
  const AptReader::Modes& modes = modes_.back();
  split(statement);
  if (word_ == "GOTO" || word_ == "FROM" || word_ == "GODLTA") {
    for (std::size_t i = 0; i < std::min<std::size_t>(fields_.size(), 3); ++i) {
      if (fields_[i].text.find_first_of("ED") == std::string::npos) note_position(fields_[i].text);
    }
    says_axes_ = says_axes_ || count_numbers() > 3;
  }
  const bool point = std::ranges::any_of(fields_, [](const Field& f) { return f.text.find('.') != std::string::npos; });
  const std::size_t index = modes_.size() - 1;
  if (word_ == "CIRCLE" || word_ == "MOVARC" || word_ == "INDIRV" || word_ == "INDIRP") last_opener_ = index;
  if (word_ == "CYCLE" && modes.cycle_feed && fields_.size() > 1) last_cycle_ = index;
  const bool round = modes.made == AptReader::Made::arc;
  openers_.push_back(round ? last_opener_ : none);
  cycles_.push_back(last_cycle_);
  if (round && last_opener_ != none) arcs_[last_opener_].push_back(index);
  statement.round = round;
  statement.says_feed = word_ == "FEDRAT";
  statement.says_speed = says_speed();
  statement.passes = modes.passes;
  statement.takes_speed = statement.takes_feed = modes.passes && word_.starts_with("GO");
  if (statement.says_feed) points_.feed = points_.feed || point;
  if (statement.says_speed) points_.speed = points_.speed || point;
  const bool feeds =
      std::ranges::any_of(std::span(job().as_read.blocks).subspan(statement.first_block, statement.blocks),
                          [](const Block& block) { return block.kind == Block::Kind::feed; });
  // A hole whose cycle says no feed takes FEDRAT's, which moves behind it cannot change then.
  statement.breaks_feed = modes.made == AptReader::Made::moves && !modes.cycle_feed && feeds;
  const Move move = move_of(statement);
  if (move.count == 0 || !move.at_feed || modes.made == AptReader::Made::moves) return;
  statement.moves_at_feed = true;
  const double rpm = in_.spindle_speed_rad_per_s() / units::rpm;
  statement.per_minute = modes.feed * (modes.feed_per_revolution ? rpm : 1.0);
  if (modes.feed_in_inches && (round || move.read_way_m > 0.0)) statement.per_minute *= units::inch / units::mm;
}

std::size_t AptRewriter::place_of_field(const Statement& statement, const Field& field) const {
  const std::optional<std::size_t> place = place_of(field.begin, field.end);
  if (place) return *place;
  reject(statement.line, word_, "has a number over two lines, which cannot be changed", "Write it on one");
}

void AptRewriter::set_field(const Statement& statement, const Field& field, std::string text,
                            Composed& composed) const {
  const std::size_t place = place_of_field(statement, field);
  composed.edits.push_back({.begin = place, .end = place + (field.end - field.begin), .text = std::move(text)});
}

std::size_t AptRewriter::count_numbers() const {
  const bool ends_empty = !fields_.empty() && fields_.back().text.empty();
  return fields_.size() - (ends_empty ? 1 : 0);
}

void AptRewriter::set_ends(std::size_t index, Composed& composed) {
  const Statement& statement = statements()[index];
  const Move move = move_of(statement);
  const Vector3d from_m = out_.pose().tip_m;
  const bool stays = !statement.starts && (move.count == 0 || move.still());
  if (modes_[index].moved_frame) {
    check_unmoved(index, "count in another system than the first ones");
    motions_.way_m = move.way_m;
    return;
  }
  Vector3d end_m = from_m;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double target_m = stays ? from_m[axis] : statement.starts ? job().wanted.start.tip_m[axis] : move.end_m[axis];
    const Coordinate to = coordinate(io::parse_number(fields_[i].text), target_m, from_m[axis], false,
                                     position_digits(unit_m(index)), stays);
    if (to.act != Coordinate::Act::keep) set_field(statement, fields_[i], to.text, composed);
    end_m[axis] = to.end;
  }
  motions_.way_m = (end_m - from_m).norm();
}

void AptRewriter::check_says_axis(std::size_t line) const {
  if (multax_.value_or(says_axes_)) return;
  reject(line, word_,
         "cannot say a tool axis: " +
             std::string(multax_ ? "MULTAX is off here" : "the program has no MULTAX, and no position with its axis"),
         "Let the CAM system write the program for five axes, with MULTAX/ON");
}

void AptRewriter::set_axis(std::size_t index, Composed& composed) {
  const Statement& statement = statements()[index];
  const Move move = move_of(statement);
  if (modes_[index].moved_frame) {
    motions_.turn_deg = move.count > 0 ? turn_deg(index) : 0.0;
    return;
  }
  const Vector3d from = out_.pose().axis;
  const Vector3d plain = out_.modes().plain_axis.value_or(from);  // of a position that says none
  const Vector3d target = wanted_axis(statement, move);
  const bool stays = !statement.starts && move.count == 0;
  if (count_numbers() < 6) {
    motions_.turn_deg = angle_between(from, target) / units::deg;
    if (same_axis(plain, target)) return;
    check_says_axis(statement.line);
    const AxisNumbers to = axis_numbers({}, target);
    axis_ = to.written;
    motions_.turn_deg = angle_between(from, to.axis) / units::deg;
    const std::size_t end = place_of_field(statement, fields_[2]) + (fields_[2].end - fields_[2].begin);
    composed.edits.push_back({.begin = end, .end = end, .text = fmt::format(",{}", fmt::join(to.texts, ","))});
    return;
  }
  Vector3d numbers;
  for (std::size_t i = 0; i < 3; ++i)
    numbers[static_cast<Eigen::Index>(i)] = io::parse_number(fields_[3 + i].text).value();
  AxisNumbers to = axis_numbers(numbers, target);
  // What moves nothing says the very axis of the position before it.
  if (stays && to.axis != from) to = {.keep = false, .texts = exact_texts(axis_), .written = axis_, .axis = from};
  axis_ = to.written;
  motions_.turn_deg = angle_between(from, to.axis) / units::deg;
  for (std::size_t i = 0; i < 3 && !to.keep; ++i) set_field(statement, fields_[3 + i], to.texts[i], composed);
}

void AptRewriter::set_position(std::size_t index, const Vector3d& axis, Composed& composed) {
  const Statement& statement = statements()[index];
  const Move move = move_of(statement);
  check_says_axis(statement.line);
  const AxisNumbers to = axis_numbers({}, axis);
  motions_.turn_deg = angle_between(out_.pose().axis, to.axis) / units::deg;
  axis_ = to.written;
  std::array<std::string, 3> numbers;
  for (std::size_t i = 0; i < 3; ++i) {
    numbers[i] = decimal_text(move.end_m[static_cast<Eigen::Index>(i)] / unit_m(index),
                              position_digits(unit_m(index)).decimals, points_.position);
  }
  const std::size_t slash = joined_text_.find('/');
  std::size_t begin = slash;
  while (begin > 0 && (is_apt_blank(joined_text_[begin - 1]) ||
                       std::isalpha(static_cast<unsigned char>(joined_text_[begin - 1])) != 0))
    --begin;
  while (is_apt_blank(joined_text_[begin])) ++begin;
  const bool small = joined_text_[begin] == 'g';
  set_field(statement, {.begin = begin, .end = slash, .text = {}}, small ? "goto" : "GOTO", composed);
  numbers[2] += fmt::format(",{}", fmt::join(to.texts, ","));
  if (count_numbers() == 3) {
    for (std::size_t i = 0; i < 3; ++i) set_field(statement, fields_[i], numbers[i], composed);
  } else {
    set_field(statement, fields_[0], fmt::format("{}", fmt::join(numbers, ",")), composed);
  }
}

void AptRewriter::set_step(std::size_t index, Composed& composed) {
  const Statement& statement = statements()[index];
  const Move move = move_of(statement);
  if (move.count == 0) return;
  motions_.way_m = move.way_m;
  if (modes_[index].moved_frame) {
    check_unmoved(index, "count in another system than the first ones");
    return;
  }
  if (const Vector3d axis = wanted_axis(statement, move); !same_axis(axis, out_.pose().axis)) {
    set_position(index, axis, composed);
    return;
  }
  const Vector3d from_m = out_.pose().tip_m;
  // A step along the axis stays where it brings the tip near enough; else it becomes one of three numbers.
  const bool along_axis = count_numbers() < 3;
  const Digits digits = position_digits(unit_m(index));
  const double step_m = along_axis ? io::parse_number(fields_[0].text).value() * unit_m(index) : 0.0;
  const Vector3d kept_m = from_m + step_m * out_.pose().axis;
  if (along_axis && (kept_m - move.end_m).cwiseAbs().maxCoeff() <= 0.5 * digits.resolution()) return;
  std::array<std::string, 3> steps;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const std::optional<double> number = along_axis ? std::nullopt : io::parse_number(fields_[i].text);
    const Coordinate to = coordinate(number, move.end_m[axis], from_m[axis], true, digits, false);
    steps[i] = to.act == Coordinate::Act::keep ? "0" : to.text;
    if (!along_axis && to.act != Coordinate::Act::keep) set_field(statement, fields_[i], to.text, composed);
  }
  if (along_axis) set_field(statement, fields_[0], fmt::format("{},{},{}", steps[0], steps[1], steps[2]), composed);
}

void AptRewriter::keep_template(std::size_t index, std::optional<Template>& kept) const {
  const Field& number = *number_field();
  std::string_view text = joined_text_;
  // Without its label.
  const std::size_t end = text.find(')');
  const std::size_t begin =
      end != std::string_view::npos && end < std::min(text.find('('), text.find('/')) ? end + 1 : 0;
  Template found = {.before = std::string(text.substr(begin, number.begin - begin)),
                    .behind = std::string(text.substr(number.end)),
                    .inches = modes_[index].feed_in_inches,
                    .per_revolution = modes_[index].feed_per_revolution};
  found.before.erase(0, std::min(found.before.find_first_not_of(" \t"), found.before.size()));
  while (!found.behind.empty() && is_apt_blank(found.behind.back())) found.behind.pop_back();
  for (const Field& field : fields_) {
    if (field.text == "CCLW") found.direction = Spindle::counterclockwise;
    const bool unit = field.text == "MMPM" || field.text == "IPM" || field.text == "MMPR" || field.text == "IPR";
    found.unit_said = found.unit_said || unit;
  }
  kept = std::move(found);
}

double AptRewriter::said(double per_minute, bool inches, bool degrees, bool per_revolution, double rpm) {
  if (inches && !degrees) per_minute /= units::inch / units::mm;
  return per_revolution ? per_minute / rpm : per_minute;
}

void AptRewriter::set_said_feed(std::size_t index, Composed& composed) {
  const Statement& statement = statements()[index];
  const Field* const field = number_field();
  if (field == nullptr) return;
  keep_template(index, feed_template_);
  const std::optional<AptReader::FeedRate> cycle = modes_[index].cycle_feed ? out_.modes().cycle_feed : std::nullopt;
  if (cycle) {
    // Within a cycle it says the cycle's own feed again.
    const bool same_unit =
        cycle->inches == modes_[index].feed_in_inches && cycle->per_revolution == modes_[index].feed_per_revolution;
    if (same_unit && !same_rate(cycle->value, modes_[index].feed)) {
      set_field(statement, *field, significant_text(cycle->value, field->text.find('.') != std::string::npos),
                composed);
    }
    return;
  }
  if (statement.feeds == none) return;
  const Feed needed = needed_feed(statement.feeds);
  const AptReader::Modes& modes = modes_[index];
  const double rpm = modes.feed_per_revolution ? wanted_rpm(statements()[statement.feeds].first_block) : 1.0;
  const double value = said(needed.per_minute, modes.feed_in_inches, needed.degrees, modes.feed_per_revolution, rpm);
  if (same_rate(value, modes.feed)) return;
  set_field(statement, *field, significant_text(value, field->text.find('.') != std::string::npos), composed);
}

void AptRewriter::set_said_speed(std::size_t index, Composed& composed) {
  const Statement& statement = statements()[index];
  keep_template(index, speed_template_);
  const std::size_t block = first_turning(statement.first_block, statement.speed_until);
  if (block == none) return;
  if (same_rate(job().as_read.blocks[block].spindle_speed_rad_per_s,
                job().wanted.blocks[block].spindle_speed_rad_per_s)) {
    return;
  }
  const Field& field = *number_field();
  set_field(statement, field, significant_text(wanted_rpm(block), field.text.find('.') != std::string::npos), composed);
}

std::string AptRewriter::speed_line(const Statement& statement, std::size_t block, double held_rad_per_s) const {
  if (block == none || same_rate(held_rad_per_s / units::rpm, wanted_rpm(block))) return {};
  const Spindle direction = job().as_read.blocks[block].spindle;
  if (direction == Spindle::not_given) {
    reject(statement.line, "SPINDL", "cannot be changed where the program has not turned its spindle on",
           "Give the program a SPINDL/ before this line");
  }
  const std::string number = significant_text(wanted_rpm(block), points_.speed);
  const bool alike = speed_template_ && speed_template_->direction == direction;
  return alike ? speed_template_->before + number + speed_template_->behind
               : fmt::format("SPINDL/{},RPM,{}", number, direction == Spindle::clockwise ? "CLW" : "CCLW");
}

void AptRewriter::add_speed(std::size_t index, Composed& composed) {
  const Statement& statement = statements()[index];
  const std::size_t block = first_turning(statement.first_block, statement.first_block + statement.blocks);
  speed_rad_per_s_ = out_.spindle_speed_rad_per_s();
  std::string line = speed_line(statement, block, speed_rad_per_s_);
  if (line.empty()) return;
  speed_rad_per_s_ = job().wanted.blocks[block].spindle_speed_rad_per_s;
  composed.before.push_back(std::move(line));
}

std::string AptRewriter::feed_line(std::size_t index, const Feed& needed, AptReader::FeedRate& held, double rpm) const {
  const double value = said(needed.per_minute, held.inches, needed.degrees, held.per_revolution, rpm);
  if (same_rate(value, held.value)) return {};
  const std::optional<Template>& like = feed_template_;
  const bool alike = like && (like->unit_said || like->inches == modes_[index].inches);
  held = {.inches = alike ? like->inches : modes_[index].inches, .per_revolution = alike && like->per_revolution};
  held.value = said(needed.per_minute, held.inches, needed.degrees, held.per_revolution, rpm);
  const std::string number = significant_text(held.value, points_.feed);
  return alike ? like->before + number + like->behind
               : fmt::format("FEDRAT/{},{}", number, held.inches ? "IPM" : "MMPM");
}

void AptRewriter::add_feed(std::size_t index, Composed& composed) {
  if (!statements()[index].moves_at_feed) return;
  const AptReader::Modes modes = out_.modes();
  AptReader::FeedRate held = {
      .value = modes.feed, .inches = modes.feed_in_inches, .per_revolution = modes.feed_per_revolution};
  std::string line = feed_line(index, needed_feed(index, motions_), held, speed_rad_per_s_ / units::rpm);
  if (!line.empty()) composed.before.push_back(std::move(line));
}

Rewriter::Composed AptRewriter::compose_passed(std::size_t index) const {
  Composed composed;
  if (!leaves_part(index)) return composed;
  check_left_as_read(index);
  const AptReader::Modes& read = modes_[index - 1];
  const AptReader::Modes held = out_.modes();
  const Carried carried = carried_from(index);
  if (carried.speed && read.spindle != Spindle::off && !same_rate(read.speed_rad_per_s, held.speed_rad_per_s)) {
    composed.before.push_back(fmt::format("SPINDL/{},RPM,{}",
                                          significant_text(read.speed_rad_per_s / units::rpm, points_.speed),
                                          read.spindle == Spindle::counterclockwise ? "CCLW" : "CLW"));
  }
  const bool same_feed = same_rate(read.feed, held.feed) && read.feed_in_inches == held.feed_in_inches &&
                         read.feed_per_revolution == held.feed_per_revolution;
  if (carried.feed && read.feed > 0.0 && !same_feed) {
    const char* const unit =
        read.feed_per_revolution ? (read.feed_in_inches ? "IPR" : "MMPR") : (read.feed_in_inches ? "IPM" : "MMPM");
    composed.before.push_back(fmt::format("FEDRAT/{},{}", significant_text(read.feed, points_.feed), unit));
  }
  return composed;
}

Rewriter::Composed AptRewriter::compose(std::size_t index) {
  const Statement& statement = statements()[index];
  split(statement);
  if (word_ == "MULTAX") multax_ = count_numbers() == 0 || fields_[0].text != "OFF";
  if (statement.passes) return compose_passed(index);
  Composed composed;
  motions_ = {};
  if (arcs_.contains(index)) {
    compose_opener(index, composed);
    return composed;
  }
  if (modes_[index].made == AptReader::Made::arc) {
    compose_arc(index, composed);
    return composed;
  }
  if (modes_[index].made == AptReader::Made::moves) {
    compose_moves(index, composed);
    return composed;
  }
  if (word_ == "CYCLE" && cycles_[index] == index) set_said_cycle(index, composed);
  if (word_ == "GOTO" || word_ == "FROM") {
    set_ends(index, composed);
    set_axis(index, composed);
  }
  if (word_ == "GODLTA") set_step(index, composed);
  if (statement.says_feed) set_said_feed(index, composed);
  if (statement.says_speed) set_said_speed(index, composed);
  add_speed(index, composed);
  add_feed(index, composed);
  return composed;
}

std::unique_ptr<Rewriter> make_apt_rewriter(const RewriteJob& job) {
  return std::make_unique<AptRewriter>(job);
}

}  // namespace robomill::program
