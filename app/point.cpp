#include "point.hpp"

#include <charconv>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/jobs/files/in_words.hpp"

namespace robomill::app {

stability::OperatingPoint parse_point(const std::string& text) {
  const auto reject = [&text] {
    return InvalidInput(InvalidInput::Parts{
        .field = "--at", .value = "\"" + text + "\"", .rule = "must read RPM,MM", .hint = "For example --at 6500,0.8"});
  };
  double rpm = 0.0;
  double mm = 0.0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result first = std::from_chars(text.data(), end, rpm);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != ',') throw reject();
  const std::from_chars_result second = std::from_chars(first.ptr + 1, end, mm);
  if (second.ec != std::errc() || second.ptr != end || !(rpm > 0.0) || !std::isfinite(mm)) throw reject();
  return {.spindle_speed_rad_per_s = spindle_speed("--at", rpm), .axial_depth_m = mm * units::mm};
}

double spindle_speed(const char* option, double rpm) {
  try {
    cutting::require_spindle_speed(option, rpm * units::rpm);
  } catch (const InvalidInput& error) {
    throw jobs::in_unit(error, units::rpm, "rpm");
  }
  return rpm * units::rpm;
}

}  // namespace robomill::app
