#pragma once
#include <vector>

#include "robomill/process/blocks.hpp"

namespace robomill::process {

/// The limit over x, y and z of the tip (within 200 mm of the block's, in W) and over gamma (a quarter turn to
/// either side), one at a time, with the block's engagement.
[[nodiscard]] std::vector<LimitScan> limit_scans(const ForcesResult& forces, std::size_t block,
                                                 const DynamicsAt& dynamics, const BlocksOptions& options);

}  // namespace robomill::process
