// What an AptReader's program says of feed, tool, spindle and coolant.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"
#include "robomill/program/files/apt_reader.hpp"

namespace robomill::program {
namespace {

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

}  // namespace

double AptReader::feed_duration_s(const FeedRate& feed, double length_m, double turn_rad) const {
  if (!(feed.value > 0.0)) {
    reject("FEDRAT", std::nullopt, "", "must be > 0 where the tool moves at feed", "Is a FEDRAT/ missing before it?");
  }
  double per_minute = feed.value;
  if (feed.per_revolution) {
    if (!(spindle_speed_rad_per_s_ > 0.0)) {
      reject("FEDRAT", feed.value, feed.inches ? "in/rev" : "mm/rev", "needs a spindle speed, which no line has given",
             "Give SPINDL/ in rpm or FEDRAT/ a minute");
    }
    per_minute *= spindle_speed_rad_per_s_ / units::rpm;
  }
  if (length_m > 0.0) return units::minute * length_m / (per_minute * (feed.inches ? units::inch : units::mm));
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
  feed_ = {.value = *feed, .inches = inches, .per_revolution = per_revolution};
  feed_in_cycle(feed_);
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
  const std::string_view field = fields_.empty() ? std::string_view() : fields_[0];
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

// A number that a statement loads is the tool's; a path's tool has a name alone.
void AptReader::mount() {
  tool_ = fmt::format("{}|{}", loaded_, path_tool_);
  tool_word_ = word_ == "TOOLPATH" ? "TOOL PATH" : std::string(word_);
  tool_line_ = line_;
  const std::optional<double> number = io::parse_number(loaded_.starts_with('T') ? loaded_.substr(1) : loaded_);
  const std::optional<int> whole = number ? whole_tool(*number) : std::nullopt;
  std::string name = loaded_.empty() ? path_tool_ : loaded_;
  if (whole) tool_ = name = fmt::format("T{}", *whole);
  mount_tool(whole, name.empty() ? std::string(nameless_tool) : std::move(name));
  skip_statement();
}

void AptReader::take_tool() {
  loaded_ = fields_.empty() ? std::string() : std::string(fields_[0]);
  mount();
}

void AptReader::take_load() {
  if (fields_.empty() || fields_[0] != "TOOL") {
    skip_statement();
    return;
  }
  loaded_ = fields_.size() > 1 ? std::string(fields_[1]) : std::string();
  mount();
}

// TOOL PATH/NAME,TOOL,ITS_TOOL
void AptReader::take_tool_path() {
  if (fields_.size() < 3 || fields_[1] != "TOOL" || fields_[2] == path_tool_) {
    skip_statement();
    return;
  }
  path_tool_ = fields_[2];
  loaded_.clear();  // its number comes with LOAD
  mount();
}

bool AptReader::is_second_tool() {
  if (!cutting_ || tool_ == cutting_tool_) return false;
  second_tool_line_ = tool_line_;
  second_tool_word_ = tool_word_;
  second_move_line_ = line_;
  return true;
}

void AptReader::at_end() {
  if (second_tool_line_ == 0) return;
  throw SeveralTools(
      {.where = fmt::format("{}:{}", file_, second_tool_line_),
       .field = second_tool_word_,
       .rule = fmt::format("mounts another tool than the one that has cut, whose length is not known here, and line "
                           "{} moves it",
                           second_move_line_),
       .hint = "Write a program for each tool"},
      tools_.parts(), tools_.count());
}

void AptReader::begin_cutting() {
  if (!std::exchange(cutting_, true)) cutting_tool_ = tool_;
}

void AptReader::take_stop() {
  if (!start_ || is_over()) {
    skip_statement();
    return;
  }
  dwell(0.0, word_ == "STOP" ? OperatorStop::always : OperatorStop::optional);
}

void AptReader::take_delay() {
  const bool seconds =
      fields_.size() == 1 && !fields_[0].empty() && !(fields_[0].front() >= 'A' && fields_[0].front() <= 'Z');
  if (!seconds || !start_ || is_over()) {
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

// Cutter locations are those of the tool's tip: the path stands in the file offset already.
void AptReader::take_compensation() {
  const bool off = fields_.size() == 1 && (fields_[0] == "OFF" || fields_[0] == "NOMORE");
  compensation_line_ = off ? 0 : line_;
  skip_statement();
}

}  // namespace robomill::program
