#include "robomill/program/files/rewrite/gcode.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/program_lines.hpp"

namespace robomill::program {
namespace {

using Eigen::Vector3d;

constexpr std::string_view motion_letters = "xyzabcijkr";
constexpr std::array<char, 3> axis_letters = {'x', 'y', 'z'};
constexpr std::array<char, 3> center_letters = {'i', 'j', 'k'};

bool is_small(char c) {
  return c >= 'a' && c <= 'z';
}

char in_capitals(char c) {
  return is_small(c) ? static_cast<char>(c - 'a' + 'A') : c;
}

const char* motion_number(GcodeReader::Motion motion) {
  switch (motion) {
    case GcodeReader::Motion::clockwise:
      return "2";
    case GcodeReader::Motion::counterclockwise:
      return "3";
    case GcodeReader::Motion::feed:
      return "1";
    case GcodeReader::Motion::cycle:
    case GcodeReader::Motion::rapid:
    case GcodeReader::Motion::none:
      break;
  }
  return "0";
}

}  // namespace

GcodeRewriter::GcodeRewriter(const RewriteJob& job)
    : Rewriter(job),
      in_(job.file, job.reading, remarks_),
      out_(std::make_unique<GcodeReader>(job.file, job.reading, remarks_)) {
  if (!job.reading.tool.given() ||
      !GcodeReader::changes_tool_by_t(ProgramLines(job.file, std::string(job.text)), job.file)) {
    return;
  }
  in_.set_changes_tool_by_t();
  out_->set_changes_tool_by_t();
}

void GcodeRewriter::scan(const Statement& statement) {
  words_.clear();
  const std::string_view joined = join(statement);
  scanned_.scan(joined, job().file, statement.line);
  if (scanned_.words().empty()) return;
  GcodeWords::find_letters(joined, places_);
  for (const GcodeWords::Word& word : scanned_.words()) {
    const auto first = static_cast<std::size_t>(word.text.data() - scanned_.compact().data());
    const std::size_t begin = places_[first];
    const std::size_t end = places_[first + word.text.size() - 1] + 1;
    Word found = {.letter = word.letter, .number = word.number, .text = word.text};
    found.begin = place_of(begin, begin + 1).value();
    found.digits = place_of(places_[first + 1], places_[first + 1] + 1).value();
    found.end = place_of(end - 1, end).value() + 1;
    found.broken = !place_of(begin, end);
    words_.push_back(found);
  }
}

const GcodeRewriter::Word* GcodeRewriter::find(char letter) const {
  const auto found = std::ranges::find(words_, letter, &Word::letter);
  return found == words_.end() ? nullptr : &*found;
}

const GcodeRewriter::Word* GcodeRewriter::find_g(double least, double most) const {
  const auto found = std::ranges::find_if(
      words_, [&](const Word& word) { return word.letter == 'g' && word.number >= least && word.number <= most; });
  return found == words_.end() ? nullptr : &*found;
}

bool GcodeRewriter::moves() const {
  return std::ranges::any_of(
      words_, [](const Word& word) { return motion_letters.find(word.letter) != std::string_view::npos; });
}

void GcodeRewriter::note(Statement& statement) {
  const Modes before = modes_.empty() ? Modes{} : modes_.back();
  modes_.push_back(in_.modes());
  const Modes& after = modes_.back();
  scan(statement);
  const std::string_view compact = scanned_.compact();
  // A header stands behind what must come first: %, the program's name, its number.
  const bool number = words_.size() == 1 && words_.front().letter == 'o';
  in_head_ = in_head_ && (compact.empty() || compact.front() == '%' || compact.front() == '$' || number);
  if (in_head_ && !compact.empty()) header_place_ = modes_.size();
  for (const Word& word : words_) {
    const bool point = word.text.find('.') != std::string_view::npos;
    if (word.letter >= 'x' && word.letter <= 'z' && !after.special) note_position(word.text.substr(1));
    if (word.letter == 'f') points_.feed = points_.feed || point;
    if (word.letter == 's') points_.speed = points_.speed || point;
  }
  const bool straight = after.motion == Motion::rapid || after.motion == Motion::feed;
  by_vector_ = by_vector_ || (straight && find('i') != nullptr);
  const bool modal = after.feed_mode == GcodeReader::FeedMode::per_minute;
  statement.says_speed = find('s') != nullptr;
  statement.says_feed = modal && find('f') != nullptr;
  statement.breaks_feed = after.feed_mode != before.feed_mode;
  statement.passes = after.passes;
  if (after.passes) {
    const bool starts_spindle = std::ranges::any_of(
        words_, [](const Word& word) { return word.letter == 'm' && (word.number == 3.0 || word.number == 4.0); });
    statement.takes_speed = moves() || starts_spindle;
    statement.takes_feed = modal && moves() && after.motion != Motion::rapid;
    return;
  }
  const Move move = move_of(statement);
  const std::span<const Block> blocks =
      std::span(job().as_read.blocks).subspan(statement.first_block, statement.blocks);
  const auto feeds = [](const Block& block) { return block.kind == Block::Kind::feed; };
  if (!(after.special ? std::ranges::any_of(blocks, feeds) : move.count > 0 && move.at_feed)) return;
  statement.moves_at_feed = modal;
  // A drilling cycle's moves have one F too.
  statement.round = after.motion == Motion::clockwise || after.motion == Motion::counterclockwise || after.special;
  if (modal) {
    statement.per_minute = per_minute(*after.feed, after.feed_in_inches, !statement.round && move.read_way_m == 0.0);
  }
}

double GcodeRewriter::turn_deg(std::size_t index) const {
  const Vector3d turned = modes_[index].rotary_deg - modes_before(index).rotary_deg;
  return turned.isZero() ? Rewriter::turn_deg(index) : turned.norm();
}

double GcodeRewriter::per_minute(double feed, bool inches, bool degrees) {
  return inches && !degrees ? feed * (units::inch / units::mm) : feed;
}

std::string GcodeRewriter::feed_text(double per_minute, bool inches, bool degrees, const Word* word) const {
  const bool point = word != nullptr ? word->text.find('.') != std::string_view::npos : points_.feed;
  return significant_text(inches && !degrees ? per_minute / (units::inch / units::mm) : per_minute, point);
}

std::string GcodeRewriter::word_text(char letter, std::string_view number) const {
  const bool small = !words_.empty() && is_small(job().text[words_.back().begin]);
  return std::string(1, small ? letter : in_capitals(letter)).append(number);
}

void GcodeRewriter::set_number(const Statement& statement, const Word& word, std::string number,
                               Composed& composed) const {
  if (word.broken) {
    reject(statement.line, std::string(1, in_capitals(word.letter)),
           "is a word over two lines, which cannot be changed", "Write it on one");
  }
  // Comments within a number come behind it.
  for (std::size_t at = word.digits; at < word.end; ++at) {
    if (job().text[at] != '(') continue;
    const std::size_t end = job().text.find(')', at);
    number.append(job().text.substr(at, end + 1 - at));
    at = end;
  }
  composed.edits.push_back({.begin = word.digits, .end = word.end, .text = std::move(number)});
}

void GcodeRewriter::remove(const Statement& statement, const Word& word, Composed& composed) const {
  set_number(statement, word, {}, composed);
  Edit& edit = composed.edits.back();
  // A comment between letter and number stays.
  edit.text.insert(0, job().text.substr(word.begin + 1, word.digits - word.begin - 1));
  edit.begin = word.begin;
  while (edit.begin > statement.begin && (job().text[edit.begin - 1] == ' ' || job().text[edit.begin - 1] == '\t')) {
    --edit.begin;
  }
}

void GcodeRewriter::add(char letter, std::string_view number, Composed& composed) const {
  const std::size_t end = words_.back().end;
  composed.edits.push_back({.begin = end, .end = end, .text = " " + word_text(letter, number)});
}

void GcodeRewriter::add_axis(char letter, std::string_view number, Composed& composed) const {
  constexpr std::string_view order = "xyzabcijk";
  const Word* before = nullptr;
  const Word* behind = nullptr;
  for (const Word& word : words_) {
    const std::size_t place = order.find(word.letter);
    if (place == std::string_view::npos) continue;
    if (place < order.find(letter)) before = &word;
    if (place > order.find(letter) && behind == nullptr) behind = &word;
  }
  const Word* const code = find('g');
  if (before == nullptr && behind == nullptr) before = code;
  if (before != nullptr) {
    composed.edits.push_back({.begin = before->end, .end = before->end, .text = " " + word_text(letter, number)});
  } else if (behind != nullptr) {
    composed.edits.push_back({.begin = behind->begin, .end = behind->begin, .text = word_text(letter, number) + " "});
  } else {
    add(letter, number, composed);
  }
}

void GcodeRewriter::add_first(char letter, std::string_view number, Composed& composed) const {
  const Word& first = words_.front();
  if (first.letter == 'n') {
    composed.edits.push_back({.begin = first.end, .end = first.end, .text = " " + word_text(letter, number)});
  } else {
    composed.edits.push_back({.begin = first.begin, .end = first.begin, .text = word_text(letter, number) + " "});
  }
}

void GcodeRewriter::set_motion(std::size_t index, Composed& composed) const {
  const Motion motion = modes_[index].motion;
  if (motion == out_->modes().motion || find_g(0.0, 3.0) != nullptr) return;
  add_first('g', motion_number(motion), composed);
}

Vector3d GcodeRewriter::set_ends(std::size_t index, const Move& move, Composed& composed) const {
  const Statement& statement = statements()[index];
  const Modes& modes = modes_[index];
  const double unit_m = modes.inches ? units::inch : units::mm;
  const Vector3d from_m = out_->pose().tip_m;
  Vector3d end_m = from_m;
  if (move.count == 0 && !statement.starts && !statement.after_start) return end_m;  // not known yet
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const bool moved = statement.round ? move.read_end_m[axis] != move.read_begin_m[axis] : !move.still();
    const bool stays = !statement.starts && (move.count == 0 || !moved);
    const Word* const word = find(axis_letters[i]);
    const double target_m = statement.starts ? job().wanted.start.tip_m[axis] : move.count > 0 ? move.end_m[axis] : 0.0;
    const double origin_m = modes.origin_m[axis];
    const Coordinate to = coordinate(word != nullptr ? std::optional(word->number) : std::nullopt, target_m,
                                     from_m[axis], modes.incremental, position_digits(unit_m), stays, origin_m);
    end_m[axis] = to.end;
    if (to.act == Coordinate::Act::keep) continue;
    if (word == nullptr) {
      add_axis(axis_letters[i], to.text, composed);
    } else if (to.act == Coordinate::Act::write) {
      set_number(statement, *word, to.text, composed);
    } else {
      remove(statement, *word, composed);
    }
  }
  return end_m;
}

