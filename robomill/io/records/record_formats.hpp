#pragma once
#include <cstdint>
#include <filesystem>

namespace robomill::io {

/// Which reader takes a record. Endings and what they are stand in record_formats.cpp, one list.
enum class RecordFormat : std::uint8_t { none, text, mat, uff, wav, lvm, tdms, numpy, hdf5 };

/// By its ending; case does not matter.
[[nodiscard]] RecordFormat record_format_of(const std::filesystem::path& path);

}  // namespace robomill::io
