#include "robomill/io/records/mat_layout.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>

#include "robomill/base/error.hpp"
#include "robomill/io/byte_order.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t header_bytes = 128;  // of level 5
constexpr std::size_t tag_bytes = 8;
constexpr std::size_t level_4_header_bytes = 20;

std::uint32_t number(std::string_view bytes, std::size_t at, bool big_endian) {
  return static_cast<std::uint32_t>(number_at(bytes, at, 4, big_endian));
}

/// A MAT file's variables, one behind the other.
struct Walk {
  MatLayout layout = {};
  bool makes_sense = true;
  std::vector<std::string_view> variables = {};  ///< the bytes of those that are whole
};

/// @param length  of the variable at a place, 0: makes no sense
template <class Length>
Walk walk(std::string_view bytes, std::size_t begin, std::size_t head, const Length& length) {
  Walk out;
  std::size_t at = begin;
  while (at < bytes.size()) {
    if (bytes.size() - at < head) return out;
    const std::uint64_t of_one = length(at);
    out.makes_sense = of_one != 0;
    if (!out.makes_sense || of_one > bytes.size() - at) return out;
    out.variables.push_back(bytes.substr(at, static_cast<std::size_t>(of_one)));
    at += static_cast<std::size_t>(of_one);
    ++out.layout.variables;
  }
  out.layout.whole = true;
  return out;
}

constexpr std::uint32_t matrix_type = 14, packed_type = 15;

Walk level_5(std::string_view bytes, bool big_endian) {
  return walk(bytes, header_bytes, tag_bytes, [&](std::size_t at) -> std::uint64_t {
    const std::uint32_t type = number(bytes, at, big_endian);
    if (type != matrix_type && type != packed_type) return 0;
    return tag_bytes + std::uint64_t{number(bytes, at + 4, big_endian)};
  });
}

/// Thousands of the type: 0 little-endian, 1 big-endian. Read the other way it is huge.
bool is_big_endian_4(std::string_view bytes, std::size_t at) {
  return number(bytes, at, false) > 4052;
}

Walk level_4(std::string_view bytes) {
  constexpr std::array<std::uint64_t, 6> widths = {8, 4, 4, 2, 2, 1};
  constexpr std::uint64_t longest_name = 4096, most_values = std::uint64_t{1} << 50;
  const auto length = [&](std::size_t at) -> std::uint64_t {
    const bool big_endian = is_big_endian_4(bytes, at);
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

/// What a packed variable begins with.
std::string unpacked_beginning(std::string_view packed) {
  std::string out(1024, '\0');  // a name of 63 letters behind some tags
  std::string in(packed.substr(0, 4096));
  z_stream stream = {};
  if (::inflateInit(&stream) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  ::inflate(&stream, Z_SYNC_FLUSH);
  out.resize(out.size() - stream.avail_out);
  ::inflateEnd(&stream);
  return out;
}

/// Takes the next part of a matrix of level 5 off; empty where it is not whole.
std::string_view next_part(std::string_view& bytes, bool big_endian) {
  if (bytes.size() < tag_bytes) return {};
  const std::uint32_t type = number(bytes, 0, big_endian);
  std::size_t length = number(bytes, 4, big_endian), begin = tag_bytes, all = tag_bytes + (length + 7) / 8 * 8;
  if (type >> 16 != 0) {  // of four bytes at most: its length stands beside its type
    length = type >> 16;
    begin = 4;
    all = tag_bytes;
  }
  if (begin + length > bytes.size()) return {};
  const std::string_view out = bytes.substr(begin, length);
  bytes.remove_prefix(std::min(all, bytes.size()));
  return out;
}

std::string name_5(std::string_view variable, bool big_endian) {
  std::string unpacked;
  if (number(variable, 0, big_endian) == packed_type) {
    unpacked = unpacked_beginning(variable.substr(tag_bytes));
    variable = unpacked;
  }
  if (variable.size() < tag_bytes || number(variable, 0, big_endian) != matrix_type) return {};
  variable.remove_prefix(tag_bytes);
  static_cast<void>(next_part(variable, big_endian));  // its flags
  static_cast<void>(next_part(variable, big_endian));  // its dimensions
  return std::string(next_part(variable, big_endian));
}

std::string name_4(std::string_view variable) {
  const std::uint32_t length = number(variable, 16, is_big_endian_4(variable, 0));
  const std::string_view name = variable.substr(level_4_header_bytes, length);
  return std::string(name.substr(0, name.find('\0')));
}

/// By its header: of level 5 its order of bytes too; of another level none.
struct Level {
  bool is_5 = false, is_later = false, big_endian = false;
};

Level level_of(std::string_view bytes) {
  if (bytes.size() < header_bytes) return {};
  const std::string_view order = bytes.substr(126, 2);
  const bool big_endian = order == "MI";
  if (!big_endian && order != "IM") return {};
  const bool is_5 = static_cast<unsigned char>(bytes[big_endian ? 124 : 125]) == 1;
  return {.is_5 = is_5, .is_later = !is_5, .big_endian = big_endian};
}

}  // namespace

std::optional<MatLayout> mat_layout(std::string_view bytes) {
  const Level level = level_of(bytes);
  if (level.is_later) return std::nullopt;
  const Walk found = level.is_5 ? level_5(bytes, level.big_endian) : level_4(bytes);
  return found.makes_sense ? std::optional(found.layout) : std::nullopt;
}

std::vector<std::string> mat_names(std::string_view bytes) {
  constexpr std::size_t most = 1000;
  const Level level = level_of(bytes);
  if (level.is_later) return {};
  const Walk found = level.is_5 ? level_5(bytes, level.big_endian) : level_4(bytes);
  std::vector<std::string> out;
  for (const std::string_view variable : found.variables) {
    if (out.size() == most) break;
    out.push_back(level.is_5 ? name_5(variable, level.big_endian) : name_4(variable));
  }
  return out;
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
