#pragma once
// Of the readers of HDF5 and of MAT 7.3.
#include <string>
#include <string_view>

#include "robomill/io/records/tree/file_tree.hpp"

namespace robomill::io {

/// All groups, numbers, texts and attributes of an HDF5 file; of one that MATLAB wrote its structs and cells as such.
/// What would lead to other files is rejected before any data is read, as read_hdf5_matrices does. Call it in a child
/// process.
/// @param file  that errors name
/// @throws InvalidInput
[[nodiscard]] FileTree read_hdf5_tree(std::string_view content, const std::string& file, bool of_matlab);

}  // namespace robomill::io
