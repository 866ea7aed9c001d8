#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace robomill::io {

/// The unsigned number of so many bytes, 8 at most, at a place.
[[nodiscard]] inline std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t width,
                                             bool big_endian) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < width; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + (big_endian ? i : width - 1 - i)]);
  }
  return value;
}

}  // namespace robomill::io
