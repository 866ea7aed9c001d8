#include "robomill/jobs/lobes.hpp"

#include <algorithm>
#include <filesystem>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/jobs/files/in_words.hpp"
#include "robomill/jobs/files/lobes_schema.hpp"
#include "robomill/jobs/planned_cut.hpp"
#include "robomill/stability/files/lobes_csv.hpp"
#include "robomill/stability/files/lobes_schema.hpp"

namespace robomill::jobs {
namespace {

/// The chart and what the file asks for beside it.
void compute_asked(const LobesJob& job, LobesJobResult& result, Progress& progress) {
  LobesFile& cut = result.cut;
  if (cut.sweep != stability::SweptParameter::axial_depth) {
    if (job.compare) throw cut.document->reject("lobes.sweep", "does not go with a comparison of methods");
    result.sweep = stability::compute_sweep(cut.problem, sweep_options(cut), progress);
    return;
  }
  if (job.compare) {
    constexpr int most_speeds = 60;
    const int speeds = std::min(cut.options.grid[0], most_speeds);
    result.comparison = stability::compare_methods(cut.problem, cut.options, speeds, progress);
    return;
  }
  result.lobes = stability::compute_lobes(cut.problem, cut.options, progress);
  if (cut.uncertainty.samples > 0) {
    if (!cut.band_note.empty()) cut.notes.push_back(cut.band_note);
    result.uncertain = stability::uncertain_limits(cut.problem, cut.options, cut.uncertainty, progress);
  }
  if (cut.surface_grid[0] > 0) {
    result.surface = stability::surface_map(cut.problem, cut.options, cut.surface_grid, progress);
  }
}

}  // namespace

LobesJobResult run_lobes(const LobesJob& job, Progress& progress) {
  LobesJobResult result;
  LobesFile& cut = result.cut;
  cut = read_lobes(job.lobes);
  require_modes_in_three_directions(cut);
  load_dynamics(cut, progress);
  cut.validate();
  for (const std::filesystem::path& plan : jobs_of_cut(job.lobes.path)) {
    if (!cut.job.empty()) break;
    if (const std::string text = other_structure_text(plan, cut); !text.empty()) cut.notes.push_back(text);
  }
  cut.options.points = job.points;
  cut.uncertainty.seed = job.seed;
  with_words_of(cut, [&] { compute_asked(job, result, progress); });
  return result;
}

std::string lobes_table(const LobesJobResult& result) {
  if (result.comparison) return stability::comparison_csv(*result.comparison);
  if (result.sweep && !result.sweep->points.empty()) {
    return stability::points_csv(result.sweep->points, result.sweep->parameter);
  }
  if (result.sweep) return stability::sweep_csv(*result.sweep);
  if (!result.lobes.points.empty()) return stability::points_csv(result.lobes.points);
  return stability::limits_csv(result.lobes, result.uncertain);
}

std::string lobes_document(const LobesJobResult& result) {
  if (result.sweep) return io::dump(stability::sweep_table().write(*result.sweep));
  if (result.comparison) return io::dump(stability::comparison_table().write(*result.comparison));
  return io::dump(lobes_json_table().write(result));
}

}  // namespace robomill::jobs
