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

/// What a feed counts.
struct FeedUnit {
  std::string_view word;
  std::optional<bool> inches;  ///< none: as UNITS says
  bool per_revolution;
};
constexpr std::array<FeedUnit, 8> feed_units = {{{"MMPM", false, false},
                                                 {"IPM", true, false},
                                                 {"MMPR", false, true},
                                                 {"IPR", true, true},
                                                 {"PERMIN", std::nullopt, false},
                                                 {"PERREV", std::nullopt, true},
                                                 {"UPM", std::nullopt, false},
                                                 {"UPR", std::nullopt, true}}};

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

}  // namespace

// $$ begins a comment; what stands behind one $ does not count, and the statement goes on.
ProgramReader::Part AptReader::part_of(std::string_view line, char, bool continued) const {
  const std::size_t dollar = line.find('$');
  if (dollar == std::string_view::npos || (!continued && is_text(line))) return {.text = line};
  const bool comment = dollar + 1 < line.size() && line[dollar + 1] == '$';
  return {.text = line.substr(0, dollar), .continues = !comment};
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
  static const std::vector<Statement> known = {
      {"GODLTA", &AptReader::take_godlta}, {"FROM", &AptReader::take_from},      {"RAPID", &AptReader::take_rapid},
      {"FEDRAT", &AptReader::take_feed},   {"UNITS", &AptReader::take_units},    {"SPINDL", &AptReader::take_spindle},
      {"DELAY", &AptReader::take_delay},   {"MSYS", &AptReader::take_system},    {"CUTCOM", &AptReader::take_switch},
      {"CYCLE", &AptReader::take_switch},  {"TRACUT", &AptReader::take_switch},  {"FINI", &AptReader::take_end},
      {"MULTAX", &AptReader::take_known},  {"COOLNT", &AptReader::take_coolant}, {"STOP", &AptReader::take_stop},
      {"OPSTOP", &AptReader::take_stop},   {"LOADTL", &AptReader::take_tool},    {"TURRET", &AptReader::take_tool},
      {"LOAD", &AptReader::take_tool}};
  return known;
}

