#pragma once
// For libraries that trust what a file says of its types and lengths; not for other folders.
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

namespace robomill::io {

/// matio and HDF5, which it is made of in part, keep state of their own.
[[nodiscard]] std::mutex& mat_library();

/// Version 7.3 of MAT is an HDF5 file behind a header of version 5; without that header it is one too.
[[nodiscard]] bool is_hdf5(std::string_view content);

/// What a file is read into in a child process, whose memory and time are bounded by the file's size, and which can
/// open no other file: a damaged one brings HDF5 down, and makes matio ask for gigabytes.
struct ChildReading {
  bool by_name = false;         ///< the library opens a file by its name: it gets one in memory
  const char* fault = nullptr;  ///< what a file is whose reading dies
};
/// @param read  from all bytes of the file and the name of it in memory to an answer; its InvalidInput is thrown here,
///     with the file
/// @throws InvalidInput
[[nodiscard]] std::string read_in_child(
    const std::filesystem::path& path, const std::string& content, const ChildReading& how,
    const std::function<std::string(const std::string& content, const std::string& place)>& read);

}  // namespace robomill::io
