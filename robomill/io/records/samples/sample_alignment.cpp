#include "robomill/io/records/samples/sample_alignment.hpp"

#include <algorithm>
#include <bit>

namespace robomill::io {
namespace {

constexpr std::size_t window_frames = 128;
constexpr std::size_t least_numbers = 32;  // of a window, for a column to have a say
constexpr std::uint32_t exponent_bias = 127, not_finite = 255;
constexpr std::uint32_t huge_exponent = exponent_bias + 50, tiny_exponent = exponent_bias - 120;
constexpr std::size_t huge_share = 8, tiny_share = 4;  // one in so many
constexpr int at_limit_counts = 32'764;
constexpr std::size_t at_limit_share = 4;  // one in so many
constexpr double variance_ratio = 4.0;

std::uint32_t byte_at(std::string_view from, std::size_t i) {
  return static_cast<unsigned char>(from[i]);
}

int int16_at(std::string_view from, std::size_t i) {
  return std::bit_cast<std::int16_t>(static_cast<std::uint16_t>(byte_at(from, i) | byte_at(from, i + 1) << 8));
}

double variance(double sum, double squares, std::size_t count) {
  const auto n = static_cast<double>(std::max<std::size_t>(count, 1));
  return squares / n - sum / n * (sum / n);
}

}  // namespace

SampleAlignment::SampleAlignment(std::size_t columns, bool is_int16) : is_int16_(is_int16), columns_(columns) {}

void SampleAlignment::add_float(Column& column, std::uint32_t bits) {
  const std::uint32_t exponent = bits >> 23 & 0xFFU;
  if (exponent == not_finite || (bits & 0x7FFF'FFFFU) == 0) return;
  ++column.numbers;
  if (exponent > huge_exponent) ++column.huge;
  if (exponent < tiny_exponent) ++column.tiny;
}

void SampleAlignment::add_int(Column& column, std::string_view from) {
  const int value = int16_at(from, 0);
  const auto x = static_cast<double>(value);
  const bool first = column.numbers++ == 0;
  if (first) column.first_low = static_cast<std::uint8_t>(byte_at(from, 0));
  column.low_varies = column.low_varies || byte_at(from, 0) != column.first_low;
  column.sum += x;
  column.squares += x * x;
  if (value >= at_limit_counts || value <= -at_limit_counts) ++column.at_limit;
  if (from.size() < 3) return;
  const auto later = static_cast<double>(int16_at(from, 1));
  ++column.shifted;
  column.shifted_sum += later;
  column.shifted_squares += later * later;
}

std::optional<bool> SampleAlignment::verdict(const Column& of) const {
  if (of.numbers < least_numbers) return std::nullopt;
  if (!is_int16_) return huge_share * of.huge > of.numbers || tiny_share * of.tiny > of.numbers;
  if (!of.low_varies || at_limit_share * of.at_limit > of.numbers) return std::nullopt;
  return variance(of.sum, of.squares, of.numbers) >
         variance_ratio * variance(of.shifted_sum, of.shifted_squares, of.shifted);
}

void SampleAlignment::judge() {
  bool any = false;
  bool all = true;
  for (Column& column : columns_) {
    const std::optional<bool> is_misaligned = verdict(column);
    any = any || is_misaligned.has_value();
    all = all && is_misaligned.value_or(true);
    column = {};
  }
  if (any) misaligned_ = all;
  frames_ = 0;
}

bool SampleAlignment::take(std::string_view frames) {
  const std::size_t width = is_int16_ ? 2 : 4;
  bool judged = false;
  bool misaligned = false;
  for (std::size_t at = 0; at + width * columns_.size() <= frames.size();) {
    for (Column& column : columns_) {
      const std::string_view from = frames.substr(at);
      if (is_int16_) {
        add_int(column, from);
      } else {
        add_float(column, byte_at(from, 0) | byte_at(from, 1) << 8 | byte_at(from, 2) << 16 | byte_at(from, 3) << 24);
      }
      at += width;
    }
    if (++frames_ < window_frames) continue;
    judge();
    judged = true;
    misaligned = misaligned || misaligned_;
  }
  return judged ? misaligned : misaligned_;
}

}  // namespace robomill::io
