#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/io/records/records.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// The record of a measurement: one file, or several with force and responses apart.
struct RecordOfHits {
  std::vector<io::Record> parts;  ///< one a file, of one length
  double sample_rate_hz = 0.0;    ///< 0: nothing says it
  double begin_s = 0.0;           ///< time of the first sample
  std::vector<std::string> notes = {};

  struct Column {
    const io::Record* part = nullptr;
    std::size_t place = 0;
    [[nodiscard]] const Eigen::VectorXd& samples() const { return part->columns[place]; }
  };
  /// A column by its name, by "FILE:COLUMN", or by its number from 1: of several files that of the force is counted in
  /// the first, that of a response in the other one of two.
  /// @throws InvalidInput naming the columns that are there, or what to write where several files have it
  [[nodiscard]] Column column(const std::string& text, bool is_force) const;
};

struct HitRecordOptions {
  std::string time = {};  ///< column of the time, by name or number from 1; empty: found
  double scale = 1.0;     ///< of WAV
  double given_rate_hz = 0.0;
  std::string rate_key = "acquisition.sample_rate_hz";  ///< what gives it
};

/// Reads the files of one measurement, and puts them side by side.
/// @throws InvalidInput as io::read_record, io::rate_of and io::join_records
[[nodiscard]] RecordOfHits read_hit_record(const std::vector<std::filesystem::path>& files,
                                           const HitRecordOptions& options = {});

/// The file in which hits.toml looks up a number, or a name that several files have; nothing: it must be given.
[[nodiscard]] std::optional<std::size_t> own_part(const std::vector<io::Record>& parts, bool is_force);

/// Whether a file has names and units that its reader did not convert.
[[nodiscard]] bool has_own_units(const io::Record& record);

}  // namespace robomill::modal
