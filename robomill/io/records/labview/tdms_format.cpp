#include "robomill/io/records/labview/tdms_format.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include "robomill/io/byte_order.hpp"

namespace robomill::io {
namespace {

using Kind = TdmsType::Kind;
// 0x19 and 0x1A are numbers whose unit stands in a property.
constexpr TdmsType types[] = {{0x01, 1, Kind::signed_integer},
                              {0x02, 2, Kind::signed_integer},
                              {0x03, 4, Kind::signed_integer},
                              {0x04, 8, Kind::signed_integer},
                              {0x05, 1, Kind::unsigned_integer},
                              {0x06, 2, Kind::unsigned_integer},
                              {0x07, 4, Kind::unsigned_integer},
                              {0x08, 8, Kind::unsigned_integer},
                              {0x09, 4, Kind::real},
                              {0x0A, 8, Kind::real},
                              {0x19, 4, Kind::real},
                              {0x1A, 8, Kind::real},
                              {0x20, 0, Kind::text},
                              {0x21, 1, Kind::unsigned_integer},
                              {0x44, 16, Kind::time},
                              {0x08000C, 8, Kind::complex},
                              {0x10000D, 16, Kind::complex}};
/// Places in the list above.
constexpr std::size_t scaler_types[] = {4, 0, 5, 1, 6, 2};

}  // namespace

const TdmsType* tdms_type(std::uint32_t code) {
  const auto* const found = std::ranges::find(types, code, &TdmsType::code);
  return found == std::end(types) ? nullptr : found;
}

const TdmsType* tdms_scaler_type(std::uint32_t code) {
  return code < std::size(scaler_types) ? &types[scaler_types[code]] : nullptr;
}

double TdmsTime::after(const TdmsTime& other) const {
  const double parts =
      std::ldexp(static_cast<double>(fraction), -64) - std::ldexp(static_cast<double>(other.fraction), -64);
  return static_cast<double>(seconds) - static_cast<double>(other.seconds) + parts;
}

double tdms_number(std::string_view bytes, std::size_t at, const TdmsType& type, bool big_endian) {
  const std::uint64_t bits = number_at(bytes, at, type.width, big_endian);
  if (type.kind == Kind::unsigned_integer) return static_cast<double>(bits);
  if (type.kind == Kind::signed_integer) {
    const auto unused = static_cast<int>(64 - 8 * type.width);
    return static_cast<double>(std::bit_cast<std::int64_t>(bits << unused) >> unused);
  }
  if (type.width == 4) return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  return std::bit_cast<double>(bits);
}

TdmsTime tdms_time(std::string_view bytes, std::size_t at, bool big_endian) {
  return {.seconds = std::bit_cast<std::int64_t>(number_at(bytes, at + (big_endian ? 0 : 8), 8, big_endian)),
          .fraction = number_at(bytes, at + (big_endian ? 8 : 0), 8, big_endian)};
}

double number_of(const TdmsProperties& properties, std::string_view name) {
  const auto found = properties.find(name);
  return found == properties.end() ? std::numeric_limits<double>::quiet_NaN() : found->second.number;
}

std::string text_of(const TdmsProperties& properties, std::string_view name) {
  const auto found = properties.find(name);
  return found == properties.end() ? std::string() : found->second.text;
}

}  // namespace robomill::io
