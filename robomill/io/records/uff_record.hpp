#pragma once
#include <filesystem>

#include "robomill/io/records/records.hpp"

namespace robomill::io {

/// Reads the time responses of a universal file (data sets 58 and 58b of function type 1, or 0 over time), in SI, a
/// column each. The rate is that of the abscissa, even or not written so, in its unit of time. Names are the labels of
/// the ordinate, else the first line of identification; of several of one name the degree of freedom stands behind it.
/// Units are those that the ordinate has in SI, by its unit's text, its data type or data set 164. What does not go
/// together is left out, with a note: channels_together.
/// @throws InvalidInput with file and line if the file is damaged, or no function is a time response
[[nodiscard]] Record read_uff_record(const std::filesystem::path& path);

}  // namespace robomill::io
