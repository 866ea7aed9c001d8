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
  require_output(common, jobs::Document::tools);
  const jobs::ToolsResult result = jobs::run_tools(
      {.assembly = command.input, .tools = command.tools, .lobes = command.lobes, .seed = common.seed}, progress);
  write_result(common, result);
  if (!command.frfs.empty()) jobs::write_tips(command.frfs, result.tools);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace

Exit run(const CoupleCommand& command, const Common& common, Progress& progress) {
  if (!command.tools.empty()) return try_tools(command, common, progress);
  require_output(common, jobs::Document::frfs);
  const jobs::TipPrediction prediction =
      jobs::predict_tip(command.input, {}, {.rotations = command.rotations}, progress);
  if (!command.holder_out.empty()) jobs::require_holder(prediction, "--holder-out");
  write_result(common, prediction);
  if (!command.holder_out.empty()) modal::write_frfs(command.holder_out, prediction.holder);
  show(common, jobs::summary(prediction), [&] { return jobs::page_of(prediction); });
  return exit_of(jobs::shortfall(prediction));
}

}  // namespace robomill::app
