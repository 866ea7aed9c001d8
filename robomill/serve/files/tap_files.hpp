#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/modal/hits.hpp"
#include "robomill/serve/tap/hits.hpp"

// Method: robomill/serve/README.md, "Tap test"

namespace robomill::serve {

/// What a tap test is written as.
struct TapDocument {
  std::string acquisition = {};  ///< [acquisition] as TOML, of records in SI where they come out of a stream
  modal::ResponseKind response = modal::ResponseKind::acceleration;
  std::vector<std::pair<std::size_t, TapHit>> hits = {};  ///< those that were accepted, with their numbers
};

/// What became of a request to write.
struct TapWritten {
  std::vector<std::filesystem::path> files = {};
  std::optional<std::filesystem::path> there = {};  ///< is there already: nothing was written
};

/// hits.toml, and beside it one CSV for each hit that came out of a stream: force in N, responses in SI, all digits.
/// Each file appears whole or not at all, hits.toml last. @throws InvalidInput if the place cannot be written
/// @param replace  files that are there already
[[nodiscard]] TapWritten write_tap_hits(const std::filesystem::path& path, const TapDocument& document, bool replace);

/// FRFs by the file's ending. @throws InvalidInput as modal::write_frfs
[[nodiscard]] TapWritten write_tap_frfs(const std::filesystem::path& path, const modal::FrfResult& result,
                                        bool replace);

}  // namespace robomill::serve
