#include "robomill/process/files/forces_schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/cutting/files/cut_schema.hpp"
#include "robomill/process/files/measured_schema.hpp"
#include "robomill/process/files/revolution_schema.hpp"
#include "robomill/program/files/skipped_schema.hpp"

namespace robomill::process {
namespace {

using io::add_rows;
using io::Json;
using io::key;
using io::keys_of;
using io::of;
using io::Row;
using io::Schema;
using io::Use;

constexpr Name<cutting::CutterKind> cutters_in_words[] = {{"flat end", cutting::CutterKind::flat_end},
                                                          {"ball end", cutting::CutterKind::ball_end},
                                                          {"bull nose", cutting::CutterKind::bull_nose},
                                                          {"general cutter", cutting::CutterKind::general}};

/// Of what is written the signs of forces are those on the tool, or on the workpiece.
double sign_of(const ForcesResult& result) {
  return result.cut.on_workpiece ? -1.0 : 1.0;
}

/// A number of a block's force.
Row<ForcesLine> of_force(Row<cutting::BlockForce> row) {
  return keys_of<ForcesLine>(std::vector{std::move(row)},
                             [](const ForcesLine& at) -> const cutting::BlockForce& { return at.result->force; })
      .front();
}

/// A number that needs a robot.
template <class F>
Row<ForcesLine> of_robot(const std::string& name, F value, const std::string& meaning) {
  return key(
             name,
             [value](const ForcesLine& at) {
               return at.result->joints.size() > 0 ? std::optional<double>(value(*at.result)) : std::nullopt;
             },
             meaning)
      .nullable();
}

std::vector<Row<ForcesLine>> place_keys() {
  return {
      key(
          "block", [](const ForcesLine& at) { return at.result->force.block + 1; }, "number in the program, from 1"),
      key(
          "line", [](const ForcesLine& at) { return at.block().line; }, "of the program's file"),
      key(
          "x_mm", [](const ForcesLine& at) { return at.block().end.tip_m.x(); }, "of the tip at its end"),
      key(
          "y_mm", [](const ForcesLine& at) { return at.block().end.tip_m.y(); }, "the same"),
      key(
          "z_mm", [](const ForcesLine& at) { return at.block().end.tip_m.z(); }, "the same")};
}

std::vector<Row<ForcesLine>> load_keys() {
  using cutting::BlockForce;
  std::vector<Row<ForcesLine>> rows = {
      of_force(key("axial_depth_mm", &BlockForce::axial_depth_m, "greatest, along the tool's axis")),
      of_force(key(cutting::radial_depth_key, &BlockForce::radial_depth_m, "greatest, across the feed"))};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    rows.push_back(key(
        fmt::format("mean_f{}_n", "xyz"[axis]),
        [axis](const ForcesLine& at) { return at.result->force.mean_force_n(axis) * sign_of(*at.forces); },
        "mean while it cuts"));
  }
  add_rows(
      rows,
      {of_force(key("peak_f_n", &BlockForce::peak_force_n, "largest force")),
       of_force(key("torque_n_m", &BlockForce::mean_torque_n_m, "mean")),
       of_force(key("revolution_torque_n_m", &BlockForce::revolution_torque_n_m, "largest mean over a revolution")),
       of_force(key("peak_torque_n_m", &BlockForce::peak_torque_n_m, "largest")),
       of_force(key("power_w", &BlockForce::power_w, "mean")),
       of_force(key("peak_power_w", &BlockForce::peak_power_w, "largest mean over a revolution")),
       of_force(key("sustained_power_w", &BlockForce::sustained_power_w, "largest mean over power_time_s")),
       of_robot(
           "deflection_um", [](const BlockResult& r) { return r.deflection_m.norm(); },
           "of the tip under the mean force; none: no robot")});
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    rows.push_back(of_robot(
        fmt::format("deflection_{}_um", "xyz"[axis]), [axis](const BlockResult& r) { return r.deflection_m(axis); },
        "its component"));
  }
  add_rows(rows, {of_robot(
                      "peak_deflection_um", [](const BlockResult& r) { return r.peak_deflection_m.norm(); },
                      "under the mean force of the heaviest revolution"),
                  of_force(key("cutting_time_s", &BlockForce::cutting_time_s, "in which teeth are in the material")),
                  of_force(key("feed_per_tooth_mm", &BlockForce::feed_per_tooth_m, "of the block")),
                  of_force(key("removed_mm3", &BlockForce::removed_volume_m3, "material")),
                  of_robot(
                      "condition_number", [](const BlockResult& r) { return r.condition_number; },
                      "of the Jacobian at its end")});
  return rows;
}

std::vector<Row<ForcesLine>> column_keys() {
  std::vector<Row<ForcesLine>> rows = place_keys();
  add_rows(rows, load_keys());
  return rows;
}

}  // namespace

