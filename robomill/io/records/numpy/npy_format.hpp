#pragma once
// Of the reader of NPY.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/records/numpy/byte_source.hpp"

namespace robomill::io {

/// A type of values, as NumPy writes it: "<f8", "|u1", ">M8[us]".
struct NpyType {
  char kind = 0;         ///< b boolean, i u whole, f real, M m times, c complex, S U text, O V others
  std::size_t size = 0;  ///< [bytes] of a value
  bool big_endian = false;
  double tick_s = 0.0;     ///< [s] of times
  std::string fault = {};  ///< why it is no number that is read here; empty: it is one
  /// Gives the value at a place, which must be a number and no time.
  [[nodiscard]] double (*decoder() const)(const char*);
};

/// One value of each element: the array's own, or a named field of a structured one.
struct NpyField {
  std::string name = {};
  NpyType type = {};
  std::size_t offset = 0;  ///< [bytes] in the element
  std::size_t count = 1;   ///< of values, where the field is an array itself
};

/// What an array's header says.
struct NpyHeader {
  std::vector<NpyField> fields = {};
  bool is_structured = false, fortran_order = false;
  std::size_t item_bytes = 0;
  std::vector<std::uint64_t> shape = {};
  /// Of elements. At most 2^62.
  std::uint64_t items = 1;
  std::uint64_t begin = 0;  ///< [bytes] where its values begin
};

inline constexpr std::string_view npy_magic = "\x93NUMPY";

/// Reads the header, and leaves the source where the values begin.
/// Source: [NumPy2024] numpy.lib.format, versions 1.0, 2.0 and 3.0
/// @throws InvalidInput naming `where`, if it is none or makes no sense
[[nodiscard]] NpyHeader read_npy_header(ByteSource& bytes, const std::string& where);

}  // namespace robomill::io
