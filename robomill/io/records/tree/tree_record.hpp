#pragma once
#include <filesystem>
#include <string>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// Reads an HDF5 file: its data sets of numbers by their paths, each a column or n × k, where the longer side is time,
/// the named fields of tables, and attributes for rate and unit. Read in a child process: read_in_child. What leads to
/// other files is rejected: require_self_contained.
/// @param time  the user's column of time
/// @throws InvalidInput if the file is none, damaged, or holds no column
[[nodiscard]] Record read_hdf5_record(const std::filesystem::path& path, const std::string& time);

/// Reads a MAT file of version 4, 5 or 7.3: its matrices of numbers, also within structs and cells ("data.ch1",
/// "s(2).x", "c{1}"): a struct of time, values and rate, Simulink's "structure with time", what Testlab exports.
/// @param time  the user's column of time
/// @throws InvalidInput as read_mat, or if the file holds no column
[[nodiscard]] Record read_mat_record(const std::filesystem::path& path, const std::string& time);

}  // namespace robomill::io
