#include "robomill/cell/files/posture_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"

namespace robomill::cell {
namespace {

using io::add_rows;
using io::key;
using io::of;
using io::Row;
using io::Schema;
using io::Use;
using modal::PostureReport;

constexpr Name<PostureReport::Source> sources[] = {{"cell", PostureReport::Source::cell},
                                                   {"calibrated", PostureReport::Source::calibrated},
                                                   {"interpolated", PostureReport::Source::interpolated}};

const Schema<modal::Mode>& mode_table() {
  using modal::Mode;
  static const Schema<Mode> table("posture_mode", "a mode there, with its standard deviations",
                                  {key("frequency_hz", &Mode::frequency_hz, "natural frequency"),
                                   key("frequency_std_hz", &Mode::frequency_std_hz, "of it").nullable(),
                                   key("damping_ratio", &Mode::damping_ratio, "share of critical"),
                                   key("damping_std", &Mode::damping_ratio_std, "of it").nullable(),
                                   key("residue_std", &Mode::residue_std_ratio, "of the residue, relative").nullable()},
                                  Use::written);
  return table;
}

/// The direct receptance of one force column.
struct Column {
  PostureReport::Direct direct = {};
  double deviation = 0.0;
};

const Schema<Column>& column_table() {
  using Direct = PostureReport::Direct;
  static const Schema<Column> table(
      "posture_column", "how well the direct receptance of one axis is known",
      {of(&Column::direct, key("measured", &Direct::measured, "hit along that axis")),
       of(&Column::direct, key("relative_error", &Direct::error, "of the measured postures").nullable()),
       of(&Column::direct,
          key("left_out_relative_error", &Direct::left_out_error, "each posture predicted from the others").nullable()),
       of(&Column::direct,
          key("held_out_relative_error", &Direct::held_out_error, "predicted without the forces along that axis")
              .nullable()),
       key("deviation", &Column::deviation, "likely, at this posture").nullable()},
      Use::written);
  return table;
}

const Schema<ModesOfPosture>& columns_table() {
  static const Schema<ModesOfPosture> table(
      "posture_columns", "by axis, in base axes",
      [] {
        std::vector<Row<ModesOfPosture>> rows;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          rows.push_back(key(
              std::string(1, "xyz"[axis]),
              [axis](const ModesOfPosture& posture) {
                return Column{posture.report.direct[axis], posture.direct_deviation(static_cast<Eigen::Index>(axis))};
              },
              column_table(), "of forces along it"));
        }
        return rows;
      }(),
      Use::written);
  return table;
}

const Schema<PostureReport>& structure_table() {
  static const Schema<PostureReport> table(
      "posture_structure", "which structure was calibrated",
      {key("bearings", &PostureReport::bearings, "tilting bearings of the joints"),
       key("bracket", &PostureReport::bracket, "a bracket under the spindle"),
       key("tool_modes", &PostureReport::tool_modes, "masses in the chain of spindle and tool")},
      Use::written);
  return table;
}

}  // namespace

std::string unmeasured_axes_text(const modal::PostureReport& report, const Eigen::Vector3d& deviation,
                                 const std::array<bool, 3>& asked) {
  if (report.source == modal::PostureReport::Source::cell) return {};
  std::string axes, directs;
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t axis = 0; axis < report.direct.size(); ++axis) {
    if (report.direct[axis].measured || !asked[axis]) continue;
    const std::string separator = axes.empty() ? "" : " and ";
    axes += separator + "xyz"[axis];
    directs += separator + std::string(2, "xyz"[axis]);
    worst = std::fmax(worst, deviation(static_cast<Eigen::Index>(axis)));
  }
  if (axes.empty()) return {};
  const std::string off = std::isfinite(worst) ? fmt::format(
                                                     " and is likely off by {:.0f} %, which the deviations of "
                                                     "the modes include",
                                                     100.0 * worst)
                                               : std::string();
  return fmt::format(
      "Nobody hit along the base's {0}: {1} follows from the other columns{2}. A limit or deflection of a cut that "
      "pushes along {0} (a ball end, a leaning tool, axial forces) depends on it: hit along {0} too.",
      axes, directs, off);
}

