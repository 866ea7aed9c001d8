#include "robomill/program/files/apt_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"

namespace robomill::program {
namespace {

constexpr std::size_t shown_letters = 60;

/// Statements whose rest is text for people, dollars and all.
constexpr std::array<std::string_view, 6> texts = {"PPRINT", "PARTNO", "REMARK", "INSERT", "TPRINT", "LETTER"};

/// Statements that move the tool or its frame in ways that are not read.
struct Moving {
  std::string_view word;
  const char* hint;
};
constexpr const char* as_moves = "Let the CAM system write straight moves GOTO/";
constexpr const char* as_frame = "It would move the program's frame";
constexpr std::array<Moving, 35> moving = {
    {{"CIRCLE", as_moves}, {"MOVARC", as_moves}, {"ARC", as_moves},    {"CYLNDR", as_moves},
     {"GOFWD", as_moves},  {"GOBACK", as_moves}, {"GOLFT", as_moves},  {"GORGT", as_moves},
     {"GOUP", as_moves},   {"GODOWN", as_moves}, {"GO", as_moves},     {"GOCLER", as_moves},
     {"INDIRV", as_moves}, {"INDIRP", as_moves}, {"TLON", as_moves},   {"TLLFT", as_moves},
     {"TLRGT", as_moves},  {"POCKET", as_moves}, {"NURBS", as_moves},  {"SPLINE", as_moves},
     {"GOHOME", as_moves}, {"RETRCT", as_moves}, {"THREAD", as_moves}, {"TLAXIS", "Give the axis with each GOTO/"},
     {"ROTATE", as_frame}, {"ROTABL", as_frame}, {"ROTHED", as_frame}, {"TRANS", as_frame},
     {"ORIGIN", as_frame}, {"COPY", as_frame},   {"REFSYS", as_frame}, {"CALL", as_moves},
     {"JUMPTO", as_moves}, {"LOOPST", as_moves}, {"INDEX", as_moves}}};

/// … and those that choose which statements come next.
constexpr std::array<std::string_view, 4> order_of_statements = {"CALL", "JUMPTO", "LOOPST", "INDEX"};

char upper(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

/// Whether a line is one of the texts.
bool is_text(std::string_view line) {
  std::string word;
  for (const char c : line) {
    if (is_blank(c)) continue;
    word += upper(c);
    if (word.size() == 6) break;
  }
  return std::ranges::find(texts, word) != texts.end();
}

/// A comment that is data of CATIA: the head of a matrix, or one of its rows.
bool is_matrix_comment(std::string_view line) {
  const std::string_view text = io::trimmed(line);
  if (!text.starts_with("$$")) return false;
  if (text.substr(2).starts_with("*CATIA0")) return true;
  std::size_t numbers = 0;
  for (std::size_t at = 2; at < text.size();) {
    if (is_blank(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !is_blank(text[end])) ++end;
    if (numbers == 4 || !io::parse_number(text.substr(at, end - at))) return false;
    ++numbers;
    at = end;
  }
  return numbers == 4;
}

/// Statements behind which positions may still lie on the circle before them.
bool keeps_circle(std::string_view word) {
  return word == "FEDRAT" || word == "SPINDL" || word == "COOLNT";
}

}  // namespace

// $$ begins a comment; what stands behind one $ does not count, and the statement goes on.
ProgramReader::Part AptReader::part_of(std::string_view line, char, bool continued) const {
  const std::size_t dollar = line.find('$');
  if (dollar == std::string_view::npos || (!continued && is_text(line))) return {.text = line};
  const bool comment = dollar + 1 < line.size() && line[dollar + 1] == '$';
  if (comment && !continued && is_matrix_comment(line)) return {.text = line};
  return {.text = line.substr(0, dollar), .continues = !comment};
}

AptReader::Modes AptReader::modes() const {
  Modes out = {.inches = inches_,
               .feed = feed_.value,
               .feed_in_inches = feed_.inches,
               .feed_per_revolution = feed_.per_revolution,
               .speed_rad_per_s = spindle_speed_rad_per_s_,
               .spindle = spindle_,
               .plain_axis = plain_axis_,
               .moved_frame = frame_.has_value(),
               .made = made_,
               .passes = passes()};
  if (cycle_.on) out.cycle_feed = cycle_.feed;
  return out;
}

void AptReader::split(std::string_view statement) {
  text_.clear();
  for (const char c : statement) {
    if (!is_blank(c)) text_ += upper(c);
  }
  fields_.clear();
  std::string_view rest = text_;
  const std::size_t slash = rest.find('/');
  word_ = rest.substr(0, slash);
  // A label: A1) GOTO/…
  if (const std::size_t end = word_.find(')'); end < word_.find('(') && end != std::string_view::npos) {
    word_.remove_prefix(end + 1);
  }
  if (slash == std::string_view::npos) return;
  rest.remove_prefix(slash + 1);
  while (true) {
    const std::size_t comma = rest.find(',');
    fields_.push_back(rest.substr(0, comma));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (fields_.back().empty()) fields_.pop_back();
}

const std::vector<AptReader::Statement>& AptReader::statements() {
  static const std::vector<Statement> known = {{"GODLTA", &AptReader::take_godlta},
                                               {"FROM", &AptReader::take_from},
                                               {"RAPID", &AptReader::take_rapid},
                                               {"FEDRAT", &AptReader::take_feed},
                                               {"CIRCLE", &AptReader::take_circle},
                                               {"MOVARC", &AptReader::take_arc},
                                               {"INDIRV", &AptReader::take_direction},
                                               {"INDIRP", &AptReader::take_direction},
                                               {"TLON,GOFWD", &AptReader::take_curve},
                                               {"CYCLE", &AptReader::take_cycle},
                                               {"SPINDL", &AptReader::take_spindle},
                                               {"COOLNT", &AptReader::take_coolant},
                                               {"UNITS", &AptReader::take_units},
                                               {"UNIT", &AptReader::take_units},
                                               {"MODE", &AptReader::take_mode},
                                               {"DELAY", &AptReader::take_delay},
                                               {"MSYS", &AptReader::take_system},
                                               {"CSYS", &AptReader::take_setup_system},
                                               {"TRNTYP", &AptReader::take_transformation},
                                               {"CUTCOM", &AptReader::take_compensation},
                                               {"TRACUT", &AptReader::take_tracut},
                                               {"ROTABL", &AptReader::take_shift},
                                               {"ROTATE", &AptReader::take_shift},
                                               {"ROTHED", &AptReader::take_shift},
                                               {"TRANS", &AptReader::take_shift},
                                               {"ORIGIN", &AptReader::take_shift},
                                               {"CLRSRF", &AptReader::take_clearance},
                                               {"CLEARP", &AptReader::take_clearance},
                                               {"RETRCT", &AptReader::take_retract},
                                               {"GOHOME", &AptReader::take_home},
                                               {"LOADTL", &AptReader::take_tool},
                                               {"TURRET", &AptReader::take_tool},
                                               {"LOAD", &AptReader::take_load},
                                               {"TOOLPATH", &AptReader::take_tool_path},
                                               {"STOP", &AptReader::take_stop},
                                               {"OPSTOP", &AptReader::take_stop},
                                               {"MULTAX", &AptReader::take_known},
                                               {"FINI", &AptReader::take_end}};
  return known;
}

void AptReader::read(std::string_view statement) {
  made_ = Made::straight;
  split(statement);
  if (text_.empty()) return;
  const bool mounts = word_ == "LOADTL" || word_ == "LOAD" || word_ == "TURRET" || word_ == "TOOLPATH";
  if (second_tool_line_ > 0 && !mounts && word_ != "FINI") return;
  if (word_ == "GOTO") {
    take_goto();
    return;
  }
  shown_ = printable(io::trimmed(statement), shown_letters);
  if (!keeps_circle(word_)) last_circle_.reset();
  if (passes() && pass_over()) return;
  for (const Statement& known : statements()) {
    if (word_ == known.word) {
      (this->*known.take)();
      return;
    }
  }
  if (text_.starts_with("$$")) {
    take_matrix_comment();
    return;
  }
  if (std::string_view("+-.0123456789").find(text_.front()) != std::string_view::npos &&
      text_.find(',') != std::string::npos) {
    reject_text({}, shown_, "has numbers without a word", "Let the CAM system write each position as GOTO/");
  }
  // CATIA writes TLON,GOFWD/…: each of the words may move.
  std::string_view rest = word_;
  while (!rest.empty() && !is_text(text_)) {
    const std::size_t comma = rest.find(',');
    if (std::ranges::find(moving, rest.substr(0, comma), &Moving::word) != moving.end()) reject_motion();
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  skip_statement();
}

bool AptReader::pass_over() {
  if (word_ == "CYCLE") {
    const std::string_view alone = fields_.size() == 1 ? fields_[0] : std::string_view();
    if (alone == "INIT" || alone == "CLEAR") return false;
    passed_switch_ = alone == "OFF" || alone == "NOMORE" ? std::string() : shown_;
    return true;
  }
  if (word_ == "RETRCT" && !fields_.empty()) return true;
  if (word_ == "GOHOME" && gives_home()) return false;  // its axis goes on, and a RAPID before it ends
  const std::string_view first = word_.substr(0, word_.find(','));
  if (std::ranges::find(order_of_statements, first) != order_of_statements.end()) return false;
  const auto* const found = std::ranges::find(moving, first, &Moving::word);
  if (found == moving.end() || found->hint != as_moves) return false;
  tools_.move(line_);
  return true;
}

void AptReader::reject_motion() const {
  const std::string_view first = word_.substr(0, word_.find(','));
  const auto* const found = std::ranges::find(moving, first, &Moving::word);
  reject_text(std::string(first), shown_, "is not read: it may move the tool or its frame",
              found == moving.end() ? as_moves : found->hint);
}

double AptReader::number_of(std::string_view field) const {
  double number = 0.0;
  const std::from_chars_result read = std::from_chars(field.data(), field.data() + field.size(), number);
  if (read.ec == std::errc() && read.ptr == field.data() + field.size() && std::isfinite(number)) return number;
  const std::optional<double> slow = io::parse_number(field);
  if (field.empty()) reject(std::string(word_), std::nullopt, "", "has an empty field");
  if (!slow || !std::isfinite(*slow)) reject_text(std::string(word_), field, "must be a finite number");
  return *slow;
}

void AptReader::take_numbers(std::size_t few, std::size_t many) {
  numbers_.clear();
  for (const std::string_view field : fields_) {
    numbers_.push_back(number_of(field));
    if (numbers_.size() > many) break;
  }
  if (numbers_.size() == few || numbers_.size() == many) return;
  reject(std::string(word_), std::nullopt, "",
         fmt::format("has {} numbers; must have {} or {}", fields_.size(), few, many),
         "A position, or a position and the tool's axis");
}

double AptReader::unit_m() const {
  return inches_ ? units::inch : units::mm;
}

bool AptReader::is_word(std::size_t field) const {
  return field < fields_.size() && !fields_[field].empty() && fields_[field].front() >= 'A' &&
         fields_[field].front() <= 'Z';
}

std::vector<double> AptReader::all_numbers() const {
  std::vector<double> numbers;
  for (std::string_view field : fields_) {
    // (PLANE/0 and 50)
    if (const std::size_t slash = field.rfind('/'); slash != std::string_view::npos) field.remove_prefix(slash + 1);
    while (field.ends_with(')')) field.remove_suffix(1);
    const std::optional<double> number = io::parse_number(field);
    if (number && std::isfinite(*number)) numbers.push_back(*number);
  }
  return numbers;
}

void AptReader::take_position() {
  constexpr std::size_t with_axis = 6;
  numbers_.clear();
  for (const std::string_view field : fields_) {
    numbers_.push_back(number_of(field));
    if (numbers_.size() > 4 * with_axis) break;
  }
  const std::size_t count = numbers_.size();
  if (count == 3 || count == with_axis) return;
  // A direction or the contact's normal behind the axis.
  if (count == 9 || count == 12) {
    const double length = Eigen::Vector3d(numbers_[3], numbers_[4], numbers_[5]).norm();
    if (std::abs(length - 1.0) <= 1e-3) {
      numbers_.resize(with_axis);
      assume_once(Once::numbers,
                  {.what = fmt::format("Numbers behind the tool's axis in GOTO/, from line {} on", line_),
                   .taken = "left out: the tip's position and its axis alone count",
                   .key = "GOTO/x,y,z,i,j,k"});
      return;
    }
  }
  reject(std::string(word_), std::nullopt, "", fmt::format("has {} numbers; must have 3 or 6", fields_.size()),
         "A position, or a position and the tool's axis");
}

Eigen::Vector3d AptReader::position_of_numbers() const {
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  Eigen::Vector3d position;
  for (std::size_t i = 0; i < 3; ++i) {
    position[static_cast<Eigen::Index>(i)] = numbers_[i] * unit_m();
    check_coordinate(names[i], numbers_[i] * unit_m(), numbers_[i], unit_name());
  }
  return position;
}

Pose AptReader::pose_of_numbers() {
  Pose pose = {.tip_m = position_of_numbers(), .axis = plain_axis_.value_or(pose_.axis)};
  if (frame_) pose.tip_m = frame_->rotation * pose.tip_m + frame_->origin_m;
  if (numbers_.size() >= 6) {
    const Eigen::Vector3d axis = unit_axis("i, j, k", {numbers_[3], numbers_[4], numbers_[5]});
    pose.axis = frame_ ? (frame_->rotation * axis).normalized() : axis;
    if (!plain_axis_stays_) plain_axis_.reset();
  } else if (setup_turned_ && !passes()) {
    reject(std::string(word_), std::nullopt, "", "gives no tool axis where CSYS turns it",
           "Give the axis with each GOTO/: x, y, z, i, j, k");
  }
  return pose;
}

void AptReader::take_goto() {
  take_position();
  go(pose_of_numbers());
}

void AptReader::take_godlta() {
  take_numbers(1, 3);
  if ((!start_ || lost_line_ > 0) && !passes()) reject_start("a step");
  if (cycle_.on && !rapid_ && !passes()) {
    reject("GODLTA", std::nullopt, "", "is a step to a hole of a drilling cycle", "Give holes by GOTO/");
  }
  Pose end = pose_;
  if (numbers_.size() == 3) {
    const Eigen::Vector3d step_m = position_of_numbers();
    end.tip_m += frame_ ? frame_->rotation * step_m : step_m;
  } else {
    end.tip_m += numbers_[0] * unit_m() * pose_.axis;
  }
  for (Eigen::Index i = 0; i < 3; ++i) check_coordinate("GODLTA", end.tip_m[i], numbers_[0], unit_name());
  go(end);
}

void AptReader::take_from() {
  take_numbers(3, 6);
  const Pose at = pose_of_numbers();
  if (!start_ || passes()) {
    begin_at(at);
    highest_m_ = at.tip_m.z();
  } else if (moves_to(at) && !is_second_tool()) {
    reject_text("FROM", shown_, "is another position than the one that the tool has come to",
                "FROM/ states where the first move begins; GOTO/ moves");
  }
}

void AptReader::reject_start(const char* what) const {
  if (lost_line_ > 0) {
    reject(std::string(word_), std::nullopt, "",
           fmt::format("is {} after {} in line {}, from where the tool's position is not known", what, lost_word_,
                       lost_line_),
           "Give a position by RAPID and GOTO/ before it");
  }
  reject(std::string(word_), std::nullopt, "", fmt::format("is {} from a position that no line has given", what),
         "Begin with FROM/ or GOTO/");
}

void AptReader::assume_once(Once what, Assumption assumption) {
  if (!passes() && !std::exchange(assumed_[static_cast<std::size_t>(what)], true))
    remarks_.assume(std::move(assumption));
}

void AptReader::go(const Pose& end) {
  const bool rapid = std::exchange(rapid_, false);
  begin_part_move();
  if (passes()) {
    circle_.reset();
    last_circle_.reset();
    begin_at(end);
    return;
  }
  if (!passed_switch_.empty()) {
    reject_text(tool_word_, passed_switch_, "of another tool is still on where this one moves", "Is its OFF missing?");
  }
  if (lost_line_ > 0 && is_second_tool()) return;
  if (compensation_line_ > 0) {
    assume_once(Once::compensation,
                {.what = fmt::format("Path under CUTCOM, from line {} on", std::exchange(compensation_line_, 0)),
                 .taken = "that of the tool's centre: the machine compensates for a worn tool alone",
                 .key = "CUTCOM/OFF"});
  }
  if (cycle_cut_line_ > 0 && moved_since_cut_line_ == 0) moved_since_cut_line_ = line_;
  if (circle_) {
    go_round(*std::exchange(circle_, std::nullopt), end, rapid);
  } else if (last_circle_ && !rapid && is_on(*last_circle_, end.tip_m)) {
    go_round(*last_circle_, end, false);
  } else if (cycle_.on && !rapid) {
    drill(end);
  } else {
    last_circle_.reset();
    go_straight(end, rapid);
  }
}

void AptReader::go_straight(const Pose& end, bool rapid) {
  if (lost_line_ > 0) {
    if (!rapid) reject_start("a move at feed");
    come_back(end);
    return;
  }
  highest_m_ = start_ ? std::max(highest_m_, end.tip_m.z()) : end.tip_m.z();
  if (!start_) {
    begin_at(end);
    return;
  }
  if (!moves_to(end)) return;
  constexpr double nearly = -0.99999;  // within 0.3 deg of half a circle
  if (rapid && setup_x_ && pose_.axis.dot(end.axis) < nearly) {
    turn_over(end);
    return;
  }
  if (is_second_tool()) return;
  const double turn_rad = turn_to(end.axis);
  if (rapid) {
    lift_m_.reset();
    if (cycle_.on) {
      assume_once(
          Once::rapid_in_cycle,
          {.what = fmt::format("A position behind RAPID while CYCLE/{} is on, from line {} on", cycle_.name, line_),
           .taken = "a rapid move and no hole",
           .key = "CYCLE/OFF"});
    }
    move(Block::Kind::rapid, end, 0.0);
    return;
  }
  begin_cutting();
  move(Block::Kind::feed, end, feed_duration_s(feed_, (end.tip_m - pose_.tip_m).norm(), turn_rad));
}

void AptReader::take_units() {
  const std::string_view unit = fields_.empty() ? std::string_view() : fields_.front();
  const bool inches = unit == "INCHES" || unit == "INCH" || unit == "IN";
  if (!inches && unit != "MM")
    reject_text(std::string(word_), unit, "is no unit known here", "Known are MM and INCHES");
  inches_ = inches;
}

void AptReader::take_mode() {
  if (!fields_.empty() && fields_[0].starts_with("INCR")) {
    reject_text("MODE", shown_, "makes positions steps", "Let the CAM system write absolute positions");
  }
  skip_statement();
}

void AptReader::take_tracut() {
  if (fields_.size() != 1 || (fields_[0] != "OFF" && fields_[0] != "NOMORE")) {
    reject_text("TRACUT", shown_, "is not read: it may move the tool or its frame", as_frame);
  }
  skip_statement();
}

}  // namespace robomill::program
