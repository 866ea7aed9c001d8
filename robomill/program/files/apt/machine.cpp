// What an AptReader's program says of tool, spindle and coolant.
#include <fmt/format.h>

#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"
#include "robomill/program/files/apt_reader.hpp"

namespace robomill::program {

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
  mount_tool(whole, name.empty() ? std::string("one without a number") : std::move(name));
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

// Cutter locations are those of the tool's tip: the path stands in the file offset already.
void AptReader::take_compensation() {
  const bool off = fields_.size() == 1 && (fields_[0] == "OFF" || fields_[0] == "NOMORE");
  compensation_line_ = off ? 0 : line_;
  skip_statement();
}

}  // namespace robomill::program
