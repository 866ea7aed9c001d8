#pragma once
#include <filesystem>
#include <string_view>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// What LVM names its columns of x, which are no columns of a record.
inline constexpr std::string_view lvm_time = "X_Value";

/// Whether a regular file is a LabVIEW measurement file, whatever its ending.
[[nodiscard]] bool is_lvm(const std::filesystem::path& path);

/// Reads a LabVIEW measurement file (.lvm): one column a channel, in the order of the file. Columns of x count as the
/// time and are no columns of the record. Segments are read one behind the other. The rate is that of the columns of x,
/// else that of Delta_X; units are those of Y_Unit_Label. Channels that do not go together are left out, with a note.
/// Memory: that of the columns.
/// Source: [NI2010] "Specification for the LabVIEW Measurement File (.lvm)"
/// @throws InvalidInput with file and line if it is none or damaged, its segments have different channels, or no
///     channel has samples at a constant rate
[[nodiscard]] Record read_lvm(const std::filesystem::path& path);

}  // namespace robomill::io
