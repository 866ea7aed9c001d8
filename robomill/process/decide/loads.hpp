#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "robomill/process/decide/units.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::process {

/// A load of a block over its feed per tooth, which it rises with and is convex in: the chord between two samples lies
/// above it.
using LoadSamples = std::array<double, 3>;

/// What a block bears over its feed per tooth.
struct BlockLoad {
  double chip_share = 0.0;                      ///< greatest chip thickness over the feed per tooth
  std::array<double, 3> feed_per_tooth_m = {};  ///< increasing
  LoadSamples force_n = {}, torque_n_m = {}, deflection_m = {};
};

/// Radius of the outermost point that cuts.
[[nodiscard]] double engaged_radius_m(const cutting::Engagement& engagement);

/// Greatest feed per tooth at which a load stays at most `allowed`, within the samples; 0: at none.
[[nodiscard]] double most_feed_per_tooth_m(const BlockLoad& load, const LoadSamples& samples, double allowed);

/// A load at a feed per tooth: the chords, and the first and last of them beyond the samples.
[[nodiscard]] double load_at(const BlockLoad& load, const LoadSamples& samples, double feed_per_tooth_m);

/// Chip thickness of each block as programmed, least and most of all that cut.
[[nodiscard]] std::array<double, 2> programmed_chips_m(const ForcesResult& forces, const std::vector<LineUnit>& lines);

/// Of every block of the lines that cuts; the others are empty. At the programmed feed they are those of the block.
/// @param chip_m  greatest chip thickness, least and most: the samples' range
/// @throws InvalidInput as cutting::ForceKernel
[[nodiscard]] std::vector<BlockLoad> block_loads(const ForcesResult& forces, const std::vector<LineUnit>& lines,
                                                 const std::array<double, 2>& chip_m);

}  // namespace robomill::process
