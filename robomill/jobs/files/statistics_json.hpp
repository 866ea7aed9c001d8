#pragma once
#include <filesystem>

#include "robomill/io/schema.hpp"
#include "robomill/jobs/sweep/statistics.hpp"

namespace robomill::jobs {

/// statistics.json: what the points of a study say together.
[[nodiscard]] const io::Schema<Statistics>& statistics_table();
/// @throws InvalidInput if the place cannot be written
void write_statistics(const std::filesystem::path& path, const Statistics& statistics);

}  // namespace robomill::jobs
