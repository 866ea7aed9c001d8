#include "robomill/io/stl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"

namespace robomill::io {
namespace {

constexpr std::uintmax_t most_stl_bytes = std::uintmax_t{512} << 20;
constexpr std::size_t stl_header = 84, stl_record = 50;  // 80 bytes of text and the number of triangles; a triangle
constexpr double farthest_m = 1e3;

std::uint32_t little_endian(std::string_view data, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(data[at + i])); };
  return byte(0) | byte(1) << 8U | byte(2) << 16U | byte(3) << 24U;
}

/// Triangles as they come, their corners brought together.
class MeshBuilder {
 public:
  MeshBuilder(std::string where, double unit_m) : where_(std::move(where)), unit_m_(unit_m) {}

  /// @param line  of a text; 0: there are no lines
  void add(const std::array<Eigen::Vector3d, 3>& corners, std::size_t line) {
    ++count_;
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i) triangle[i] = vertex(corners[i], line);
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) return;
    mesh_.triangles.push_back(triangle);
  }
  TriangleMesh finish() {
    if (mesh_.triangles.empty()) throw InvalidInput(where_, "holds no triangle");
    return std::move(mesh_);
  }

 private:
  using Place = std::array<std::uint64_t, 3>;
  struct Hash {
    std::size_t operator()(const Place& place) const noexcept {
      std::uint64_t out = 0;
      for (const std::uint64_t part : place) out = (std::rotl(out, 23) ^ part) * 0x9e3779b97f4a7c15U;
      return static_cast<std::size_t>(out ^ out >> 32U);
    }
  };

  std::uint32_t vertex(const Eigen::Vector3d& in_file, std::size_t line) {
    const Eigen::Vector3d at_m = (in_file * unit_m_).array() + 0.0;  // + 0: −0 and 0 are one place
    if (!at_m.allFinite() || at_m.cwiseAbs().maxCoeff() > farthest_m) {
      throw InvalidInput(
          InvalidInput::Parts{.where = line > 0 ? fmt::format("{}:{}", where_, line) : where_,
                              .field = fmt::format("triangle {}", count_),
                              .value = fmt::format("({:.6g}, {:.6g}, {:.6g})", in_file.x(), in_file.y(), in_file.z()),
                              .rule = fmt::format("must be finite and within {:.6g} m", farthest_m),
                              .hint = fmt::format("One unit of the file is taken as {:.6g} m", unit_m_)});
    }
    const Place place = {std::bit_cast<std::uint64_t>(at_m.x()), std::bit_cast<std::uint64_t>(at_m.y()),
                         std::bit_cast<std::uint64_t>(at_m.z())};
    const auto [found, first] = places_.try_emplace(place, static_cast<std::uint32_t>(mesh_.vertices_m.size()));
    if (first) mesh_.vertices_m.push_back(at_m);
    return found->second;
  }

  std::string where_;
  double unit_m_;
  std::size_t count_ = 0;
  TriangleMesh mesh_;
  std::unordered_map<Place, std::uint32_t, Hash> places_;
};

/// Whether the number of triangles that a binary file states is the number that it holds.
bool is_whole_binary(std::string_view data) {
  return data.size() >= stl_header && (data.size() - stl_header) % stl_record == 0 &&
         (data.size() - stl_header) / stl_record == little_endian(data, stl_header - 4);
}

TriangleMesh read_binary_stl(std::string_view data, const std::string& where, double unit_m) {
  if (data.size() < stl_header) throw InvalidInput(where, "is no STL: too short for a binary one, and no text");
  const std::size_t count = little_endian(data, stl_header - 4);
  const std::size_t held = (data.size() - stl_header) / stl_record;
  if (held < count) {
    throw InvalidInput(where, fmt::format("is no STL, or not whole: it states {} triangles and holds {}", count, held));
  }
  MeshBuilder builder(where, unit_m);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<Eigen::Vector3d, 3> corners;
    std::size_t at = stl_header + i * stl_record + 12;  // behind the normal
    for (Eigen::Vector3d& corner : corners) {
      for (double& coordinate : corner) {
        coordinate = static_cast<double>(std::bit_cast<float>(little_endian(data, at)));
        at += 4;
      }
    }
    builder.add(corners, 0);
  }
  return builder.finish();
}

/// Words of a text with their lines.
class Words {
 public:
  explicit Words(std::string_view text) : rest_(text) {}
  /// Empty at the end.
  std::string_view next() {
    std::size_t i = 0;
    for (; i < rest_.size() && is_blank(rest_[i]); ++i) line_ += rest_[i] == '\n' ? 1 : 0;
    rest_.remove_prefix(i);
    i = 0;
    while (i < rest_.size() && !is_blank(rest_[i])) ++i;
    const std::string_view word = rest_.substr(0, i);
    rest_.remove_prefix(i);
    return word;
  }
  void skip_line() { rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size())); }
  [[nodiscard]] std::size_t line() const { return line_; }

 private:
  static bool is_blank(char letter) { return letter == ' ' || (letter >= '\t' && letter <= '\r'); }
  std::string_view rest_;
  std::size_t line_ = 1;
};

/// The words of a solid's text, any number of solids: name lines are skipped, normals too.
TriangleMesh read_ascii_stl(std::string_view text, const std::string& where, double unit_m) {
  Words words(text);
  MeshBuilder builder(where, unit_m);
  const auto error = [&](std::string rule) {
    return InvalidInput(
        InvalidInput::Parts{.where = fmt::format("{}:{}", where, words.line()), .rule = std::move(rule)});
  };
  std::array<Eigen::Vector3d, 3> corners;
  std::size_t corner = 3;  // 3: outside a facet
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const std::string name = lowered(word.substr(0, 16));
    if (name == "solid" || name == "endsolid") {
      if (corner != 3) throw error("ends the solid within a facet");
      words.skip_line();
    } else if (name == "facet") {
      if (corner != 3) throw error("begins a facet within a facet");
      words.skip_line();
      corner = 0;
    } else if (name == "vertex") {
      if (corner >= 3) throw error("must have three corners in every facet");
      for (double& coordinate : corners[corner]) {
        const std::optional<double> number = parse_number(words.next());
        if (!number) throw error("must have three numbers behind every vertex");
        coordinate = *number;
      }
      if (++corner == 3) builder.add(corners, words.line());
    } else if (name == "endfacet") {
      if (corner != 3) throw error("must have three corners in every facet");
    } else if (name != "outer" && name != "loop" && name != "endloop") {
      throw error(fmt::format("\"{}\" is no word of an STL", printable(word.substr(0, 40))));
    }
  }
  if (corner != 3) throw error("ends within a facet");
  return builder.finish();
}

}  // namespace

TriangleMesh read_stl(const std::filesystem::path& path, double unit_m) {
  require_positive("unit_m", unit_m, "m");
  const std::string data = read_file(path, most_stl_bytes);
  const std::string where = path.string();
  // Binary files too may begin with "solid": what they state of their length decides.
  if (is_whole_binary(data)) return read_binary_stl(data, where, unit_m);
  const std::string_view begin = trimmed(std::string_view(data).substr(0, 1024));
  const bool text = begin.find('\0') == std::string_view::npos && lowered(begin.substr(0, 5)) == "solid";
  return text ? read_ascii_stl(data, where, unit_m) : read_binary_stl(data, where, unit_m);
}

}  // namespace robomill::io
