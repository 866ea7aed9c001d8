#include "robomill/jobs/frf.hpp"

#include <fmt/format.h>

#include "robomill/jobs/pages.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const FrfCommand& command, const Common& common, Progress& progress) {
  const jobs::FrfJobResult result = jobs::run_frf(command.hits, progress);
  if (common.to_stdout()) {
    fmt::print("{}", modal::frf_json(result.frfs));
  } else if (!common.output.empty()) {
    modal::write_frfs(common.output, result.frfs, {.binary_uff = command.binary});
  }
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return done;
}

}  // namespace robomill::app
