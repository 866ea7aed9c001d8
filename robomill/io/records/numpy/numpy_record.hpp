#pragma once
#include <filesystem>
#include <string>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// Reads an NPY file (one array: a column, n × k or k × n, where the longer side is time, or the named fields of a
/// structured one) or an NPZ file (arrays by their names, among them rate, units and names): which of them its first
/// bytes say. Values are read block by block into the columns. What each column is follows by record_of_tree.
/// Source: [NumPy2024] numpy.lib.format
/// @param time  the user's column of time
/// @throws InvalidInput if it is neither, damaged, ends within its values, or no array can be a column
[[nodiscard]] Record read_numpy(const std::filesystem::path& path, const std::string& time);

}  // namespace robomill::io
