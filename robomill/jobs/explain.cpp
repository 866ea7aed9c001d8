#include "robomill/jobs/explain.hpp"

#include "robomill/base/error.hpp"
#include "robomill/modal/files/modes_files.hpp"

namespace robomill::jobs {
namespace {

/// A cut whose equation can be integrated in time.
LobesFile cut_of_modes(const std::filesystem::path& path) {
  LobesFile cut = read_milling(path);
  if (!cut.frf.empty() || !cut.workpiece_frf.empty()) {
    throw InvalidInput(path.string(), "must name modes: without them the equation has no time",
                       "Run robomill modes on the FRFs and name the result as dynamics.modes");
  }
  return cut;
}

}  // namespace

ExplainResult run_explain(const ExplainJob& job) {
  ExplainResult result;
  result.teeth = job.peaks.teeth;
  const modal::ModalModel tool = modal::read_modes(job.modes, result.notes);
  if (!job.lobes.empty()) result.cut = cut_of_modes(job.lobes);
  const modal::ModalModel workpiece = result.cut ? result.cut->problem.workpiece_dynamics : modal::ModalModel{};
  result.peaks = stability::explain(job.peaks, tool, job.options, workpiece);
  if (result.cut) result.mechanism = stability::chatter_mechanism(result.cut->problem, job.point);
  return result;
}

}  // namespace robomill::jobs
