#pragma once
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/file.hpp"
#include "robomill/modal/files/hit_guess.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// A record that looks like one of hits.
struct FoundHit {
  std::vector<std::string> files =
      {};  ///< relative to hits.toml; several: force and responses apart, the force's first
  io::Format format = io::Format::unknown;
  double sample_rate_hz = 0.0;  ///< 0: not known
  std::string time = {};    ///< column of the time in s as hits.toml names it; empty: it is found by its name, or none
  bool si_assumed = false;  ///< units are SI because a file states none
  HitGuess guess = {};      ///< of the columns of all files one after the other, named as hits.toml names them

  /// The first column with that role; null: none.
  [[nodiscard]] const ColumnGuess* first(ColumnGuess::Role role) const;
  /// Its files: "force.csv + acc.csv".
  [[nodiscard]] std::string name() const;
};
struct FoundHits {
  std::vector<FoundHit> hits = {};
  std::vector<std::string> left_out = {};  ///< "NAME: why"
};

/// The records in a folder that look like those of hits, hit_2 before hit_10. Two files or more whose names differ by
/// words for force and response alone (impact_8.txt, accel_8.txt) are one record where no one of them is by itself.
/// Files with records that are not read, or show no hit, are left out. [acquisition] has one sample rate, one unit for
/// the forces of all records and one for their responses: records that differ in them from what most have are left out
/// too.
/// @param folder   that the names are relative to
/// @param made_up  the name of a record that counts as none
/// @throws InvalidInput if the folder cannot be read
[[nodiscard]] FoundHits find_hits(const std::filesystem::path& data, const std::filesystem::path& folder,
                                  std::string_view made_up);

/// The same of these files alone; two of them that are no hits by themselves may have any names.
[[nodiscard]] FoundHits find_hits(const std::vector<std::filesystem::path>& files, const std::filesystem::path& folder);

/// The record of a file that shows no hit by itself: it and those beside it whose names differ by words for force and
/// response alone. None where they show no hit together either.
/// @throws InvalidInput if the folder cannot be read
[[nodiscard]] std::optional<FoundHit> find_set_of(const std::filesystem::path& file);

/// In which directions there are hits and sensors.
struct MeasuredAxes {
  std::set<char> excitations = {}, responses = {};
};
[[nodiscard]] MeasuredAxes measured_axes(const FoundHits& found);

}  // namespace robomill::modal
