#include "robomill/jobs/tools.hpp"

#include <string>

#include "robomill/base/error.hpp"

namespace robomill::jobs {
namespace {

/// A cut that suits any cutter.
void require_any_cutter(const LobesFile& cut) {
  const std::string where = cut.path.string();
  require_plane(cut, "A list of tools needs a milling cut");
  const cutting::FlatEndMill& tool = cut.problem.milling.tool;
  if (!tool.pitch_rad.empty() || !tool.tooth_helix_rad.empty() || tool.runout_m > 0.0) {
    throw InvalidInput(where, "tool.pitch_deg, runout_um and a helix a tooth are those of one cutter",
                       "Leave them out for a list of tools");
  }
  if (!(cut.problem.milling.feed_per_tooth_m > 0.0)) {
    throw InvalidInput(where, "cut.feed_per_tooth_mm is missing", "The best speed is that of the highest removal rate");
  }
}

}  // namespace

std::vector<decision::ToolResult> try_tools(const coupling::AssemblyFile& assembly,
                                            const std::vector<coupling::ListedTool>& tools,
                                            const std::optional<LobesFile>& cut, std::uint64_t seed,
                                            Progress& progress) {
  std::optional<decision::ToolCut> taken;
  if (cut) {
    require_any_cutter(*cut);
    taken = {.problem = cut->problem,
             .options = cut->options,
             .direction = cut->direction,
             .radial_depth_m = cut->radial_depth_m};
  }
  return decision::try_tools(assembly.assembly, assembly.frequency_hz, tools, taken, seed, progress);
}

ToolsResult run_tools(const ToolsJob& job, Progress& progress) {
  ToolsResult out;
  out.assembly = coupling::read_assembly(job.assembly, {.cuts = true});
  const auto tools = coupling::read_tools(job.tools, out.assembly.assembly.tool.front(), out.assembly.notes);
  if (!out.assembly.cutting_note.empty()) out.assembly.notes.push_back(out.assembly.cutting_note);
  if (!job.lobes.empty()) {
    out.cut = read_lobes(job.lobes);
    // Each tool brings its own dynamics; those of a workpiece stay.
    out.cut->drop_dynamics();
    load_dynamics(*out.cut);
  }
  out.tools = try_tools(out.assembly, tools, out.cut, job.seed, progress);
  return out;
}

}  // namespace robomill::jobs