void AptReader::read(std::string_view statement) {
  split(statement);
  if (text_.empty()) return;
  if (second_tool_line_ > 0 && word_ != "LOADTL" && word_ != "LOAD" && word_ != "TURRET" && word_ != "FINI") return;
  if (word_ == "GOTO") {
    take_goto();
    return;
  }
  shown_ = printable(io::trimmed(statement), shown_letters);
  if (passes() && pass_over()) return;
  for (const Statement& known : statements()) {
    if (word_ == known.word) {
      (this->*known.take)();
      return;
    }
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
  if (word_ == "CYCLE" || word_ == "CUTCOM") {
    const bool off = fields_.size() == 1 && (fields_[0] == "OFF" || fields_[0] == "NOMORE");
    passed_switch_ = off ? std::string() : shown_;
    return true;
  }
  constexpr std::array<std::string_view, 4> order = {"CALL", "JUMPTO", "LOOPST", "INDEX"};
  const std::string_view first = word_.substr(0, word_.find(','));
  const auto* const found = std::ranges::find(moving, first, &Moving::word);
  const bool moves = found != moving.end() && found->hint == as_moves;
  if (!moves || std::ranges::find(order, first) != order.end()) return false;
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

Eigen::Vector3d AptReader::position_of_numbers() const {
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  const double unit_m = inches_ ? units::inch : units::mm;
  Eigen::Vector3d position;
  for (std::size_t i = 0; i < 3; ++i) {
    position[static_cast<Eigen::Index>(i)] = numbers_[i] * unit_m;
    check_coordinate(names[i], numbers_[i] * unit_m, numbers_[i], unit_name());
  }
  return position;
}

void AptReader::take_goto() {
  take_numbers(3, 6);
  Pose end = {.tip_m = position_of_numbers(), .axis = pose_.axis};
  if (numbers_.size() == 6) end.axis = unit_axis("i, j, k", {numbers_[3], numbers_[4], numbers_[5]});
  go(end);
}

void AptReader::take_godlta() {
  take_numbers(1, 3);
  if (!start_ && !passes()) {
    reject("GODLTA", std::nullopt, "", "is a step from a position that no line has given", "Begin with FROM/ or GOTO/");
  }
  Pose end = pose_;
  if (numbers_.size() == 3) {
    end.tip_m += position_of_numbers();
  } else {
    end.tip_m += numbers_[0] * (inches_ ? units::inch : units::mm) * pose_.axis;
  }
  for (Eigen::Index i = 0; i < 3; ++i) check_coordinate("GODLTA", end.tip_m[i], numbers_[0], unit_name());
  go(end);
}

void AptReader::take_from() {
  take_numbers(3, 6);
  Pose at = {.tip_m = position_of_numbers(), .axis = pose_.axis};
  if (numbers_.size() == 6) at.axis = unit_axis("i, j, k", {numbers_[3], numbers_[4], numbers_[5]});
  if (!start_ || passes()) {
    begin_at(at);
  } else if (moves_to(at)) {
    reject_text("FROM", shown_, "is another position than the one that the tool has come to",
                "FROM/ states where the first move begins; GOTO/ moves");
  }
}

void AptReader::go(const Pose& end) {
  const bool rapid = rapid_;
  rapid_ = false;
  begin_part_move();
  if (!passed_switch_.empty() && !passes()) {
    reject_text("LOADTL", passed_switch_, "of another tool is still on where this one moves", "Is its OFF missing?");
  }
  if (!start_ || passes()) {
    begin_at(end);
    return;
  }
  if (!moves_to(end)) return;
  if (cutting_ && tool_ != cutting_tool_) {
    second_tool_line_ = tool_line_;
    second_move_line_ = line_;
    return;
  }
  const double turn_rad = turn_to(end.axis);
  if (rapid) {
    move(Block::Kind::rapid, end, 0.0);
    return;
  }
  if (!std::exchange(cutting_, true)) cutting_tool_ = tool_;
  move(Block::Kind::feed, end, feed_duration_s((end.tip_m - pose_.tip_m).norm(), turn_rad));
}

double AptReader::feed_duration_s(double length_m, double turn_rad) const {
  if (!(feed_ > 0.0)) {
    reject("FEDRAT", std::nullopt, "", "must be > 0 where the tool moves at feed", "Is a FEDRAT/ missing before it?");
  }
  double per_minute = feed_;
  if (feed_per_revolution_) {
    if (!(spindle_speed_rad_per_s_ > 0.0)) {
      reject("FEDRAT", feed_, feed_in_inches_ ? "in/rev" : "mm/rev", "needs a spindle speed, which no line has given",
             "Give SPINDL/ in rpm or FEDRAT/ a minute");
    }
    per_minute *= spindle_speed_rad_per_s_ / units::rpm;
  }
  if (length_m > 0.0) return units::minute * length_m / (per_minute * (feed_in_inches_ ? units::inch : units::mm));
  return units::minute * turn_rad / units::deg / per_minute;
}

void AptReader::take_feed() {
  bool inches = inches_;
  bool per_revolution = false;
  std::optional<double> feed;
  for (const std::string_view field : fields_) {
    const auto* const unit = std::ranges::find(feed_units, field, &FeedUnit::word);
    if (unit != feed_units.end()) {
      inches = unit->inches.value_or(inches_);
      per_revolution = unit->per_revolution;
    } else if (!field.empty() && field.front() >= 'A' && field.front() <= 'Z') {
      reject_text("FEDRAT", field, "is no unit of a feed known here", "Known are MMPM, IPM, MMPR, IPR, PERMIN, PERREV");
    } else if (feed) {
      reject_text("FEDRAT", shown_, "has two numbers");
    } else {
      feed = number_of(field);
    }
  }
  if (!feed) reject("FEDRAT", std::nullopt, "", "has no number");
  check_feed("FEDRAT", *feed);
  feed_ = *feed;
  feed_in_inches_ = inches;
  feed_per_revolution_ = per_revolution;
}

void AptReader::take_units() {
  const std::string_view unit = fields_.empty() ? std::string_view() : fields_.front();
  const bool inches = unit == "INCHES" || unit == "INCH" || unit == "IN";
  if (!inches && unit != "MM") reject_text("UNITS", unit, "is no unit known here", "Known are MM and INCHES");
  inches_ = inches;
}

void AptReader::take_spindle() {
  if (fields_.size() == 1 && fields_[0] == "OFF") {
    spindle_ = Spindle::off;
    return;
  }
  std::optional<double> speed;
  Spindle direction = Spindle::clockwise;  // where the statement says none
  for (const std::string_view field : fields_) {
    if (field == "CCLW") direction = Spindle::counterclockwise;
    const bool known = field == "RPM" || field == "CLW" || field == "CCLW";
    if (known) continue;
    if (speed || field.empty() || (field.front() >= 'A' && field.front() <= 'Z')) {
      skip_statement();  // a surface speed, a range of gears, on and off
      return;
    }
    speed = number_of(field);
  }
  if (!speed) {
    skip_statement();
    return;
  }
  check_feed("SPINDL", *speed);
  spindle_speed_rad_per_s_ = *speed * units::rpm;
  spindle_ = direction;
}

void AptReader::take_coolant() {
  const std::string_view field = fields_.size() == 1 ? fields_[0] : std::string_view();
  if (field == "OFF") {
    coolant_ = {};
  } else if (field == "ON" || field == "FLOOD") {
    coolant_.flood = true;
  } else if (field == "MIST") {
    coolant_.mist = true;
  } else if (field == "THRU") {
    coolant_.through_tool = true;
  } else {
    skip_statement();
  }
}

// LOADTL/4, LOADTL/4,ADJUST,1, TURRET/4, LOAD/TOOL,4.
void AptReader::take_tool() {
  const std::size_t place = word_ == "LOAD" ? 1 : 0;
  if (place == 1 && (fields_.empty() || fields_[0] != "TOOL")) {
    skip_statement();
    return;
  }
  tool_ = fields_.size() > place ? std::string(fields_[place]) : std::string();
  tool_line_ = line_;
  const std::optional<double> number = io::parse_number(tool_.starts_with('T') ? tool_.substr(1) : tool_);
  const std::optional<int> whole = number ? whole_tool(*number) : std::nullopt;
  mount_tool(whole, whole ? fmt::format("T{}", *whole) : tool_.empty() ? std::string("one without a number") : tool_);
  skip_statement();
}

void AptReader::at_end() {
  if (second_tool_line_ == 0) return;
  throw SeveralTools(
      {.where = fmt::format("{}:{}", file_, second_tool_line_),
       .field = "LOADTL",
       .rule = fmt::format("mounts another tool than the one that has cut, whose length is not known here, and line "
                           "{} moves it",
                           second_move_line_),
       .hint = "Write a program for each tool"},
      tools_.parts(), tools_.count());
}

void AptReader::take_stop() {
  if (!start_) {
    skip_statement();
    return;
  }
  dwell(0.0, word_ == "STOP" ? OperatorStop::always : OperatorStop::optional);
}

void AptReader::take_delay() {
  const bool seconds =
      fields_.size() == 1 && !fields_[0].empty() && !(fields_[0].front() >= 'A' && fields_[0].front() <= 'Z');
  if (!seconds || !start_) {
    skip_statement();
    return;
  }
  const double time_s = number_of(fields_[0]);
  check_dwell("DELAY", time_s);
  if (time_s == 0.0) {
    skip_statement();
  } else {
    dwell(time_s);
  }
}

void AptReader::take_system() {
  if (start_ && text_ != system_) {
    reject_text("MSYS", shown_, "changes the coordinate system within the program",
                "Positions count in one system from the first on; write a file for each");
  }
  system_ = text_;
  skip_statement();
}

/// Statements that move what is not read while they are on.
void AptReader::take_switch() {
  const bool off = fields_.size() == 1 && (fields_[0] == "OFF" || fields_[0] == "NOMORE");
  if (!off) {
    reject_text(std::string(word_), shown_, "is not read: it may move the tool or its frame",
                word_ == "CYCLE"    ? "Let the CAM system write cycles as straight moves"
                : word_ == "CUTCOM" ? "Let the CAM system write the path of the tool's tip"
                                    : as_frame);
  }
  skip_statement();
}

}  // namespace robomill::program
