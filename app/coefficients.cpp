#include "robomill/jobs/coefficients.hpp"

#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const CoefficientsCommand& command, const Common& common, Progress&) {
  require_output(common, jobs::Document::coefficients);
  const jobs::CoefficientsResult result = jobs::run_coefficients({.slots = command.slots, .teeth = command.teeth});
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
