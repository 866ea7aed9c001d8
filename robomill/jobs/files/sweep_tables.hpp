#pragma once
#include <filesystem>

#include "robomill/jobs/files/sweep_folder.hpp"
#include "robomill/jobs/sweep/study.hpp"

namespace robomill::jobs {

/// All points of a study whose chunks are done: a row a point, a column a key that varies, a value that is collected,
/// and its state. HDF5 (.h5, .hdf5) or CSV; the file appears whole or not at all.
/// @throws InvalidInput if the ending is another, a chunk is missing or the place cannot be written
void write_sweep_table(const std::filesystem::path& path, const SweepPlan& plan, const StudyPoints& points,
                       const SweepFolder& folder);

}  // namespace robomill::jobs
