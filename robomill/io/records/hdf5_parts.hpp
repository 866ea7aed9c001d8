#pragma once
// What the readers of HDF5 files share; not for other folders.
#include <string>
#include <string_view>

#include "robomill/io/records/hdf5_id.hpp"

namespace robomill::io {

/// Before anything else of the library: its errors are reported as ours, and it loads no code.
void quiet_hdf5();
/// The file in memory, whose name must be nobody's.
[[nodiscard]] Hdf5Id open_hdf5_image(std::string_view content);
/// Before any data of it is read. @throws InvalidInput naming the object that leads out of the file
void require_self_contained(hid_t file, const std::string& name);
/// What is wrong with how a data set stores its values; empty: nothing.
[[nodiscard]] std::string storage_fault(hid_t set);

inline constexpr const char* damaged_hdf5 = "is a damaged HDF5 file, or one that was cut off";

}  // namespace robomill::io
