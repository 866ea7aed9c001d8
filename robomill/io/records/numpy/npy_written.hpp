#pragma once
// Of the tests of this folder: files as NumPy writes them.
#include <fmt/format.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace robomill::io::npy_written {

inline std::string number(std::uint64_t value, std::size_t width, bool big_endian = false) {
  std::string out;
  for (std::size_t i = 0; i < width; ++i) {
    out += static_cast<char>(value >> (8 * (big_endian ? width - 1 - i : i)) & 0xFF);
  }
  return out;
}

/// The header, filled up to a multiple of 64 bytes and ended by a line's end, and the values.
inline std::string npy(const std::string& type, const std::string& shape, std::string_view values,
                       bool fortran_order = false, int version = 1) {
  std::string text =
      fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': {}, }}", type, fortran_order ? "True" : "False", shape);
  const std::size_t before = version == 1 ? 10 : 12;
  text.resize((before + text.size() + 1 + 63) / 64 * 64 - before, ' ');
  text.back() = '\n';
  std::string out = "\x93NUMPY";
  out += static_cast<char>(version);
  out += '\0';
  return out + number(text.size(), version == 1 ? 2 : 4) + text + std::string(values);
}

inline std::string doubles(const std::vector<double>& values, bool big_endian = false) {
  std::string out;
  for (const double value : values) out += number(std::bit_cast<std::uint64_t>(value), 8, big_endian);
  return out;
}

/// Text of four bytes a letter.
inline std::string letters(std::string_view text, std::size_t length) {
  std::string out;
  for (std::size_t i = 0; i < length; ++i) {
    out += number(i < text.size() ? static_cast<unsigned char>(text[i]) : 0, 4);
  }
  return out;
}

}  // namespace robomill::io::npy_written
