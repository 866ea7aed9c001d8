#pragma once
// Of the reader of TDMS.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>

namespace robomill::io {

/// A type of numbers or other values in a TDMS file.
struct TdmsType {
  enum class Kind { signed_integer, unsigned_integer, real, time, text, complex };
  std::uint32_t code = 0;
  std::size_t width = 0;  ///< [bytes]; 0 of a text
  Kind kind = Kind::real;
  [[nodiscard]] bool is_number() const { return kind != Kind::text && kind != Kind::complex; }
};
/// Null where the code is none that is read here: fixed point and extended precision among others.
[[nodiscard]] const TdmsType* tdms_type(std::uint32_t code);
/// Of a scaler of DAQmx, which has codes of its own.
[[nodiscard]] const TdmsType* tdms_scaler_type(std::uint32_t code);

/// Seconds since a fixed day, and parts of one.
struct TdmsTime {
  std::int64_t seconds = 0;
  std::uint64_t fraction = 0;  ///< of 2^64
  /// [s] from one to another.
  [[nodiscard]] double after(const TdmsTime& other) const;
};

/// A number of a kind that is no time.
[[nodiscard]] double tdms_number(std::string_view bytes, std::size_t at, const TdmsType& type, bool big_endian);
[[nodiscard]] TdmsTime tdms_time(std::string_view bytes, std::size_t at, bool big_endian);

/// The value of a property, by its type.
struct TdmsProperty {
  std::string text = {};
  double number = std::numeric_limits<double>::quiet_NaN();  ///< not finite where it is none
  TdmsTime time = {};
  bool is_time = false;
};
using TdmsProperties = std::map<std::string, TdmsProperty, std::less<>>;

/// The number of a property; not finite where there is none.
[[nodiscard]] double number_of(const TdmsProperties& properties, std::string_view name);
[[nodiscard]] std::string text_of(const TdmsProperties& properties, std::string_view name);

}  // namespace robomill::io
