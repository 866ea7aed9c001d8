#include "robomill/live/files/command_json.hpp"

#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"

namespace robomill::live {
std::string command_line(const Command& command, double decided_unix_s) {
  const bool speed = command.kind == Command::Kind::spindle_speed;
  io::Json json;
  json["time_s"] = io::number(command.time_s);
  json["decided_unix_s"] = decided_unix_s;  // microseconds need 16 digits
  json["command"] = name_in(command_names, command.kind);
  json["spindle_speed_rpm"] = io::positive(command.spindle_speed_rad_per_s, units::rpm);
  json["feed_override"] = io::number(command.feed_override);
  json["retract_mm"] = io::positive(command.retract_m, units::mm);
  json["first"] = speed ? io::Json(command.feed_first ? "feed" : "spindle") : io::Json(nullptr);
  json["reason"] = command.reason;
  json["not_claimed"] = command.not_claimed;
  return io::plain_text(json) + '\n';
}

}  // namespace robomill::live
