#pragma once
// What the tests of program readers share.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/program/files/program_reader.hpp"

namespace robomill::test_support {

/// A program in memory, read without a file.
template <class Reader>
program::Program read_text(std::string_view text, const program::ProgramReading& reading = {}) {
  program::ProgramRemarks remarks(std::numeric_limits<std::size_t>::max());
  Reader reader("part", reading, remarks);
  program::Program out;
  program::Block block;
  const auto take_blocks = [&] {
    while (reader.pop(block)) out.blocks.push_back(block);
  };
  while (!text.empty() && !reader.ended()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    const std::size_t ahead = text.find_first_not_of(" \t");
    reader.take(line, ahead == std::string_view::npos ? '\n' : text[ahead]);
    take_blocks();
  }
  reader.finish();
  take_blocks();
  if (reader.start()) out.start = *reader.start();
  out.skipped = std::move(remarks.skipped());
  out.notes = remarks.notes();
  out.assumed = remarks.assumed();
  return out;
}

/// The ways and the time of a program's blocks.
struct Sums {
  double feed_mm = 0.0, rapid_mm = 0.0, time_s = 0.0;
  [[nodiscard]] double way_mm() const { return feed_mm + rapid_mm; }
};
inline Sums sums_of(const program::Program& program) {
  Sums out;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const program::Block& block = program.blocks[i];
    const double way_mm = (block.end.tip_m - program.begin_of(i).tip_m).norm() / units::mm;
    (block.kind == program::Block::Kind::feed ? out.feed_mm : out.rapid_mm) += way_mm;
    out.time_s += block.duration_s;
  }
  return out;
}

inline void expect_at(const program::Pose& pose, const Eigen::Vector3d& tip_mm, double tolerance_m = 1e-9) {
  EXPECT_LT((pose.tip_m - units::mm * tip_mm).norm(), tolerance_m) << pose.tip_m.transpose() / units::mm;
}

}  // namespace robomill::test_support
