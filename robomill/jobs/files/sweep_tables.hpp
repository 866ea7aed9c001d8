#pragma once
#include <filesystem>
#include <span>
#include <vector>

#include "robomill/jobs/files/sweep_folder.hpp"
#include "robomill/jobs/sweep/boundary.hpp"
#include "robomill/jobs/sweep/shown_points.hpp"
#include "robomill/jobs/sweep/study.hpp"

namespace robomill::jobs {

/// The chunks of a study that are all done, in parts that follow one another.
struct DoneStudy {
  std::span<const SweepPlan> plans = {};
  const StudyPoints& points;
  const SweepFolder& folder;
};

/// All points: a row a point, a column a key that varies, a value that is collected, and its state. HDF5 (.h5, .hdf5)
/// or CSV; the file appears whole or not at all.
/// @throws InvalidInput if the ending is another, a chunk is missing or the place cannot be written
void write_sweep_table(const std::filesystem::path& path, const DoneStudy& study);

/// The points of a boundary: a row a point, a column a key. As write_sweep_table.
void write_boundary_table(const std::filesystem::path& path, const SweepPlan& plan, const Boundary& boundary);

/// Of each value that is collected one number a point; NaN where the point has none.
/// @throws InvalidInput if a chunk is missing
[[nodiscard]] std::vector<std::vector<double>> columns_of(const DoneStudy& study);

/// Points for a page; of `boundary` too, where there is one.
/// @throws InvalidInput if a chunk is missing
[[nodiscard]] ShownPoints shown_points_of(const DoneStudy& study, const Boundary* boundary);

}  // namespace robomill::jobs
