#pragma once
#include <filesystem>
#include <vector>

#include "robomill/modal/files/hits_toml.hpp"

// Method: robomill/modal/README.md, "Without a hits.toml"

namespace robomill::modal {

/// Hits of records without a hits.toml: by what the names, units and rate of their columns say (find_hits). What is
/// taken that nobody said is listed: directions, and units of records that name none.
/// @throws InvalidInput naming what the records leave open, with the lines of hits.toml in which to say it; or as
///     read_hits
[[nodiscard]] HitsFile read_bare_hits(const std::vector<std::filesystem::path>& records);

}  // namespace robomill::modal
