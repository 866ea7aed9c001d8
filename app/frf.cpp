#include "robomill/jobs/frf.hpp"

#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const FrfCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::frfs);
  const jobs::FrfJobResult result = jobs::run_frf(command.hits, progress);
  if (command.binary && !common.output.empty() && !common.to_stdout()) {
    jobs::write_document(common.output, result, {.binary_uff = true});
  } else {
    write_result(common, result);
  }
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
