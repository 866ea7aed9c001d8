#include "robomill/jobs/coefficients.hpp"

#include <fmt/format.h>

#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

std::string document(const jobs::CoefficientsResult& result, io::Format format) {
  if (format == io::Format::csv) return cutting::slot_fit_csv(result.fit);
  if (format == io::Format::toml) return cutting::slot_fit_toml(result.fit, result.file, result.assumed);
  return cutting::slot_fit_json(result.fit, result.file, result.assumed);
}

}  // namespace

Exit run(const CoefficientsCommand& command, const Common& common, Progress&) {
  require_output(common, {io::Format::toml, io::Format::csv, io::Format::json},
                 "coefficients are written as .toml, .csv or .json");
  const jobs::CoefficientsResult result = jobs::run_coefficients({.slots = command.slots, .teeth = command.teeth});
  write_output(common, [&](io::Format format) { return document(result, format); });
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  if (!(result.fit.tangential.cutting_n_per_m2 > 0.0)) {
    fmt::print(stderr, "robomill: the tangential coefficient is not above 0: are these the forces on the tool?\n");
    return not_reached;
  }
  if (result.fit.status == cutting::SlotFit::Status::identified) return done;
  fmt::print(stderr, "robomill: one feed does not determine the edge force\n");
  return not_reached;
}

}  // namespace robomill::app
