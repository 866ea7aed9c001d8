#include <fmt/format.h>

#include <cmath>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/coefficients.hpp"
#include "robomill/cutting/files/slots_csv.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

std::string with_deviation(double value, double deviation) {
  return std::isfinite(deviation) ? fmt::format("{:.6g} ± {:.2g}", value, deviation) : fmt::format("{:.6g}", value);
}

void print_pair(const char* name, const cutting::CoefficientPair& pair, bool edge_known) {
  const std::string cutting =
      with_deviation(pair.cutting_n_per_m2 / units::n_per_mm2, pair.cutting_deviation_n_per_m2 / units::n_per_mm2);
  const std::string edge =
      edge_known ? with_deviation(pair.edge_n_per_m / units::n_per_mm, pair.edge_deviation_n_per_m / units::n_per_mm)
                 : "not stated";
  fmt::print("{:<12} {:>22} {:>22}", name, cutting, edge);
  if (std::isfinite(pair.r_squared)) fmt::print("   R² {:.6f}", pair.r_squared);
  fmt::print("\n");
}

void print_summary(const cutting::SlotFit& fit, const cutting::SlotsFile& file) {
  const bool edge_known = fit.status == cutting::SlotFit::Status::identified;
  fmt::print("{:<12} {:>22} {:>22}\n", fmt::format("{} slots", file.slots.size()), "cutting, N/mm²", "edge, N/mm");
  print_pair("tangential", fit.tangential, edge_known);
  print_pair("radial", fit.radial, edge_known);
  print_pair("axial", fit.axial, edge_known);
  Eigen::Index worst = 0;
  const double residual_n = fit.residual_n.colwise().norm().maxCoeff(&worst);
  fmt::print("largest residual {:.3g} N, line {}\n", residual_n, file.lines[static_cast<std::size_t>(worst)]);
  if (fit.depends_on_speed) {
    for (const cutting::SpeedGroup& group : fit.by_speed) {
      fmt::print("{:.6g} rpm, {} slots: tangential {}, radial {} N/mm²\n", group.spindle_speed_rad_per_s / units::rpm,
                 group.rows,
                 with_deviation(group.tangential.cutting_n_per_m2 / units::n_per_mm2,
                                group.tangential.cutting_deviation_n_per_m2 / units::n_per_mm2),
                 with_deviation(group.radial.cutting_n_per_m2 / units::n_per_mm2,
                                group.radial.cutting_deviation_n_per_m2 / units::n_per_mm2));
    }
  }
  print_notes(fit.notes, "");
}

constexpr int usual_teeth = 4;

cutting::SlotFit identify(const cutting::SlotsFile& file, const CoefficientsCommand& command) {
  try {
    const bool reported = command.teeth > 0;
    cutting::SlotFit fit = cutting::identify_from_slots(file.slots, {.teeth = reported ? command.teeth : usual_teeth});
    if (!reported) {
      fit.notes.push_back(
          fmt::format("The number of teeth was not given (--teeth): {} are assumed; with N teeth every "
                      "coefficient is {}/N of these.",
                      usual_teeth, usual_teeth));
    }
    return fit;
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (parts.field == "slots") parts.where = command.slots.string();
    throw InvalidInput(std::move(parts));
  }
}

}  // namespace

Exit run(const CoefficientsCommand& command, const Common& common, Progress&) {
  require_output(common, {io::Format::toml, io::Format::json}, "coefficients are written as .toml or .json");
  const cutting::SlotsFile file = cutting::read_slots(command.slots);
  const cutting::SlotFit fit = identify(file, command);
  write_output(common, [&](io::Format format) {
    return format == io::Format::toml ? cutting::slot_fit_toml(fit, file) : cutting::slot_fit_json(fit, file);
  });
  if (common.wants_summary()) print_summary(fit, file);
  if (!(fit.tangential.cutting_n_per_m2 > 0.0)) {
    fmt::print(stderr, "robomill: the tangential coefficient is not above 0: are these the forces on the tool?\n");
    return not_reached;
  }
  if (fit.status == cutting::SlotFit::Status::identified) return done;
  fmt::print(stderr, "robomill: one feed does not determine the edge force\n");
  return not_reached;
}

}  // namespace robomill::app