void GcodeRewriter::set_centers(std::size_t index, const Vector3d& offset_m, Composed& composed) const {
  const Modes& modes = modes_[index];
  const double unit_m = modes.inches ? units::inch : units::mm;
  for (std::size_t i = 0; modes.centers_absolute && i < 3; ++i) {
    const Word* const word = find(center_letters[i]);
    if (word == nullptr) continue;
    // Both count from the frame's origin.
    const Coordinate to = coordinate(word->number, word->number * unit_m + offset_m[static_cast<Eigen::Index>(i)], 0.0,
                                     false, position_digits(unit_m), false);
    if (to.act != Coordinate::Act::keep) set_number(statements()[index], *word, to.text, composed);
  }
}

void GcodeRewriter::set_speed(std::size_t index, Composed& composed) const {
  const Statement& statement = statements()[index];
  const std::size_t last = statement.first_block + statement.blocks;
  check_one_speed(statement, "S");
  if (const Word* const word = find('s'); word != nullptr) {
    const std::size_t block = first_turning(statement.first_block, statement.speed_until);
    if (block == none || same_rate(word->number, wanted_rpm(block))) return;
    set_number(statement, *word, significant_text(wanted_rpm(block), word->text.find('.') != std::string_view::npos),
               composed);
    return;
  }
  const std::size_t block = first_turning(statement.first_block, last);
  if (block == none || same_rate(out_->spindle_speed_rad_per_s() / units::rpm, wanted_rpm(block))) return;
  const Block& read = job().as_read.blocks[block];
  if (read.spindle == Spindle::not_given && read.spindle_speed_rad_per_s == 0.0) {
    reject(statement.line, "S", "cannot be changed where the program has not turned its spindle on",
           "Give the program an S and an M3 before this line");
  }
  const std::string number = significant_text(wanted_rpm(block), points_.speed);
  // On a line with G4 some controls count S as the dwell's revolutions.
  if (find_g(4.0, 4.0) != nullptr) {
    composed.before.push_back(word_text('s', number));
  } else {
    add('s', number, composed);
  }
}

