#pragma once
// Of the sources of samples; not for other folders.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace robomill::io {

/// Whether raw samples begin at the first byte of a sample. A pipe that lost a byte, and a wrong format, give numbers
/// that no converter gives. Judged each 128 frames; all columns must agree, since a byte shifts them all.
///
/// float32: bytes of the mantissa stand where the exponent is, which then is about uniform over its 256 values. A third
/// of the numbers is beyond 2^50 (1e15; no unit of vibration makes such), or, where the mantissa ends in zeros, most
/// are below 2^-120. Misaligned where an eighth is beyond 2^50 or a quarter is below 2^-120.
///
/// int16: the low byte, uniform for any amplitude above some counts, stands where the high byte is. The numbers are
/// white and uniform over the full scale, rms 18,918 counts, or 256 times the true ones where these are small; read a
/// byte later they are the true ones. Where the low byte is uniform, an aligned signal has at most
/// (32768 / 18918)^2 = 3 times the variance that it has when read a byte later. Misaligned where it has more than 4
/// times: true signals up to a fifth of full scale rms are found for sure, those beyond 0.29 of it are not. A column
/// has no say where its low byte is constant (8-bit converters, constants), or where more than a quarter is at full
/// scale (clipped: then the low byte is not uniform).
class SampleAlignment {
 public:
  SampleAlignment(std::size_t columns, bool is_int16);
  /// Whole frames as they came. @return whether they are misaligned, as far as is known
  bool take(std::string_view frames);

 private:
  /// Of the frames of a window.
  struct Column {
    std::size_t numbers = 0;         // float32: finite and not 0
    std::size_t huge = 0, tiny = 0;  // float32
    double sum = 0.0, squares = 0.0;
    double shifted_sum = 0.0, shifted_squares = 0.0;  // read a byte later
    std::size_t shifted = 0, at_limit = 0;
    std::uint8_t first_low = 0;
    bool low_varies = false;
  };

  static void add_float(Column& column, std::uint32_t bits);
  static void add_int(Column& column, std::string_view from);
  [[nodiscard]] std::optional<bool> verdict(const Column& of) const;
  void judge();

  bool is_int16_, misaligned_ = false;
  std::size_t frames_ = 0;
  std::vector<Column> columns_;
};

}  // namespace robomill::io
