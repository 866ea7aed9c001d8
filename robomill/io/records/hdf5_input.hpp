#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/io/records/mat.hpp"

namespace robomill::io {

/// The matrices of numbers at the top of an HDF5 file, as version 7.3 of MAT files keeps them; anything else is left
/// out. Rejected is what makes the HDF5 library open another file or load code, wherever in the file, before any data
/// is read: external and user-defined links, external storage, virtual data sets, filters that are plug-ins. A soft
/// link stays in its file. Call it where a damaged file may bring the library down: in a child process.
/// @param content  all bytes of the file: what a disk cannot read, the library would take for zeros
/// @param file     that errors name
/// @throws InvalidInput naming the object, or if the file is damaged
[[nodiscard]] std::vector<MatVariable> read_hdf5_matrices(std::string_view content, const std::string& file);

}  // namespace robomill::io