void GcodeRewriter::set_inverse_time(std::size_t index, Composed& composed) const {
  const Statement& statement = statements()[index];
  const Move move = move_of(statement);
  if (move.count == 0 || !move.at_feed) return;
  const Word& word = *find('f');
  const double needed = units::minute / move.time_s;
  if (same_rate(word.number, needed)) return;
  set_number(statement, word, significant_text(needed, word.text.find('.') != std::string_view::npos), composed);
}

// An F of moves that come later is changed where it stands, so that it goes on to say what it said.
void GcodeRewriter::set_feed_for_later(std::size_t index, Composed& composed) const {
  const Statement& statement = statements()[index];
  if (!statement.says_feed || statement.feeds == none) return;
  const Feed needed = needed_feed(statement.feeds);
  if (same_rate(needed.per_minute, statements()[statement.feeds].per_minute)) return;
  const Word& word = *find('f');
  set_number(statement, word, feed_text(needed.per_minute, modes_[index].inches, needed.degrees, &word), composed);
}

void GcodeRewriter::set_feed(std::size_t index, const Motions& motions, Composed& composed) const {
  const Statement& statement = statements()[index];
  const Modes& modes = modes_[index];
  if (modes.feed_mode == GcodeReader::FeedMode::inverse_time) {
    set_inverse_time(index, composed);
    return;
  }
  if (!statement.moves_at_feed) {
    set_feed_for_later(index, composed);
    return;
  }
  const bool stands = !statement.round && motions.stands();
  const double needed = needed_feed(index, motions).per_minute;
  const Modes held = out_->modes();
  const Word* const word = find('f');
  const std::optional<double> feed = word != nullptr ? word->number : held.feed;
  const bool inches = word != nullptr ? modes.inches : held.feed_in_inches;
  if (feed && same_rate(per_minute(*feed, inches, stands), needed)) return;
  const std::string number = feed_text(needed, modes.inches, stands, word);
  if (word != nullptr) {
    set_number(statement, *word, number, composed);
  } else {
    add('f', number, composed);
  }
}

