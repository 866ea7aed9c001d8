#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/modal/files/found_hits.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// What the name of a file of a measurement has in common with that of its other file: without ending and words for
/// force and response, "pt8" of "impact_pt8.txt" and "Accel-pt8.txt".
[[nodiscard]] std::string set_key(const std::filesystem::path& path);
/// Whether the name has a word for a force ("hammer_3.csv"), and none for a response.
[[nodiscard]] bool is_named_force(const std::filesystem::path& path);

/// Files whose names differ by such words alone, and that lie in one folder; the rest by themselves. In the order of
/// the first of each.
[[nodiscard]] std::vector<std::vector<std::filesystem::path>> sets_by_name(
    const std::vector<std::filesystem::path>& paths);

/// Force and responses in several files, whose order becomes that of hits.toml: the force's first. None: they show no
/// hit.
/// @throws InvalidInput if one cannot be read, or they do not go together
[[nodiscard]] std::optional<FoundHit> found_in_set(std::vector<std::filesystem::path>& files);

}  // namespace robomill::modal
