#include "robomill/io/records/labview/lvm_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

/// Numbers parted by some letters: "2016/08/23", "09:54:07,283999".
std::optional<std::array<double, 3>> three_numbers(std::string_view text, char separator) {
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t end = i < 2 ? text.find(separator) : text.size();
    if (end == std::string_view::npos) return std::nullopt;
    const std::optional<double> number = parse_cell(text.substr(0, end));
    if (!number || !(*number >= 0.0 && *number < 1e4)) return std::nullopt;
    out[i] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

ChannelStart lvm_start(std::string_view date, std::string_view time, double x0_s) {
  const auto day = three_numbers(date, '/'), clock = three_numbers(time, ':');
  if (!day || !clock || !std::isfinite(x0_s)) return {};
  const std::chrono::year_month_day on(std::chrono::year(static_cast<int>((*day)[0])),
                                       std::chrono::month(static_cast<unsigned>((*day)[1])),
                                       std::chrono::day(static_cast<unsigned>((*day)[2])));
  if (!on.ok()) return {};
  return {.is_known = true,
          .day = std::chrono::sys_days(on).time_since_epoch().count(),
          .s = 3600.0 * (*clock)[0] + 60.0 * (*clock)[1] + (*clock)[2] + x0_s};
}

/// Half a unit of a number's last digit: of "1.953125E-5" 5e-12. 0 of one with fewer digits than LabVIEW writes: it is
/// taken as exact.
double rounding_of(std::string_view number) {
  constexpr std::size_t decimals_written = 6;
  const std::size_t letter = std::min(number.find_first_of("eEdD"), number.size());
  const std::string_view digits = number.substr(0, letter);
  const std::size_t point = digits.find_first_of(".,");
  const std::size_t decimals = point == std::string_view::npos ? 0 : digits.size() - point - 1;
  if (decimals < decimals_written) return 0.0;
  std::string_view exponent = number.substr(std::min(letter + 1, number.size()));
  if (exponent.starts_with('+')) exponent.remove_prefix(1);
  int power = 0;
  std::from_chars(exponent.data(), exponent.data() + exponent.size(), power);
  return 0.5 * std::pow(10.0, power - static_cast<double>(decimals));
}

}  // namespace

void LvmHeader::take(std::string_view line, const std::string& where) {
  const std::size_t end = line.find_first_of("\t,");
  if (end == std::string_view::npos) return;
  const std::string_view tag = line.substr(0, end);
  std::string_view value = line.substr(end + 1);
  value = value.substr(0, std::max<std::size_t>(1, value.find(line[end])));
  const auto reject = [&](const char* known) {
    return InvalidInput(where, fmt::format("{} is {}", tag, trimmed(value)), fmt::format("Known are {}", known));
  };
  if (tag == "Separator") {
    if (value != "Tab" && value != "Comma") throw reject("Tab and Comma");
    separator = value == "Tab" ? '\t' : ',';
  } else if (tag == "Decimal_Separator") {
    if (value != "." && value != ",") throw reject("a point and a comma");
    decimal = value.front();
  } else if (tag == "X_Columns") {
    if (value != "No" && value != "One" && value != "Multi") throw reject("No, One and Multi");
    x_columns = value == "No" ? XColumns::none : value == "One" ? XColumns::one : XColumns::one_a_channel;
  }
}

void LvmHeader::validate(const std::string& where) const {
  if (separator != ',' || decimal != ',') return;
  throw InvalidInput(where, "Separator and Decimal_Separator are both a comma", "Write it with Tab as the separator");
}

std::optional<double> LvmHeader::number(std::string_view field) const {
  return separator == ',' || decimal == '.' ? parse_number(field) : parse_cell(field);
}

void LvmHeader::split(std::string_view line, std::vector<std::string_view>& fields) const {
  fields.clear();
  while (true) {
    const std::size_t end = line.find(separator);
    fields.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return;
    line.remove_prefix(end + 1);
  }
}

void LvmSegmentHeader::take(const std::vector<std::string_view>& fields) {
  constexpr std::array<std::string_view, tags> names = {"Channels",     "Samples",     "Date", "Time",   "Y_Unit_Label",
                                                        "X_Unit_Label", "X_Dimension", "X0",   "Delta_X"};
  const auto* const found = std::ranges::find(names, fields.front());
  if (found != names.end())
    fields_[static_cast<std::size_t>(found - names.begin())].assign(fields.begin(), fields.end());
}

std::string_view LvmSegmentHeader::field(Tag tag, std::size_t column) const {
  const std::vector<std::string>& fields = fields_[tag];
  return column < fields.size() ? std::string_view(fields[column]) : std::string_view();
}

std::optional<std::size_t> LvmSegmentHeader::channels(const LvmHeader& header) const {
  const std::optional<double> count = header.number(field(channels_tag, 1));
  if (!count || !(*count >= 1.0 && *count < 1e9)) return std::nullopt;
  return static_cast<std::size_t>(*count);
}

LvmSegmentHeader::Channel LvmSegmentHeader::channel(std::size_t column, const LvmHeader& header) const {
  Channel out;
  out.channel.unit = std::string(field(y_unit_tag, column));
  const std::string_view dimension = field(x_dimension_tag, column), x_unit = field(x_unit_tag, column);
  const double unit_s = seconds_in(x_unit);
  if ((!dimension.empty() && lowered(dimension) != "time") || (unit_s == 0.0 && is_unit(x_unit))) {
    out.channel.fault = fmt::format("over {}", dimension.empty() || lowered(dimension) == "time" ? x_unit : dimension);
  }
  if (unit_s > 0.0) out.time_factor = unit_s;
  const double x0 = header.number(field(x0_tag, column)).value_or(0.0);
  out.channel.start = lvm_start(field(date_tag, column), field(time_tag, column), out.time_factor * x0);
  const std::string_view delta = field(delta_x_tag, column);
  const double step = header.number(delta).value_or(0.0);
  if (std::isfinite(step) && step > 0.0) {
    out.delta_x = out.time_factor * step;
    out.channel.sample_rate_hz = round_15(1.0 / out.delta_x);
    out.channel.rate_error = rounding_of(delta) / step;
  }
  const std::optional<double> samples = header.number(field(samples_tag, column));
  if (samples && *samples >= 0.0 && *samples < 1e15) out.samples = static_cast<std::size_t>(*samples);
  return out;
}

}  // namespace robomill::io