void GcodeRewriter::compose_kept(std::size_t index, const Move& move, Composed& composed) const {
  const Statement& statement = statements()[index];
  Motions motions;
  if (moves()) {
    set_motion(index, composed);
    const Vector3d end_m = set_ends(index, move, composed);
    motions.way_m = (end_m - out_->pose().tip_m).norm();
    motions.turn_deg = set_axis(index, move, composed);
    if (statement.round) set_centers(index, move.begin_m - move.read_begin_m, composed);
  }
  set_speed(index, composed);
  set_feed(index, motions, composed);
}

bool GcodeRewriter::parts_fit(const Statement& statement, const Move& move) const {
  const double most_m = position_digits(units::mm).resolution();
  const Vector3d offset_m = move.begin_m - move.read_begin_m;
  for (std::size_t i = 0; i < move.count; ++i) {
    const Vector3d& wanted_m = job().wanted.blocks[move.first + i].end.tip_m;
    const double share = static_cast<double>(i + 1) / static_cast<double>(move.count);
    const Vector3d fits_m = statement.round ? Vector3d(job().as_read.blocks[move.first + i].end.tip_m + offset_m)
                                            : Vector3d(move.begin_m + share * (move.end_m - move.begin_m));
    if ((wanted_m - fits_m).norm() > most_m) return false;
  }
  return true;
}

bool GcodeRewriter::reads_well(const Statement& statement, Composed& composed) const {
  GcodeReader trial(*out_);
  try {
    return read_back(trial, assemble(statement, composed), statement).empty();
  } catch (const InvalidInput&) {
    return false;
  }
}

Rewriter::Composed GcodeRewriter::compose_parted(std::size_t index, const Move& move) {
  const Statement& statement = statements()[index];
  const bool turned = move.at_feed && axes_changed(index);
  if (!parts_fit(statement, move)) return split(index, pieces_of(index, move));
  Composed kept;
  if (move.at_feed && !turned) check_one_feed(statement, move);
  try {
    compose_kept(index, move, kept);
  } catch (const InvalidInput&) {
    if (turned) return split(index, pieces_of(index, move));  // what one line cannot say, several may
    throw;
  }
  // Digits may spoil an arc, above all one by its radius and near half a turn; and a machine may turn another way.
  if (!(statement.round || turned) || reads_well(statement, kept)) return kept;
  return split(index, pieces_of(index, move));
}

