#include "robomill/path/files/setpoint_lines.hpp"

#include <array>
#include <charconv>
#include <string_view>

#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"

namespace robomill::path {
namespace {

template <class Number>
void put_number(std::string& to, Number value) {
  std::array<char, 32> digits{};
  to.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

/// Numbers of a vector with a comma between them.
template <class Vector>
void put_vector(std::string& to, const Vector& values, int count, double unit) {
  for (int i = 0; i < count; ++i) {
    if (i > 0) to += ',';
    put_number(to, values[i] / unit);
  }
}

}  // namespace

SetpointFormat setpoint_format_of(const std::filesystem::path& path) {
  return io::format_of(path) == io::Format::csv ? SetpointFormat::csv : SetpointFormat::json;
}

std::string setpoint_header(SetpointFormat format, int joints) {
  if (format == SetpointFormat::json) return {};
  std::string out = "time_s";
  for (int joint = 1; joint <= joints; ++joint) {
    out += ",q";
    put_number(out, joint);
  }
  return out + ",x_mm,y_mm,z_mm,i,j,k,block,override,state\n";
}

void append_setpoint(std::string& to, const Setpoint& setpoint, SetpointFormat format, int joints) {
  const Sample& sample = setpoint.sample;
  const bool json = format == SetpointFormat::json;
  const auto next = [&](const char* in_json) { json ? to += in_json : to += ','; };
  if (json) to += "{\"time_s\":";
  put_number(to, sample.time_s);
  next(",\"joints\":[");
  put_vector(to, sample.joints, joints, 1.0);
  next("],\"tip_mm\":[");
  put_vector(to, sample.tip_m, 3, units::mm);
  next("],\"axis\":[");
  put_vector(to, sample.axis, 3, 1.0);
  next("],\"block\":");
  put_number(to, sample.block + 1);
  next(",\"override\":");
  put_number(to, setpoint.feed_override);
  next(",\"state\":\"");
  to += name_in(interpolator_state_names, setpoint.state);
  to += json ? "\"}\n" : "\n";
}

}  // namespace robomill::path
