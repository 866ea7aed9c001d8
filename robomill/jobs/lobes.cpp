#include "robomill/jobs/lobes.hpp"

#include <algorithm>

namespace robomill::jobs {

LobesJobResult run_lobes(const LobesJob& job, Progress& progress) {
  LobesJobResult result;
  LobesFile& cut = result.cut;
  cut = read_milling(job.lobes, "robomill simulate takes drilling");
  cut.options.points = job.points;
  if (job.compare) {
    constexpr int most_speeds = 60;
    const int speeds = std::min(cut.options.grid[0], most_speeds);
    result.comparison = stability::compare_methods(cut.problem, cut.options, speeds, progress);
    return result;
  }
  result.lobes = stability::compute_lobes(cut.problem, cut.options, progress);
  cut.uncertainty.seed = job.seed;
  if (cut.uncertainty.samples > 0) {
    result.uncertain = stability::uncertain_limits(cut.problem, cut.options, cut.uncertainty, progress);
  }
  if (cut.surface_grid[0] > 0) {
    result.surface = stability::surface_map(cut.problem, cut.options, cut.surface_grid, progress);
  }
  return result;
}

}  // namespace robomill::jobs
