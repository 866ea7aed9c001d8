#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/modal/files/hits_toml.hpp"
#include "robomill/modal/hits.hpp"
#include "robomill/modal/impact/hit_trigger.hpp"

// Method: robomill/serve/README.md, "Tap test"

namespace robomill::serve {

/// How the records of a tap test are read: the tables of hits.toml, whose rows are patterns for the files that appear,
/// or for the channels of a stream.
class TapSettings {
 public:
  /// @throws InvalidInput if the text is no hits.toml: no row, a key that is missing or wrong, or a file outside the
  /// folder that is served
  TapSettings(std::filesystem::path hits, const std::string& text);

  /// The hits of one record, named without its folder, by the row that names it; else by the first whose direction
  /// stands in its name as a word ("x" in "tap_x_3.csv"), or by the first of all.
  /// @param files  as many as the row has, in its order
  /// @throws InvalidInput as modal::read_hits
  [[nodiscard]] std::vector<modal::Hit> read(const std::vector<std::filesystem::path>& files) const;
  /// How many files a record has by its row: force and responses may be apart.
  [[nodiscard]] std::size_t files_of(const std::filesystem::path& record) const {
    return named_[row_of(record)].size();
  }
  /// What files of one record have in common: the row that names them, else their folder and names.
  [[nodiscard]] std::string key_of(const std::filesystem::path& file) const;
  /// Files of one record in the order of their row: as it names them, else the one named as a force first.
  [[nodiscard]] std::vector<std::filesystem::path> in_order(std::vector<std::filesystem::path> files) const;
  /// The row that it is read by, but its file, as TOML.
  [[nodiscard]] const std::string& row(const std::filesystem::path& record) const { return rows_[row_of(record)]; }
  /// Files that the rows name, resolved.
  [[nodiscard]] std::vector<std::filesystem::path> named() const;
  /// How many the rows have.
  [[nodiscard]] std::size_t directions() const { return directions_; }
  [[nodiscard]] const modal::HitOptions& options() const { return columns_.options; }
  /// [acquisition] as TOML. @param si  of records in N and the SI unit of the response, without sensitivities
  [[nodiscard]] std::string acquisition(bool si) const;

  /// Channels of a stream, each once: forces and responses in the order of the rows.
  [[nodiscard]] const std::vector<std::string>& channels() const { return channels_; }
  [[nodiscard]] double sample_rate_hz() const { return columns_.sample_rate_hz; }
  /// Of the first row: "x", "-y".
  [[nodiscard]] std::string first_direction() const;
  /// @param level_n, record_s  0: by itself; 1 / frequency_resolution_hz, or 1 s
  /// @throws InvalidInput if the file names no sample rate or several forces, or as HitTriggerOptions::validate
  [[nodiscard]] modal::HitTriggerOptions trigger(double level_n, double record_s) const;
  /// A record of these channels as a hit in that direction: by the row of that direction, else of its axis, else the
  /// first. @throws InvalidInput if the direction is none
  [[nodiscard]] modal::Hit hit_of(const modal::HitRecord& record, const std::string& direction,
                                  const std::string& name) const;

 private:
  struct Setting {
    std::string key, value;
  };
  /// The row that names a file; none: no row does.
  [[nodiscard]] std::optional<std::size_t> row_that_names(const std::filesystem::path& record) const;
  [[nodiscard]] std::size_t row_of(const std::filesystem::path& record) const;
  void read_rows(const std::string& text);
  void name_channels();

  std::filesystem::path path_;
  std::vector<Setting> acquisition_;  ///< as TOML
  std::vector<std::string> rows_,
      excitation_directions_;  ///< the keys of each row but its file, as TOML; its direction
  std::vector<std::vector<std::filesystem::path>> named_;  ///< files of each row
  std::size_t directions_ = 0;
  modal::HitRows columns_;
  std::vector<std::string> channels_;
};

/// A direction as it stands in hits.toml: "x", "-y", "3z".
struct TapDirection {
  modal::Dof dof;
  bool against_axis = false;
};
/// @throws InvalidInput if it is none, or a moment
[[nodiscard]] TapDirection parse_direction(const std::string& text);
[[nodiscard]] std::string direction_text(const modal::Dof& dof, bool against_axis);

}  // namespace robomill::serve