const Schema<ForcesLine>& line_table() {
  static const Schema<ForcesLine> table(
      "forces_block", "forces of a block, with how far and how long the program has run at its end",
      [] {
        std::vector<Row<ForcesLine>> rows = column_keys();
        add_rows(rows, {key(
                            "cuts", [](const ForcesLine& at) { return at.result->force.cuts(); }, "teeth cut in it"),
                        key("path_mm", &ForcesLine::path_m, "of the program"),
                        key("time_s", &ForcesLine::time_s, "of the program")});
        return rows;
      }(),
      Use::written);
  return table;
}

namespace {

/// A block that cuts and its value of a key.
using Ranked = std::pair<double, ForcesLine>;
/// Those with the highest values of a key, the highest first, of equal ones the first; blocks are left out of which it
/// is not known.
std::vector<Ranked> highest_lines(const ForcesResult& forces, std::string_view name, std::size_t most) {
  const auto row = std::ranges::find_if(line_table().rows(), [&](const auto& one) { return one.key.name == name; });
  std::vector<Ranked> out;
  each_line(forces, [&](const ForcesLine& at) {
    if (!at.result->force.cuts()) return;
    const Json value = row->write(at, *row);
    if (!value.is_number()) return;
    const Ranked one = {value.get<double>(), at};
    if (out.size() == most && !(one.first > out.back().first)) return;
    if (out.size() == most) out.pop_back();
    out.insert(std::ranges::upper_bound(out, one.first, std::ranges::greater(), &Ranked::first), one);
  });
  return out;
}

const Schema<Ranked>& highest_table() {
  static const Schema<Ranked> table(
      "highest", "the highest value along a program, and where",
      {key("value", &Ranked::first, "in the unit of its key"),
       key(
           "block", [](const Ranked& at) { return at.second.result->force.block + 1; }, "number in the program"),
       key(
           "line", [](const Ranked& at) { return at.second.block().line; }, "its line")},
      Use::written);
  return table;
}

const Schema<ForcesResult>& highest_values_table() {
  static const Schema<ForcesResult> table(
      "highest_values", "what a program is judged by",
      [] {
        std::vector<Row<ForcesResult>> rows;
        for (const char* const name :
             {"peak_f_n", "revolution_torque_n_m", "peak_torque_n_m", "sustained_power_w", "peak_deflection_um"}) {
          rows.push_back(key(
                             name,
                             [name](const ForcesResult& forces) {
                               const std::vector<Ranked> found = highest_lines(forces, name, 1);
                               return found.empty() ? std::nullopt : std::optional(found.front());
                             },
                             highest_table(), "none: no block cuts, or it is not known")
                             .nullable());
        }
        return rows;
      }(),
      Use::written);
  return table;
}

/// All of them.
std::vector<ForcesLine> lines_of(const ForcesResult& forces) {
  std::vector<ForcesLine> out;
  out.reserve(forces.program->blocks.size());
  each_line(forces, [&](const ForcesLine& line) { out.push_back(line); });
  return out;
}

/// The blocks with the highest peak force, the worst first.
std::vector<ForcesLine> worst_lines(const ForcesResult& forces) {
  constexpr std::size_t most = 10;
  std::vector<ForcesLine> out;
  for (const Ranked& one : highest_lines(forces, "peak_f_n", most)) out.push_back(one.second);
  return out;
}

const Schema<ProgramStock>& stock_table() {
  static const Schema<ProgramStock> table(
      "stock", "what a program starts from",
      {key(
           "assumed", [](const ProgramStock& stock) { return stock.assumed.has_value(); }, "none is given"),
       key(
           "top_from",
           [](const ProgramStock& stock) {
             using Top = cutting::DefaultStock::Top;
             if (!stock.assumed) return "";
             return stock.assumed->top == Top::program_zero ? "program zero" : "axial depth";
           },
           "where its height comes from; none: it is given")
           .words({"program zero", "axial depth"})
           .nullable(),
       key(
           "min_mm", [](const ProgramStock& stock) { return stock.stock.lowest_m(); }, "corner of its box")
           .entries(3),
       key(
           "max_mm", [](const ProgramStock& stock) { return stock.stock.highest_m(); }, "corner of its box")
           .entries(3)},
      Use::written);
  return table;
}

std::vector<Row<ForcesResult>> program_keys() {
  const auto spindle = [](double decision::SpindleCapacity::*member) {
    return [member](const ForcesResult& result) {
      return result.spindle ? io::if_positive((*result.spindle).*member) : std::nullopt;
    };
  };
  return {
      key(
          "removed_mm3", [](const ForcesResult& result) { return result.program->removed_volume_m3; }, "material"),
      key(
          "seconds", [](const ForcesResult& result) { return result.program->seconds; }, "of the program"),
      key(
          "cutting_blocks", [](const ForcesResult& result) { return result.program->cutting_blocks(); },
          "in which teeth cut"),
      key(
          "power_time_s", [](const ForcesResult& result) { return result.cut.power_time_s; },
          "over which sustained power is a mean"),
      key("torque_limit_n_m", spindle(&decision::SpindleCapacity::torque_n_m), "of the spindle").nullable(),
      key("power_limit_w", spindle(&decision::SpindleCapacity::power_w), "of the spindle").nullable(),
      key(
          "stock", [](const ForcesResult& result) { return result.program->stock ? &*result.program->stock : nullptr; },
          stock_table(), "none: each block beside its neighbouring pass")
          .nullable(),
      key(
          "highest", [](const ForcesResult& result) { return &result; }, highest_values_table(), "and where"),
      key(
          "worst", [](const ForcesResult& result) { return worst_lines(result); }, line_table(),
          "blocks of the highest peak force, ten at most"),
      key(
          blocks_key, [](const ForcesResult& result) { return lines_of(result); }, line_table(), "of the program"),
      key(
          "skipped", [](const ForcesResult& result) { return result.program->program.skipped; },
          program::skipped_table(), "what its reader left out")};
}

std::vector<Fact> facts_of(const ForcesResult& result) {
  std::vector<Fact> facts;
  const cutting::Cutter& cutter = result.cut.cutter;
  facts.push_back({"Cutter", fmt::format("{}, {:.4g} mm, {} teeth, helix {:.3g}°",
                                         name_in(cutters_in_words, cutter.kind), cutter.mill.diameter_m / units::mm,
                                         cutter.mill.teeth, cutter.mill.helix_rad / units::deg)});
  if (result.revolution) {
    const cutting::Cut& cut = result.cut.cut;
    facts.push_back(
        {"Cut", fmt::format("{:.4g} mm deep, {:.4g} mm step-over, {:.4g} mm a tooth, lead {:.3g}°, tilt {:.3g}°",
                            cut.axial_depth_m / units::mm, cut.radial_depth_m / units::mm,
                            result.cut.motion.feed_per_tooth_m / units::mm, cut.lead_rad / units::deg,
                            cut.tilt_rad / units::deg)});
    facts.push_back({"Speed", fmt::format("{:.0f} rpm", result.cut.motion.spindle_speed_rad_per_s / units::rpm)});
  }
  if (result.program) {
    facts.push_back({"Program", fmt::format("{} blocks", result.program->blocks.size())});
    const std::optional<ProgramStock>& stock = result.program->stock;
    if (stock && !stock->assumed) facts.push_back({"Stock", stock_text(*result.program)});
  }
  return facts;
}

}  // namespace

