#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"
#include "robomill/coupling/files/tools_csv.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/jobs/pages.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

/// A table of many tools in the assembly's holder.
Exit try_tools(const CoupleCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::csv, io::Format::json}, "a table of tools is written as .csv or .json");
  const coupling::AssemblyFile assembly = coupling::read_assembly(command.input);
  const auto tools = coupling::read_tools(command.tools, assembly.assembly.tool.front());
  std::optional<jobs::LobesFile> cut;
  if (!command.lobes.empty()) {
    cut = jobs::read_lobes(command.lobes);
    // Each tool brings its own dynamics; those of a workpiece stay.
    cut->drop_dynamics();
    jobs::load_dynamics(*cut);
  }
  const std::vector<jobs::ToolResult> results = jobs::try_tools(assembly, tools, cut, common.seed, progress);
  write_output(common, [&](io::Format format) {
    return format == io::Format::csv ? jobs::tools_csv(results) : jobs::tools_json(results, assembly.holder);
  });
  if (!command.frfs.empty()) jobs::write_tips(command.frfs, results);
  show(common, jobs::summary(results, assembly, cut), [&] { return jobs::page_of(results, assembly, cut); });
  const bool all_done =
      std::all_of(results.begin(), results.end(), [](const auto& t) { return t.failure.empty() && t.no_cut.empty(); });
  if (all_done) return done;
  fmt::print(stderr, "robomill: not every tool has a result; its row says why\n");
  return not_reached;
}

}  // namespace

Exit run(const CoupleCommand& command, const Common& common, Progress& progress) {
  if (!command.tools.empty()) return try_tools(command, common, progress);
  const jobs::TipPrediction prediction =
      jobs::predict_tip(command.input, {}, {.rotations = command.rotations}, progress);
  if (!command.holder_out.empty() && prediction.holder.frfs.empty()) {
    throw InvalidInput("--holder-out", "needs a measured holder",
                       "A holder of segments, or a rigid wall, has nothing to keep for the next tool");
  }
  if (common.to_stdout() || io::format_of(common.output) == io::Format::json) {
    write_output(common, [&](io::Format) { return jobs::tip_json(prediction); });
  } else if (!common.output.empty()) {
    modal::write_frfs(common.output, prediction.tip.frfs);
  }
  if (!command.holder_out.empty()) modal::write_frfs(command.holder_out, prediction.holder);
  show(common, jobs::summary(prediction), [&] { return jobs::page_of(prediction); });
  return done;
}

}  // namespace robomill::app
