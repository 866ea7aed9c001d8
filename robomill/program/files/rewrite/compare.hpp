#pragma once
#include <span>
#include <string>

#include "robomill/program/program.hpp"

// What the verification of a rewritten program compares.

namespace robomill::program {

/// Whether two speeds, feeds or times are the same within a share of the larger.
[[nodiscard]] bool near_rate(double a, double b, double tolerance);
/// Whether two tool axes are the same for a program: within 2e-8 rad, as its digits leave them.
[[nodiscard]] bool same_axis(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// In what a pose read again is not the wanted one; empty where it is: tip within 0.2 um, axis within 1e-7 rad.
[[nodiscard]] std::string pose_difference(const Pose& wanted, const Pose& got);

/// In what a block read again is not the wanted one; empty where it is.
[[nodiscard]] std::string block_difference(const Block& wanted, const Pose& wanted_begin, const Block& got,
                                           const Pose& got_begin);

/// In what the blocks of one line, read again, are not the wanted ones; empty where they are, or where moves have
/// come back in other parts and still are the wanted ones:
/// - At feed, one wanted block that turns the axis is several. The last ends as the wanted one does. Each of the others
/// ends on the
///   wanted line, within 0.2 um, with its axis on the wanted great circle, within axis_tolerance_rad, at the same share
///   of the time; the time's share counts the tip's way, which digits change by up to 0.2 um. They have its feed.
/// - The wanted rapids of the line are as many as the machine's turn makes. The last ends as the wanted one does, and
///   the tips run the same way, within 0.2 um. Between, the axis goes as the machine turns its rotary axes.
[[nodiscard]] std::string blocks_difference(std::span<const Block> wanted, const Pose& wanted_begin,
                                            std::span<const Block> got, const Pose& got_begin,
                                            double axis_tolerance_rad);

}  // namespace robomill::program
