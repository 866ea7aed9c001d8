#pragma once
#include <filesystem>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// Reads a TDMS file: one column a channel, in the order of the file, named after the channel, with its group where
/// several groups have the name. The rate is that of wf_increment, the unit that of unit_string; times become s from
/// the first. Channels that do not go together, texts and complex numbers are left out, with a note. A file that ends
/// within its last segment is read as far as it goes, with a note. Memory: that of the file and of the columns.
/// Source: [NI2014] "TDMS File Format Internal Structure"
/// @throws InvalidInput if it is none or damaged, has data of a type that is not read, or no channel can be a column
[[nodiscard]] Record read_tdms(const std::filesystem::path& path);

}  // namespace robomill::io
