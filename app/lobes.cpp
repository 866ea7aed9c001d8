#include <fmt/format.h>

#include <algorithm>

#include "point.hpp"
#include "robomill/base/error.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/lobes_json.hpp"
#include "robomill/formats/lobes_toml.hpp"
#include "robomill/formats/units.hpp"
#include "robomill/stability/lobes.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

void print_summary(const stability::LobesResult& result) {
  for (const stability::PointResult& point : result.points) {
    fmt::print("{:.6g} rpm, {:.4g} mm: |μ| = {:.6g} ± {:.1g}, {}", point.spindle_speed_rad_per_s / units::rpm,
               point.axial_depth_m / units::mm, point.spectral_radius, point.error_estimate,
               point.stable ? "stable" : "chatter");
    if (!point.stable) {
      fmt::print(" at {:.1f} Hz (mode {}, {})", point.chatter_frequency_hz, point.mode, to_string(point.kind));
    }
    fmt::print("\n");
  }
  const stability::Limit* lowest = nullptr;
  for (const stability::Limit& limit : result.limit) {
    if (limit.status != stability::Limit::Status::found) continue;
    if (lowest == nullptr || limit.axial_depth_m < lowest->axial_depth_m) lowest = &limit;
  }
  if (lowest == nullptr) {
    fmt::print("No chatter in the whole range.\n");
  } else {
    fmt::print("Stable at every speed up to {:.4g} mm; above that chatter at {:.6g} rpm and {:.1f} Hz (mode {}).\n",
               lowest->axial_depth_m / units::mm, lowest->spindle_speed_rad_per_s / units::rpm,
               lowest->chatter_frequency_hz, lowest->mode);
  }
  fmt::print("{} points of the chart in {:.2f} s, {}.\n", result.evaluations, result.seconds, to_string(result.method));
  if (result.uncertain > 0) {
    fmt::print("{} points are less accurate than the tolerance; their error_estimate says how much.\n",
               result.uncertain);
  }
}

}  // namespace

Exit run(const LobesCommand& command, const Common& common, Progress& progress) {
  if (!common.output.empty() && !common.to_stdout() && formats::format_of(common.output) != formats::Format::json) {
    throw InvalidInput(common.output, "lobes are written as .json");
  }
  formats::LobesFile file = formats::read_lobes(command.input);
  formats::load_modes(file);
  if (!file.frf.empty()) {
    throw InvalidInput(command.input.string(), "dynamics.frf needs a fit first",
                       "Run robomill modes on it and name the result as dynamics.modes");
  }
  if (file.drilling) {
    throw InvalidInput(command.input.string(), "lobes are those of milling", "robomill simulate takes drilling");
  }
  file.validate();
  for (const std::string& text : command.at) file.options.points.push_back(parse_point(text));
  const stability::LobesResult result = stability::compute_lobes(file.problem, file.options, progress);
  stability::UncertainLimits uncertain;
  if (file.uncertainty.samples > 0) {
    file.uncertainty.seed = common.seed;
    uncertain = stability::uncertain_limits(file.problem, file.options, file.uncertainty, progress);
  }
  if (common.to_stdout()) {
    fmt::print("{}", formats::lobes_json(result, uncertain));
  } else if (!common.output.empty()) {
    formats::write_file(common.output, formats::lobes_json(result, uncertain));
  }
  if (common.wants_summary()) print_summary(result);
  return done;
}

}  // namespace robomill::app
