#include "robomill/program/files/rewrite/rewriter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/program_lines.hpp"

namespace robomill::program {
namespace {

constexpr double one_feed_tolerance = 0.5e-5;  ///< half of what is compared

struct TextLine {
  std::string_view text;  ///< without its ending
  std::size_t next;       ///< where the next line begins
};

TextLine line_at(std::string_view text, std::size_t begin) {
  const LineEnd end = line_end(text.substr(begin));
  return {.text = text.substr(begin, end.at), .next = begin + end.at + end.bytes};
}

char letter_ahead(std::string_view text, std::size_t begin) {
  const std::size_t at = text.find_first_not_of(" \t", begin);
  return at == std::string_view::npos ? '\n' : text[at];
}

/// The line's end at the end of a text; empty where there is none.
std::string_view ending_of(std::string_view text) {
  if (text.ends_with("\r\n")) return "\r\n";
  if (text.ends_with('\r')) return "\r";
  return text.ends_with('\n') ? "\n" : "";
}

double number_in(const std::string& text) {
  double number = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

}  // namespace

std::string decimal_text(double value, int decimals, bool point) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.find('.') == std::string::npos) text += '.';
  while (text.back() == '0') text.pop_back();
  if (!point && text.back() == '.') text.pop_back();
  if (text == "-0" || text == "-0.") text.erase(0, 1);
  return text;
}

std::string significant_text(double value, bool point) {
  constexpr int digits = 7;
  const int whole = value == 0.0 ? 1 : 1 + static_cast<int>(std::floor(std::log10(std::abs(value))));
  return decimal_text(value, std::clamp(digits - whole, 0, 15), point);
}

bool same_rate(double a, double b) {
  return near_rate(a, b, 1e-6);
}

void Rewriter::reject(std::size_t line, std::string field, std::string rule, std::string hint) const {
  throw InvalidInput(InvalidInput::Parts{.where = fmt::format("{}:{}", job_.file, line),
                                         .field = std::move(field),
                                         .rule = std::move(rule),
                                         .hint = std::move(hint)});
}

void Rewriter::check_read(std::size_t index, const Block& block) const {
  const auto same = [](const Block& a, const Block& b) {
    return a.kind == b.kind && a.line == b.line && a.end.tip_m == b.end.tip_m && a.end.axis == b.end.axis &&
           a.duration_s == b.duration_s && a.spindle_speed_rad_per_s == b.spindle_speed_rad_per_s;
  };
  if (index < job_.as_read.blocks.size() && same(job_.as_read.blocks[index], block)) return;
  reject(block.line, "as_read", "is not what this file gives", "Read the program again");
}

void Rewriter::read_statements() {
  const std::string_view text = job_.text;
  head_ = text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
  if (const LineEnd end = line_end(text); end.bytes > 0) line_end_ = text.substr(end.at, end.bytes);
  std::size_t blocks = 0;
  std::size_t line = 0;
  Block block;
  for (std::size_t at = head_; at < text.size() && !in().ended();) {
    if (!in().continued()) {
      statements_.push_back(
          {.begin = at, .line = line + 1, .first_block = blocks, .after_start = in().start().has_value()});
    }
    ++line;
    const TextLine next = line_at(text, at);
    at = next.next;
    in().take(next.text, letter_ahead(text, at));
    if (at == text.size()) in().finish();
    while (in().pop(block)) check_read(blocks++, block);
    Statement& statement = statements_.back();
    statement.end = at;
    statement.blocks = blocks - statement.first_block;
    if (in().continued()) continue;
    statement.starts = !statement.after_start && in().start().has_value();
    note(statement);
  }
  if (blocks != job_.as_read.blocks.size() || !in().start() || in().start()->tip_m != job_.as_read.start.tip_m ||
      in().start()->axis != job_.as_read.start.axis) {
    reject(line, "as_read", "is not what this file gives", "Read the program again");
  }
}

bool Rewriter::leaves_part(std::size_t index) const {
  const Statement& statement = statements_[index];
  return index > 0 && statement.passes && !statements_[index - 1].passes && statement.first_block > 0;
}

Rewriter::Carried Rewriter::carried_from(std::size_t index) const {
  Carried out;
  bool speed_said = false;
  bool feed_said = false;
  for (std::size_t i = index; i < statements_.size() && statements_[i].passes; ++i) {
    const Statement& statement = statements_[i];
    speed_said = speed_said || statement.says_speed;
    feed_said = feed_said || statement.says_feed || statement.breaks_feed;
    out.speed = out.speed || (statement.takes_speed && !speed_said);
    out.feed = out.feed || (statement.takes_feed && !feed_said);
  }
  return out;
}