const Schema<ModesOfPosture>& posture_table() {
  using modal::PosturePrediction;
  const auto predicted = [](auto row) { return of(&ModesOfPosture::prediction, std::move(row)); };
  const auto reported = [](auto row) { return of(&ModesOfPosture::report, std::move(row)); };
  static const Schema<ModesOfPosture> table(
      "posture", "the posture that the modes are of",
      {key("joints_deg", &ModesOfPosture::joints, "position of each joint"),
       key(
           "modes", [](const ModesOfPosture& posture) { return posture.prediction.modes.modes; }, mode_table(),
           "of the tip there"),
       predicted(key("measured_nearby", &PosturePrediction::measured_nearby, "lies within the measured region")),
       predicted(key("distance_deg", &PosturePrediction::distance_rad,
                     "to the nearest measured posture over joints 2 to n; none: nothing was measured")
                     .nullable()),
       reported(key("region_deg", &PostureReport::region_rad, "distance up to which a posture counts as measured")
                    .nullable()),
       predicted(key("nearest", &PosturePrediction::nearest, "name of the nearest measured posture")),
       key("unmatched_modes", &ModesOfPosture::unmatched,
           "modes of the nearest posture without a counterpart in the others, which are left out"),
       reported(key("source", &PostureReport::source, sources, "of the modes")),
       reported(key("measured_postures", &PostureReport::postures, "how many")),
       key("structure", &ModesOfPosture::report, structure_table(), "which structure was calibrated"),
       key(
           "columns", [](const ModesOfPosture& posture) { return &posture; }, columns_table(),
           "of the direct receptances"),
       reported(key("relative_error", &PostureReport::error, "mean over all postures").nullable()),
       reported(key("left_out_relative_error", &PostureReport::left_out_error,
                    "the same, each posture predicted from the others")
                    .nullable())},
      Use::written);
  return table;
}

std::vector<std::string> posture_warnings(const ModesOfPosture& posture, const std::array<bool, 3>& asked) {
  std::vector<std::string> out = posture.warnings;
  const modal::PosturePrediction& there = posture.prediction;
  if (posture.unmatched > 0) {
    out.push_back(fmt::format(
        "{} of the {} modes of the nearest posture ({}) have no counterpart in the others and are left out: limits "
        "computed from the rest are too deep where these would chatter.",
        posture.unmatched, posture.unmatched + there.modes.modes.size(), there.nearest));
  }
  const std::string unmeasured = unmeasured_axes_text(posture.report, posture.direct_deviation, asked);
  if (!unmeasured.empty()) out.push_back(unmeasured);
  if (there.measured_nearby || posture.report.postures == 0) return out;
  const double away_deg = there.distance_rad / units::deg;
  out.push_back(
      posture.report.postures == 1
          ? fmt::format("The posture lies {:.3g} deg from the only measured one. Its deviations grow with that.",
                        away_deg)
          : fmt::format(
                "The posture lies outside the measured region: {:.3g} deg from the nearest measured one (at most "
                "{:.3g} deg within it). Its deviations grow with that.",
                away_deg, posture.report.region_rad / units::deg));
  return out;
}

const Schema<ModesDocument>& modes_document_table() {
  const io::TableInfo& modes = modal::modes_table().info();
  static const Schema<ModesDocument> table(
      modes.name, modes.meaning,
      [] {
        const auto of_posture = [](Row<ModesOfPosture> row) {
          std::vector<Row<ModesDocument>> lifted = io::keys_of<ModesDocument>(
              std::vector{std::move(row)},
              [](const ModesDocument& document) -> const ModesOfPosture& { return *document.posture; });
          return where([](const ModesDocument& document) { return document.posture != nullptr; },
                       std::move(lifted.front()));
        };
        std::vector<Row<ModesDocument>> rows = io::keys_of<ModesDocument>(
            modal::modes_table().rows(), [](const ModesDocument& document) { return document.modes; });
        // Of a fit they are its own.
        rows.pop_back();
        add_rows(rows, {of_posture(key(
                            "posture", [](const ModesOfPosture& posture) { return &posture; }, posture_table(),
                            "that the modes are of, where they are those of a cell")),
                        where(
                            [](const ModesDocument& document) {
                              return document.posture != nullptr || document.modes.fit != nullptr;
                            },
                            key(
                                "warnings",
                                [](const ModesDocument& document) {
                                  return document.posture != nullptr ? posture_warnings(*document.posture)
                                                                     : document.modes.fit->warnings;
                                },
                                "sentences for the user")),
                        of_posture(key("notes", &ModesOfPosture::notes, "of the files that were read")),
                        of_posture(key("assumed", &ModesOfPosture::assumed, io::assumption_table(),
                                       "what the input did not give"))});
        return rows;
      }(),
      Use::written, modes.version);
  return table;
}

std::string posture_modes_json(const ModesOfPosture& posture) {
  posture.prediction.modes.validate();
  return io::dump(modes_document_table().write({.modes = {.model = &posture.prediction.modes}, .posture = &posture}));
}

}  // namespace robomill::cell
