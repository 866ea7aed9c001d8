#pragma once
#include <array>
#include <cstddef>

namespace robomill::path {

/// Channels whose motion is limited: six joints, the tip and the axis along their paths.
inline constexpr std::size_t channel_count = 8;
using Channels = std::array<double, channel_count>;

/// One place on the path as the limits see it. With b = (du/dt)², b' and b'' by u, each channel has
///     velocity c1 √b,  acceleration c2 b + c1 b'/2,  jerk √b (c3 b + 3/2 c2 b' + c1 b''/2)
/// where c1, c2, c3 are the channel's derivatives by u, and for tip and axis the projections on the direction of
/// motion.
struct PathPoint {
  alignas(64) Channels c1 = {}, c2 = {}, c3 = {};
  double speed = 1.0;  ///< SpeedCorrections::speed: velocity limits times this, acceleration its square, jerk its cube
  double max_b = 0.0;  ///< of the velocity limits and the feed [m²/s²]
};

/// Limits of the channels.
struct ChannelLimits {
  alignas(64) Channels velocity = {}, acceleration = {}, jerk = {};
};

/// A stretch of the path on which b is one piece of a quadratic spline, in Bézier form (begin, middle, end); from rest
/// b = end ξ^(4/3) and to rest b = begin (1 − ξ)^(4/3), motions of constant jerk.
struct Segment {
  enum class Kind { cruise, from_rest, to_rest, dwell };
  Kind kind = Kind::cruise;
  double begin_m = 0.0, length_m = 0.0;               ///< of u
  double begin_b = 0.0, middle_b = 0.0, end_b = 0.0;  ///< [m²/s²]
  double dwell_s = 0.0;
};

/// Where in a segment the limits are looked at: its middle, and beside its ends, where third derivatives may step.
inline constexpr std::size_t point_count = 3;
inline constexpr double first_share = 0.005, last_share = 0.995;

/// Time that a segment takes [s].
[[nodiscard]] double duration_s(const Segment& segment) noexcept;
/// u less the segment's begin after t [s], 0 <= t <= duration.
/// @param total_s  the segment's duration
[[nodiscard]] double way_m(const Segment& segment, double t_s, double total_s) noexcept;

}  // namespace robomill::path