void Rewriter::check_left_as_read(std::size_t index) const {
  const Statement& statement = statements_[index];
  const std::string problem = pose_difference(job_.as_read.blocks[statement.first_block - 1].end,
                                              job_.wanted.blocks[statement.first_block - 1].end);
  if (problem.empty()) return;
  reject(statement.line, "tip",
         "must be as it was read where the part of another tool begins, which starts from there: " + problem,
         "End the chosen tool's part by a rapid that stays as it is");
}

void Rewriter::look_ahead() {
  std::size_t feed = none;
  std::size_t speed_until = job_.as_read.blocks.size();
  for (std::size_t i = statements_.size(); i-- > 0;) {
    Statement& statement = statements_[i];
    statement.speed_until = speed_until;
    if (statement.says_speed) speed_until = statement.first_block;
    if (statement.says_feed && !statement.moves_at_feed) statement.feeds = feed;
    if (statement.moves_at_feed && !statement.says_feed) feed = i;
    if (statement.says_feed || statement.breaks_feed) feed = none;
  }
}

std::string_view Rewriter::join(const Statement& statement) {
  joined_.clear();
  segments_.clear();
  const std::string_view text = job_.text;
  bool continued = false;
  for (std::size_t at = statement.begin; at < statement.end;) {
    const TextLine line = line_at(text, at);
    at = line.next;
    const ProgramReader::Part part = in().part_of(line.text, letter_ahead(text, at), continued);
    segments_.push_back({.joined = joined_.size(),
                         .text = static_cast<std::size_t>(part.text.data() - text.data()),
                         .length = part.text.size()});
    joined_.append(part.text);
    if (part.continues || continued) joined_ += ' ';
    continued = part.continues;
  }
  return joined_;
}

std::optional<std::size_t> Rewriter::place_of(std::size_t begin, std::size_t end) const {
  for (const Segment& segment : segments_) {
    if (begin > segment.joined + segment.length) continue;
    if (end > segment.joined + segment.length) return std::nullopt;
    return segment.text + (begin - segment.joined);
  }
  return std::nullopt;
}

Rewriter::Move Rewriter::move_of(const Statement& statement) const {
  const Program& read = job_.as_read;
  const Program& wanted = job_.wanted;
  Move move;
  move.first = statement.first_block;
  const std::size_t last = statement.first_block + statement.blocks;
  for (std::size_t i = move.first; i < last && read.blocks[i].kind != Block::Kind::dwell; ++i) {
    move.at_feed = read.blocks[i].kind == Block::Kind::feed;
    move.read_time_s += read.blocks[i].duration_s;
    move.time_s += wanted.blocks[i].duration_s;
    ++move.count;
  }
  if (move.count == 0) return move;
  move.begin_m = wanted.begin_of(move.first).tip_m;
  move.end_m = wanted.blocks[move.first + move.count - 1].end.tip_m;
  move.read_begin_m = read.begin_of(move.first).tip_m;
  move.read_end_m = read.blocks[move.first + move.count - 1].end.tip_m;
  move.way_m = (move.end_m - move.begin_m).norm();
  move.read_way_m = (move.read_end_m - move.read_begin_m).norm();
  return move;
}

double Rewriter::turn_deg(std::size_t index) const {
  const Statement& statement = statements_[index];
  return angle_between(job_.as_read.begin_of(statement.first_block).axis,
                       job_.as_read.blocks[statement.first_block].end.axis) /
         units::deg;
}

Eigen::Vector3d Rewriter::wanted_axis(const Statement& statement, const Move& move) {
  if (statement.starts) return job_.wanted.start.axis;
  return move.count > 0 ? job_.wanted.blocks[move.first + move.count - 1].end.axis : out().pose().axis;
}

double Rewriter::Motions::counted_way_m(double wanted_way_m) const {
  constexpr double much = 0.01;
  const bool changed = std::abs(way_m - wanted_way_m) > much * wanted_way_m;
  return changed && turn_deg > 0.0 ? way_m : wanted_way_m;
}

Rewriter::Feed Rewriter::needed_feed(std::size_t index, const std::optional<Motions>& motions) const {
  const Statement& statement = statements_[index];
  const Move move = move_of(statement);
  const double minutes = move.time_s / units::minute;
  // An arc's way is what its feed says of it.
  const double read_way = statement.per_minute * move.read_time_s / units::minute;
  if (statement.round) return {.per_minute = read_way / minutes};
  if (!move.still() && !(motions && motions->stands())) {
    const double way_m = motions ? motions->counted_way_m(move.way_m) : move.way_m;
    return {.per_minute = way_m / units::mm / minutes};
  }
  const double turn = motions ? motions->turn_deg : move.read_way_m > 0.0 ? turn_deg(index) : read_way;
  return {.per_minute = turn / minutes, .degrees = true};
}