const Schema<Fact>& fact_table() {
  static const Schema<Fact> table("fact", "what was cut with what",
                                  {key("label", &Fact::label, "of what"), key("value", &Fact::value, "in words")},
                                  Use::written);
  return table;
}

void each_line(const ForcesResult& forces, const std::function<void(const ForcesLine&)>& use) {
  const ProgramForces& program = *forces.program;
  double path_m = 0.0, time_s = 0.0;
  for (const BlockResult& row : program.blocks) {
    const program::Block& block = program.program.blocks[row.force.block];
    path_m += (block.end.tip_m - program.program.begin_of(row.force.block).tip_m).norm();
    time_s += block.duration_s;
    use({.forces = &forces, .result = &row, .path_m = path_m, .time_s = time_s});
  }
}

const io::Columns<ForcesLine>& forces_columns() {
  static const Schema<ForcesLine> rows("forces_columns", "forces of every block", column_keys(), Use::written);
  static const io::Columns<ForcesLine> columns(rows);
  return columns;
}

const Schema<ForcesResult>& forces_table() {
  static const Schema<ForcesResult> table(
      "forces", "cutting forces over a revolution, or along a program",
      [] {
        std::vector<Row<ForcesResult>> rows = {
            key(
                "force_on", [](const ForcesResult& result) { return result.cut.on_workpiece ? "workpiece" : "tool"; },
                "what forces attack")
                .words({"tool", "workpiece"})};
        const auto view = [](const ForcesResult& result) {
          return RevolutionView{&*result.revolution, sign_of(result)};
        };
        for (Row<ForcesResult>& row : keys_of<ForcesResult>(revolution_rows(), view)) {
          rows.push_back(
              where([](const ForcesResult& result) { return result.revolution.has_value(); }, std::move(row)));
        }
        rows.push_back(where(
            [](const ForcesResult& result) { return result.measured.has_value(); },
            key(
                "measured", [](const ForcesResult& result) { return result.measured ? &*result.measured : nullptr; },
                measured_table(), "with a force record")));
        for (Row<ForcesResult>& row : program_keys())
          rows.push_back(where([](const ForcesResult& result) { return result.program.has_value(); }, std::move(row)));
        add_rows(rows,
                 {key(
                      "facts", [](const ForcesResult& result) { return facts_of(result); }, fact_table(), "in words"),
                  key("warnings", &ForcesResult::warnings, "sentences for the user"),
                  key("notes", &ForcesResult::notes, "sentences for the user"),
                  key("assumed", &ForcesResult::assumed, io::assumption_table(), "what the input did not give")});
        return rows;
      }(),
      Use::written, 1);
  return table;
}

}  // namespace robomill::process
