#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace robomill::jobs {

/// What a key is set to, or a value that is collected, at some points.
struct StudyColumn {
  std::string name = {}, unit = {};
  std::vector<double> numbers = {};     ///< one a point; NaN: it has none
  std::vector<std::string> texts = {};  ///< in place of numbers, where one of them is none
  std::uint64_t infinite = 0;           ///< of the numbers
};

/// Points of a study to look at: all of them, or an even choice.
struct ShownPoints {
  std::uint64_t points = 0, rejected = 0;       ///< of the study
  std::vector<StudyColumn> keys = {};           ///< that vary
  std::vector<StudyColumn> values = {};         ///< that are collected
  std::uint64_t boundary_points = 0;            ///< where the study traces a boundary
  std::vector<StudyColumn> boundary_keys = {};  ///< of points of the boundary
};

/// A text to look at: of a long one the beginning and eight digits that tell it from others.
[[nodiscard]] std::string shown_text(const std::string& text);

/// At most `most` of so many indices, one in each of `most` equal runs, increasing. Their places in the runs follow the
/// golden ratio: no period of a grid is met.
[[nodiscard]] inline std::vector<std::uint64_t> even_choice(std::uint64_t count, std::uint64_t most = 5000) {
  std::vector<std::uint64_t> out(static_cast<std::size_t>(std::min(count, most)));
  constexpr double golden = 0.6180339887498949;
  for (std::uint64_t i = 0; i < out.size(); ++i) {
    const std::uint64_t low = i * count / out.size(), high = (i + 1) * count / out.size();
    const double place = static_cast<double>(i) * golden;
    out[i] = low + static_cast<std::uint64_t>((place - std::floor(place)) * static_cast<double>(high - low));
  }
  return out;
}

}  // namespace robomill::jobs