std::size_t Rewriter::first_turning(std::size_t first, std::size_t last) const {
  for (std::size_t i = first; i < last; ++i) {
    if (job_.as_read.blocks[i].spindle != Spindle::off) return i;
  }
  return none;
}

void Rewriter::check_one_feed(const Statement& statement, const Move& move) const {
  const double part_s = move.time_s / static_cast<double>(move.count);
  for (std::size_t i = move.first; i < move.first + move.count; ++i) {
    if (near_rate(job_.wanted.blocks[i].duration_s, part_s, one_feed_tolerance)) continue;
    reject(statement.line, "feed",
           fmt::format("must be one for all {} parts of the {} that this line says", move.count,
                       statement.round ? "arc" : "move"),
           "The line has one F");
  }
}

void Rewriter::check_one_speed(const Statement& statement, const char* field) const {
  const std::size_t last = statement.first_block + statement.blocks;
  const std::size_t first = first_turning(statement.first_block, last);
  for (std::size_t i = first; i < last; ++i) {
    if (job_.as_read.blocks[i].spindle == Spindle::off) continue;
    if (same_rate(job_.wanted.blocks[i].spindle_speed_rad_per_s, job_.wanted.blocks[first].spindle_speed_rad_per_s)) {
      continue;
    }
    reject(statement.line, field, "must be one speed for all blocks of this line");
  }
}

double Rewriter::wanted_rpm(std::size_t block) const {
  return job_.wanted.blocks[block].spindle_speed_rad_per_s / units::rpm;
}

void Rewriter::note_position(std::string_view number) {
  constexpr int most = 9;
  const std::size_t point = number.find('.');
  if (point == std::string_view::npos) {
    whole_positions_ = whole_positions_ || number.find_first_of("123456789") != std::string_view::npos;
    points_.position = points_.position && !whole_positions_;
    return;
  }
  // Beside whole numbers without a point, new ones with it could mean other units.
  points_.position = !whole_positions_;
  const auto digits = static_cast<int>(number.size() - point - 1);
  position_decimals_ = std::max(position_decimals_, std::min(digits, most));
}

double Rewriter::Digits::resolution() const {
  return unit * std::pow(10.0, -decimals);
}

Rewriter::Digits Rewriter::position_digits(double unit_m) const {
  return {.unit = unit_m, .decimals = std::max(position_decimals_, unit_m == units::inch ? 6 : 4)};
}

Rewriter::Coordinate Rewriter::coordinate(std::optional<double> number, double target, double from, bool step,
                                          const Digits& digits, bool stays, double origin) const {
  const double base = step ? from : origin;
  const double kept = number ? *number * digits.unit + base : from;
  constexpr double half = 0.5001;
  if (stays ? kept == from : std::abs(kept - target) <= half * digits.resolution()) return {.end = kept};
  const double wanted = ((stays ? from : target) - base) / digits.unit;
  Coordinate out = {.act = Coordinate::Act::write};
  constexpr int most = 12;
  for (int decimals = digits.decimals; decimals <= most; ++decimals) {
    out.text = decimal_text(wanted, decimals, points_.position);
    out.end = number_in(out.text) * digits.unit + base;
    if (!stays || out.end == from) return out;
  }
  return {.act = Coordinate::Act::drop, .text = fmt::format("{}", wanted), .end = from};
}

// Eight decimals: within 1e-8 rad.
Rewriter::AxisNumbers Rewriter::axis_numbers(const std::optional<Eigen::Vector3d>& numbers,
                                             const Eigen::Vector3d& target) const {
  constexpr int decimals = 8;
  AxisNumbers out;
  if (numbers) {
    out.written = *numbers;
    out.axis = out.written / out.written.norm();
    if (same_axis(out.axis, target)) return out;
  }
  out.keep = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto component = static_cast<Eigen::Index>(i);
    out.texts[i] = decimal_text(target[component], decimals, points_.position);
    out.written[component] = number_in(out.texts[i]);
  }
  out.axis = out.written / out.written.norm();
  return out;
}

std::array<std::string, 3> Rewriter::exact_texts(const Eigen::Vector3d& numbers) {
  std::array<std::string, 3> out;
  for (std::size_t i = 0; i < 3; ++i) {
    std::array<char, 400> letters = {};  // of the least double
    const std::to_chars_result end = std::to_chars(letters.data(), letters.data() + letters.size(),
                                                   numbers[static_cast<Eigen::Index>(i)], std::chars_format::fixed);
    out[i].assign(letters.data(), end.ptr);
  }
  return out;
}

