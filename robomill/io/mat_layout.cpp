#include "robomill/io/mat_layout.hpp"

#include <fmt/format.h>

#include <array>

#include "robomill/base/error.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t header_bytes = 128;  // of level 5
constexpr std::size_t tag_bytes = 8;
constexpr std::size_t level_4_header_bytes = 20;

std::uint32_t number(std::string_view bytes, std::size_t at, bool big_endian) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value = value << 8 | static_cast<unsigned char>(bytes[at + (big_endian ? i : 3 - i)]);
  }
  return value;
}

/// @param length  of the variable at a place, 0: makes no sense
template <class Length>
std::optional<MatLayout> walk(std::string_view bytes, std::size_t begin, std::size_t head, const Length& length) {
  MatLayout out;
  std::size_t at = begin;
  while (at < bytes.size()) {
    if (bytes.size() - at < head) return out;
    const std::uint64_t of_one = length(at);
    if (of_one == 0) return std::nullopt;
    if (of_one > bytes.size() - at) return out;
    at += static_cast<std::size_t>(of_one);
    ++out.variables;
  }
  out.whole = true;
  return out;
}

std::optional<MatLayout> level_5(std::string_view bytes, bool big_endian) {
  constexpr std::uint32_t matrix = 14, compressed = 15;
  return walk(bytes, header_bytes, tag_bytes, [&](std::size_t at) -> std::uint64_t {
    const std::uint32_t type = number(bytes, at, big_endian);
    if (type != matrix && type != compressed) return 0;
    return tag_bytes + std::uint64_t{number(bytes, at + 4, big_endian)};
  });
}

std::optional<MatLayout> level_4(std::string_view bytes) {
  constexpr std::array<std::uint64_t, 6> widths = {8, 4, 4, 2, 2, 1};
  constexpr std::uint64_t longest_name = 4096, most_values = std::uint64_t{1} << 50;
  const auto length = [&](std::size_t at) -> std::uint64_t {
    // Thousands of the type: 0 little-endian, 1 big-endian. Read the other way it is huge.
    const bool big_endian = number(bytes, at, false) > 4052;
    const std::uint32_t type = number(bytes, at, big_endian);
    const std::uint32_t width = type / 10 % 10;
    if (type / 1000 != (big_endian ? 1U : 0U) || type / 100 % 10 != 0 || width >= widths.size() || type % 10 > 2) {
      return 0;
    }
    const std::uint64_t rows = number(bytes, at + 4, big_endian), columns = number(bytes, at + 8, big_endian);
    const std::uint64_t imaginary = number(bytes, at + 12, big_endian), name = number(bytes, at + 16, big_endian);
    if (imaginary > 1 || name > longest_name || rows * columns > most_values) return 0;
    return level_4_header_bytes + name + rows * columns * widths[width] * (1 + imaginary);
  };
  return walk(bytes, 0, level_4_header_bytes, length);
}

}  // namespace

std::optional<MatLayout> mat_layout(std::string_view bytes) {
  if (bytes.size() >= header_bytes) {
    const std::string_view order = bytes.substr(126, 2);
    const bool big_endian = order == "MI";
    if (big_endian || order == "IM") {
      const auto major = static_cast<unsigned char>(bytes[big_endian ? 124 : 125]);
      return major == 1 ? level_5(bytes, big_endian) : std::nullopt;
    }
  }
  return level_4(bytes);
}

void require_held(const std::string& file, const std::string& variable, std::uint64_t rows, std::uint64_t columns,
                  std::size_t value_bytes, std::size_t file_bytes) {
  constexpr double most_packed = 1100.0;
  const double bytes = static_cast<double>(rows) * static_cast<double>(columns) * static_cast<double>(value_bytes);
  if (bytes <= most_packed * static_cast<double>(file_bytes)) return;
  throw InvalidInput(file, fmt::format("variable {} says that it holds {} x {} values, more than the file can",
                                       variable, rows, columns));
}

}  // namespace robomill::io
