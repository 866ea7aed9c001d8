#include "robomill/program/files/rewriter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"

namespace robomill::program {
namespace {

constexpr double tip_tolerance_m = 2e-7;
constexpr double turned_tolerance = 1e-7;
constexpr double rate_tolerance = 1e-5;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

bool near_rate(double a, double b, double tolerance) {
  return std::abs(a - b) <= tolerance * std::max(std::abs(a), std::abs(b));
}

struct TextLine {
  std::string_view text;  ///< without its ending
  std::size_t next;       ///< where the next line begins
};

TextLine line_at(std::string_view text, std::size_t begin) {
  const std::size_t end = text.find('\n', begin);
  const std::size_t next = end == std::string_view::npos ? text.size() : end + 1;
  std::string_view line = text.substr(begin, std::min(end, text.size()) - begin);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return {.text = line, .next = next};
}

char letter_ahead(std::string_view text, std::size_t begin) {
  const std::size_t at = text.find_first_not_of(" \t", begin);
  return at == std::string_view::npos ? '\n' : text[at];
}

/// The line's end at the end of a text; empty where there is none.
std::string_view ending_of(std::string_view text) {
  if (text.ends_with("\r\n")) return "\r\n";
  return text.ends_with('\n') ? "\n" : "";
}

double number_in(const std::string& text) {
  double number = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::string feed_difference(const Block& wanted, double wanted_way_m, const Block& got, double way_m) {
  if (wanted_way_m > 0.0 && way_m > 0.0) {
    const double feed = wanted_way_m / wanted.duration_s;
    const double got_feed = way_m / got.duration_s;
    const double allowed = rate_tolerance + std::abs(way_m - wanted_way_m) / wanted_way_m;
    if (std::abs(got_feed - feed) <= allowed * feed) return {};
    return fmt::format("its feed is {:.9g} mm/min instead of {:.9g}", got_feed / units::mm * units::minute,
                       feed / units::mm * units::minute);
  }
  if (near_rate(got.duration_s, wanted.duration_s, rate_tolerance)) return {};
  return fmt::format("it takes {:.9g} s instead of {:.9g}", got.duration_s, wanted.duration_s);
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

std::string block_difference(const Block& wanted, const Pose& wanted_begin, const Block& got, const Pose& got_begin) {
  if (got.kind != wanted.kind) return "it is another kind of move";
  if (got.spindle != wanted.spindle || got.coolant != wanted.coolant || got.operator_stop != wanted.operator_stop) {
    return "spindle, coolant or stop are others";
  }
  if (const double off_m = (got.end.tip_m - wanted.end.tip_m).norm(); !(off_m <= tip_tolerance_m)) {
    return fmt::format("the tip comes to ({:.7g}, {:.7g}, {:.7g}) mm, off by {:.3g} mm", got.end.tip_m.x() / units::mm,
                       got.end.tip_m.y() / units::mm, got.end.tip_m.z() / units::mm, off_m / units::mm);
  }
  if (!((got.end.axis - wanted.end.axis).norm() <= turned_tolerance)) return "the axis is another";
  const bool turns = wanted.spindle != Spindle::off;
  if (turns && !near_rate(got.spindle_speed_rad_per_s, wanted.spindle_speed_rad_per_s, rate_tolerance)) {
    return fmt::format("the spindle's speed is {:.9g} rpm instead of {:.9g}", got.spindle_speed_rad_per_s / units::rpm,
                       wanted.spindle_speed_rad_per_s / units::rpm);
  }
  switch (wanted.kind) {
    case Block::Kind::rapid:
      return {};
    case Block::Kind::dwell:
      return got.duration_s == wanted.duration_s ? "" : "the dwell takes another time";
    case Block::Kind::feed:
      break;
  }
  return feed_difference(wanted, (wanted.end.tip_m - wanted_begin.tip_m).norm(), got,
                         (got.end.tip_m - got_begin.tip_m).norm());
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
  if (const std::size_t end = text.find('\n'); end != std::string_view::npos) {
    line_end_ = ending_of(text.substr(0, end + 1));
  }
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
  if (blocks != job_.as_read.blocks.size() || !in().start() || in().start()->tip_m != job_.as_read.start.tip_m) {
    reject(line, "as_read", "is not what this file gives", "Read the program again");
  }
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

Rewriter::Feed Rewriter::needed_feed(std::size_t index) const {
  const Statement& statement = statements_[index];
  const Move move = move_of(statement);
  const double minutes = move.time_s / units::minute;
  // An arc's way is what its feed says of it.
  const double read_way = statement.per_minute * move.read_time_s / units::minute;
  if (statement.round) return {.per_minute = read_way / minutes};
  if (!move.still()) return {.per_minute = move.way_m / units::mm / minutes};
  const double turn = move.read_way_m > 0.0 ? turn_deg(index) : read_way;
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
    if (near_rate(job_.wanted.blocks[i].duration_s, part_s, 0.5 * rate_tolerance)) continue;
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
  if (point == std::string_view::npos) return;
  points_.position = true;
  const auto digits = static_cast<int>(number.size() - point - 1);
  position_decimals_ = std::max(position_decimals_, std::min(digits, most));
}

// 0.1 um, or as the program writes itself.
int Rewriter::decimals(double unit_m) const {
  return std::max(position_decimals_, unit_m == units::inch ? 6 : 4);
}

double Rewriter::resolution_m(double unit_m) const {
  return unit_m * std::pow(10.0, -decimals(unit_m));
}

Rewriter::Coordinate Rewriter::coordinate(std::optional<double> number, double target_m, double from_m, bool step,
                                          double unit_m, bool stays) const {
  const double base_m = step ? from_m : 0.0;
  const double kept_m = number ? *number * unit_m + base_m : from_m;
  constexpr double half = 0.5001;
  if (stays ? kept_m == from_m : std::abs(kept_m - target_m) <= half * resolution_m(unit_m)) return {.end_m = kept_m};
  const double wanted = ((stays ? from_m : target_m) - base_m) / unit_m;
  Coordinate out = {.act = Coordinate::Act::write};
  constexpr int most = 12;
  for (int digits = decimals(unit_m); digits <= most; ++digits) {
    out.text = decimal_text(wanted, digits, points_.position);
    out.end_m = number_in(out.text) * unit_m + base_m;
    if (!stays || out.end_m == from_m) return out;
  }
  return {.act = Coordinate::Act::drop, .text = fmt::format("{}", wanted), .end_m = from_m};
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
  Pose begin = reader.pose();
  Pose wanted_begin = job_.wanted.begin_of(statement.first_block);
  std::size_t count = 0;
  std::string problem;
  Block block;
  for (std::size_t at = 0; at < piece.size();) {
    const TextLine line = line_at(piece, at);
    at = line.next;
    reader.take(line.text, letter_ahead(piece, at));
    if (at == piece.size() && statement.end == job_.text.size()) reader.finish();
    while (reader.pop(block)) {
      if (count < statement.blocks && problem.empty()) {
        const Block& wanted = job_.wanted.blocks[statement.first_block + count];
        problem = block_difference(wanted, wanted_begin, block, begin);
        wanted_begin = wanted.end;
      }
      begin = block.end;
      ++count;
    }
  }
  if (!problem.empty()) return problem;
  if (count != statement.blocks) return fmt::format("it makes {} blocks instead of {}", count, statement.blocks);
  if (statement.starts &&
      !(reader.start() && (reader.start()->tip_m - job_.wanted.start.tip_m).norm() <= tip_tolerance_m)) {
    return "the program starts elsewhere";
  }
  return {};
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
  const std::size_t end = statements_.back().end;
  result.rewritten.text.append(text.substr(end));
  return result;
}

}  // namespace robomill::program