std::string Rewriter::assemble(const Statement& statement, Composed& composed) const {
  // What is inserted at a place stands before what is replaced from there on.
  std::ranges::stable_sort(composed.edits, {}, [](const Edit& edit) { return std::pair(edit.begin, edit.end); });
  std::string piece;
  for (const std::string& line : composed.before) piece.append(line).append(line_end_);
  std::size_t at = statement.begin;
  for (const Edit& edit : composed.edits) {
    if (edit.begin > at) piece.append(job_.text.substr(at, edit.begin - at));
    piece.append(edit.text);
    at = std::max(at, edit.end);
  }
  piece.append(job_.text.substr(at, statement.end - at));
  if (composed.after.empty()) return piece;
  const std::string_view last_end = ending_of(raw(statement));
  piece.resize(piece.size() - last_end.size());
  for (const std::string& line : composed.after) piece.append(line_end_).append(line);
  return piece.append(last_end);
}

std::string Rewriter::read_back(ProgramReader& reader, std::string_view piece, const Statement& statement) const {
  const Pose begin = reader.pose();
  std::vector<Block> got;
  got.reserve(statement.blocks);
  Block block;
  for (std::size_t at = 0; at < piece.size();) {
    const TextLine line = line_at(piece, at);
    at = line.next;
    reader.take(line.text, letter_ahead(piece, at));
    if (at == piece.size() && statement.end == job_.text.size()) reader.finish();
    while (reader.pop(block)) got.push_back(block);
  }
  std::string problem =
      blocks_difference(std::span(job_.wanted.blocks).subspan(statement.first_block, statement.blocks),
                        job_.wanted.begin_of(statement.first_block), got, begin, job_.reading.axis_tolerance_rad);
  if (problem.empty() && statement.starts &&
      !(reader.start() && pose_difference(job_.wanted.start, *reader.start()).empty())) {
    problem = "the program starts elsewhere";
  }
  return problem;
}

void Rewriter::write(std::size_t index, Result& result) {
  const Statement& statement = statements_[index];
  Composed composed = compose(index);
  const bool as_it_was = composed.edits.empty() && composed.before.empty() && composed.after.empty();
  const std::string edited = as_it_was ? std::string() : assemble(statement, composed);
  const std::string_view piece = as_it_was ? raw(statement) : std::string_view(edited);
  std::string problem;
  try {
    problem = read_back(out(), piece, statement);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.where = fmt::format("{}:{}", job_.file, statement.line);
    parts.rule = "could not be rewritten: " + parts.rule;
    throw InvalidInput(std::move(parts));
  }
  if (!problem.empty()) reject(statement.line, {}, "could not be rewritten: " + problem);
  Rewritten& out = result.rewritten;
  out.text.append(piece);
  out.added_lines += composed.before.size() + composed.after.size();
  result.origins.insert(result.origins.end(), composed.before.size(), statement.line);
  std::size_t line = statement.line;
  auto edit = composed.edits.begin();
  for (std::size_t at = statement.begin; at < statement.end; ++line) {
    at = line_at(job_.text, at).next;
    result.origins.push_back(line);
    const std::size_t end = at == job_.text.size() ? at + 1 : at;  // a last line without an end is edited there too
    if (edit != composed.edits.end() && edit->begin < end) ++out.changed_lines;
    while (edit != composed.edits.end() && edit->begin < end) ++edit;
  }
  result.origins.insert(result.origins.end(), composed.after.size(), statement.line);
  if (!as_it_was && out.first_changed == 0) out.first_changed = statement.line;
}

void Rewriter::write_header(const std::vector<std::string>& header, Result& result) const {
  std::string& text = result.rewritten.text;
  for (const std::string& sentence : header) {
    std::string plain;
    for (const char c : sentence) {
      if ((static_cast<unsigned char>(c) & 0xC0U) == 0x80U) continue;  // within a letter of UTF-8
      plain += c >= 0x20 && c < 0x7f ? c : '?';
    }
    text.append(comment(plain)).append(line_end_);
    result.origins.push_back(0);
  }
}

Rewriter::Result Rewriter::rewrite(const std::vector<std::string>& header) {
  read_statements();
  look_ahead();
  Result result;
  const std::string_view text = job_.text;
  result.rewritten.text.reserve(text.size() + text.size() / 8);
  result.rewritten.text.append(text.substr(0, head_));
  const std::size_t place = header_place();
  for (std::size_t i = 0; i < statements_.size(); ++i) {
    if (i == place) write_header(header, result);
    write(i, result);
  }
  const ToolChoice& chosen = job_.reading.tool;
  for (const NumberedPart& one : numbered_parts(in().tools().parts())) {
    const bool read = chosen.is(one.part.number, one.part.name) && one.number == chosen.part.value_or(1);
    if (chosen.given() && one.part.moves && !read) result.others.push_back(choice_of(one));
  }
  const std::size_t end = statements_.back().end;
  result.rewritten.text.append(text.substr(end));
  return result;
}

}  // namespace robomill::program