Rewriter::Composed GcodeRewriter::compose_passed(std::size_t index) const {
  Composed composed;
  if (!leaves_part(index)) return composed;
  check_left_as_read(index);
  const Statement& statement = statements()[index];
  const Modes& read = modes_[index - 1];
  const Modes held = out_->modes();
  if (!read.rotary_deg.isApprox(held.rotary_deg, 1e-9)) {
    reject(statement.line, "A, B, C", "must stand as in the program where the part of another tool begins");
  }
  std::string line;
  const auto says = [&](char letter, const std::string& number) {
    line += (line.empty() ? "" : " ") + word_text(letter, number);
  };
  if (read.motion != held.motion) {
    if (read.motion != Motion::rapid && read.motion != Motion::feed) {
      reject(statement.line, "G", "cannot be kept where the part of another tool begins after an arc or a cycle",
             "End the chosen tool's part by a G0");
    }
    says('g', motion_number(read.motion));
  }
  const Carried carried = carried_from(index);
  if (carried.speed && !same_rate(read.speed_rad_per_s, held.speed_rad_per_s)) {
    says('s', significant_text(read.speed_rad_per_s / units::rpm, points_.speed));
  }
  const bool feed = carried.feed && read.feed && held.feed;
  if (feed && !same_rate(per_minute(*read.feed, read.feed_in_inches, false),
                         per_minute(*held.feed, held.feed_in_inches, false))) {
    says('f', feed_text(per_minute(*read.feed, read.feed_in_inches, false), read.inches, false, nullptr));
  }
  if (!line.empty()) composed.before.push_back(line);
  return composed;
}

// Its positions stay: what a machine makes of them is not said by their words alone.
Rewriter::Composed GcodeRewriter::compose_special(std::size_t index) const {
  const Statement& statement = statements()[index];
  const Program& read = job().as_read;
  bool same = stand_as_read(index);
  for (std::size_t i = statement.first_block; i < statement.first_block + statement.blocks; ++i) {
    const Pose& end = job().wanted.blocks[i].end;
    same =
        same && (end.tip_m - read.blocks[i].end.tip_m).norm() <= 1e-10 && same_axis(end.axis, read.blocks[i].end.axis);
  }
  if (!same && statement.blocks > 0) {
    reject(statement.line, "tip",
           "cannot be moved where a line drills by a cycle, rounds a corner, lies in a turned plane or brings the tool "
           "back from the machine's own position",
           "Let the CAM system write its moves as G0 and G1");
  }
  Composed composed;
  if (statement.round) check_cycle_feed(statement);
  set_speed(index, composed);
  if (statement.round || statement.says_feed) set_feed(index, {}, composed);
  return composed;
}

void GcodeRewriter::check_cycle_feed(const Statement& statement) const {
  std::optional<double> ratio;
  for (std::size_t i = statement.first_block; i < statement.first_block + statement.blocks; ++i) {
    const Block& block = job().as_read.blocks[i];
    if (block.kind != Block::Kind::feed) continue;
    const double this_ratio = job().wanted.blocks[i].duration_s / block.duration_s;
    if (!ratio) ratio = this_ratio;
    if (same_rate(this_ratio, *ratio)) continue;
    reject(statement.line, "feed", "must be one for all moves of the drilling cycle or the corner that this line says",
           "The line has one F");
  }
}

Rewriter::Composed GcodeRewriter::compose(std::size_t index) {
  const Statement& statement = statements()[index];
  scan(statement);
  if (words_.empty()) return {};
  if (modes_[index].passes) return compose_passed(index);
  if (modes_[index].special) return compose_special(index);
  const Move move = move_of(statement);
  if (move.count > 1 || statement.round) return compose_parted(index, move);
  if (move.count == 1 && move.at_feed && axes_changed(index)) {
    const std::vector<Piece> pieces = pieces_of(index, move);
    if (pieces.size() > 1) return split(index, pieces);
  }
  Composed composed;
  compose_kept(index, move, composed);
  return composed;
}

std::string GcodeRewriter::comment(std::string_view text) const {
  std::string out = "(";
  for (const char c : text) out += c == '(' ? '[' : c == ')' ? ']' : c;
  return out + ")";
}

std::unique_ptr<Rewriter> make_gcode_rewriter(const RewriteJob& job) {
  return std::make_unique<GcodeRewriter>(job);
}

}  // namespace robomill::program
