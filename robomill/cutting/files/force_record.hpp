#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/cutting/measured_force.hpp"

// Method: robomill/cutting/README.md, "Files"

namespace robomill::cutting {

/// How the record of a dynamometer is read.
struct ForceRecordOptions {
  /// Columns of x, y and z by name or number from 1, "-" before one whose sign is turned, "none" for one that was not
  /// measured; empty: found by their names.
  std::vector<std::string> channels = {};
  double full_scale_n = 0.0;    ///< of a WAV [N], and of nothing else; 0: not given
  double sample_rate_hz = 0.0;  ///< 0: that of the record
};

/// Forces of a record in N.
struct ForceRecordFile {
  std::filesystem::path path = {};
  ForceRecord record;
  std::array<std::string, 3> channels = {};  ///< the columns that x, y and z are: "-Fy"; "none"
  std::vector<Assumption> assumed = {};
  std::vector<std::string> notes = {};
};

/// Any file that io::read_record reads. Columns are x, y and z where their names say so ("Fx", "force_y", "Z [N]"), and
/// units are those that the file states, N where it states none, which is listed as assumed.
/// @throws InvalidInput with the file: no such column, one named twice, one in another unit than of force, no columns
///     that are known as forces, no sample rate, a file too large for the cost limit; naming "channels", "full_scale_n"
///     or "sample_rate_hz" where that is what is to be given
[[nodiscard]] ROBOMILL_API ForceRecordFile read_force_record(const std::filesystem::path& path,
                                                             const ForceRecordOptions& options = {});

}  // namespace robomill::cutting
