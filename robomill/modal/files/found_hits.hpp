#pragma once
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/modal/files/hit_guess.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// A record that looks like one of a hit.
struct FoundHit {
  std::string file = {};  ///< relative to hits.toml
  io::Format format = io::Format::unknown;
  double sample_rate_hz = 0.0;  ///< 0: not known
  bool rounded_time = false;    ///< its column of time has too few digits to be read: the rate is that of all of it
  HitGuess guess = {};

  /// The first column with that role; null: none.
  [[nodiscard]] const ColumnGuess* first(ColumnGuess::Role role) const;
};
struct FoundHits {
  std::vector<FoundHit> hits = {};
  std::vector<std::string> left_out = {};  ///< "NAME: why"
};

/// The records in a folder that look like those of hits, hit_2 before hit_10. Files with records that are not read, or
/// show no hit, are left out. [acquisition] has one sample rate, one unit for the forces of all records and one for
/// their responses: records that differ in them from what most have are left out too.
/// @param folder   that the names are relative to
/// @param made_up  the name of a record that counts as none
/// @throws InvalidInput if the folder cannot be read
[[nodiscard]] FoundHits find_hits(const std::filesystem::path& data, const std::filesystem::path& folder,
                                  std::string_view made_up);

/// In which directions there are hits and sensors.
struct MeasuredAxes {
  std::set<char> excitations = {}, responses = {};
};
[[nodiscard]] MeasuredAxes measured_axes(const FoundHits& found);

}  // namespace robomill::modal
