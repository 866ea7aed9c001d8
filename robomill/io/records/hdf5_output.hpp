#pragma once
#include <hdf5.h>

#include "robomill/io/file.hpp"

namespace robomill::io {

/// A new HDF5 file whose bytes go into a PendingFile, which outlives it. A write that fails is not reported to the
/// library, which would keep what it could not write until the program ends and crash there: ask pending.failed() after
/// each call. Negative where the library cannot create it.
/// Source: H5FDpublic.h, virtual file drivers of HDF5 1.10
[[nodiscard]] hid_t create_hdf5(PendingFile& pending);

/// Whether the library opens a file again and finds it as long as its header says.
[[nodiscard]] bool is_whole_hdf5(const std::filesystem::path& path);

}  // namespace robomill::io
