#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/jobs/sweep/evaluate.hpp"

namespace robomill::jobs {

/// Points of a study that are done together, one after the other from `first` on.
struct Chunk {
  std::string fingerprint = {};  ///< of the study
  std::string processor = {};    ///< that did it: the last bits may differ between kinds
  std::uint64_t first = 0;
  std::vector<PointOutcome> points = {};
};

/// As bytes: the same on any machine of little-endian numbers; a digest of all that stands before it comes last.
[[nodiscard]] std::string chunk_bytes(const Chunk& chunk);
/// None where the bytes are cut off, damaged, of no point or no chunk. Any bytes may come.
[[nodiscard]] std::optional<Chunk> read_chunk(std::string_view bytes);

}  // namespace robomill::jobs
