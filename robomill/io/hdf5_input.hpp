#pragma once
#include <filesystem>

namespace robomill::io {

/// Rejects what makes the HDF5 library open another file or load code: external and user-defined links, external
/// storage, virtual data sets, filters that are plug-ins. Looks at links and creation properties alone, before any data
/// is read. A soft link stays in its file.
/// Call it where a damaged file may bring the library down: in a child process.
/// @throws InvalidInput naming the object, or if the file is damaged
void require_self_contained_hdf5(const std::filesystem::path& path);

}  // namespace robomill::io
