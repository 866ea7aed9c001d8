#include "robomill/process/files/forces_schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/program/files/skipped_schema.hpp"
#include "robomill/simulation/files/simulation_files.hpp"

namespace robomill::process {
namespace {

using cutting::CuttingForce;
using cutting::Engagement;
using cutting::StaticDeflection;
using io::add_rows;
using io::Json;
using io::key;
using io::keys_of;
using io::of;
using io::Row;
using io::Schema;
using io::Use;
using simulation::Simulation;

constexpr Name<StaticDeflection::Status> settled_names[] = {{"found", StaticDeflection::Status::found},
                                                            {"digs in", StaticDeflection::Status::diverged},
                                                            {"lifts off", StaticDeflection::Status::lifts_off}};
constexpr Name<cutting::CutterKind> cutters_in_words[] = {{"flat end", cutting::CutterKind::flat_end},
                                                          {"ball end", cutting::CutterKind::ball_end},
                                                          {"bull nose", cutting::CutterKind::bull_nose},
                                                          {"general cutter", cutting::CutterKind::general}};

/// Of what is written the signs of forces are those on the tool, or on the workpiece.
double sign_of(const ForcesResult& result) {
  return result.cut.on_workpiece ? -1.0 : 1.0;
}

// One revolution

struct RingView {
  const Engagement* engagement = nullptr;
  std::size_t index = 0;
  [[nodiscard]] const cutting::EdgeSlice& slice() const { return engagement->slices[index]; }
};

const Schema<RingView>& ring_table() {
  static const Schema<RingView> table(
      "engaged_ring", "a ring of the cutter",
      {key(
           "height_mm", [](const RingView& at) { return at.slice().height_m; }, "above the tip"),
       key(
           "radius_mm", [](const RingView& at) { return at.slice().radius_m; }, "of the ring"),
       key(
           "position_deg", [](const RingView& at) { return at.slice().position_rad; }, "angle of the profile's normal"),
       key(
           "arcs_deg",
           [](const RingView& at) {
             std::vector<std::array<double, 2>> out;
             for (const cutting::Arc& arc : at.engagement->of(at.index)) out.push_back({arc.entry_rad, arc.exit_rad});
             return out;
           },
           "[entry, exit] of each arc in the cut")
           .entries(2)},
      Use::written);
  return table;
}

struct RotationView {
  const robot::Redundancy* rotation = nullptr;
  double used_rad = 0.0;
};

/// A list of what is known of each turn; null where the robot cannot stand so, or hold the force.
template <class F>
Row<RotationView> of_turns(std::string name, F value, std::string meaning) {
  return key(
             std::move(name),
             [value](const RotationView& view) {
               std::vector<std::optional<double>> out;
               for (const robot::RedundancySample& sample : view.rotation->samples) {
                 const bool stands = sample.status == robot::Reach::Status::found && !sample.buckled;
                 out.push_back(stands ? std::optional<double>(value(sample)) : std::nullopt);
               }
               return out;
             },
             std::move(meaning))
      .nullable();
}

const Schema<RotationView>& rotation_table() {
  using Sample = robot::RedundancySample;
  const auto best = [](auto value) {
    return [value](const RotationView& view) {
      const bool found = view.rotation->status == robot::Redundancy::Status::found;
      return found ? std::optional<double>(value(view.rotation->best)) : std::nullopt;
    };
  };
  static const Schema<RotationView> table(
      "spindle_rotation", "what turning the flange about the tool's axis does",
      {key(
           "rotation_deg",
           [](const RotationView& view) {
             std::vector<double> out;
             for (const Sample& sample : view.rotation->samples) out.push_back(sample.gamma_rad);
             return out;
           },
           "each turn"),
       of_turns(
           "deflection_um", [](const Sample& sample) { return sample.error_m.norm(); }, "of the tip"),
       of_turns(
           "along_normal_um", [](const Sample& sample) { return sample.error_along_normal_m; },
           "its part along the surface's normal"),
       of_turns(
           "condition_number", [](const Sample& sample) { return sample.condition_number; }, "of the Jacobian"),
       of_turns(
           "limit_distance_deg", [](const Sample& sample) { return sample.limit_distance_rad; },
           "of the joint nearest to its limit"),
       key("best_deg", best([](const Sample& sample) { return sample.gamma_rad; }), "turn of least deflection")
           .nullable(),
       key("best_deflection_um", best([](const Sample& sample) { return sample.error_m.norm(); }), "there").nullable(),
       key("used_deg", &RotationView::used_rad, "turn of this cut")},
      Use::written);
  return table;
}

const Schema<Simulation>& vibration_table() {
  static const Schema<Simulation> table(
      "cut_vibration", "the same cut in time, with what vibrates",
      {key("verdict", &Simulation::verdict, simulation::verdict_names, "of the last half of the time"),
       key(
           "chatter_frequency_hz", [](const Simulation& s) { return io::if_positive(s.chatter_frequency_hz); },
           "none: stable")
           .nullable(),
       key("chatter_amplitude_um", &Simulation::chatter_amplitude_m, "of that motion"),
       key(
           "spectral_radius",
           [](const Simulation& s) {
             const bool found = s.small.status == simulation::SmallVibration::Status::found;
             return found ? std::optional(s.small.spectral_radius) : std::nullopt;
           },
           "of small vibration")
           .nullable(),
       key("missed_share", &Simulation::missed_share, "of the time in which an edge in the cut touches nothing")
           .nullable(),
       key("error_estimate", &Simulation::error_estimate, "of the displacement, relative").nullable()},
      Use::written);
  return table;
}

/// One revolution with the sign of what is written.
struct RevolutionView {
  const RevolutionForces* revolution = nullptr;
  double sign = 1.0;
  [[nodiscard]] const CuttingForce& force() const { return revolution->deflected.force; }
  [[nodiscard]] bool on_robot() const { return revolution->posture.has_value(); }
};

std::vector<Row<RevolutionView>> revolution_keys() {
  using View = RevolutionView;
  return {
      key(
          "mean_n", [](const View& v) { return Eigen::Vector3d(v.sign * v.force().mean_n); }, "mean in x, y, z")
          .entries(3),
      key(
          "peak_n", [](const View& v) { return Eigen::Vector3d(v.sign * v.force().peak_n); }, "largest, with its sign")
          .entries(3),
      key(
          "rms_n", [](const View& v) { return v.force().rms_n; }, "root mean square")
          .entries(3),
      key(
          "peak_force_n", [](const View& v) { return v.force().peak_force_n; }, "largest magnitude"),
      key(
          "torque_n_m", [](const View& v) { return v.force().mean_torque_n_m; }, "mean"),
      key(
          "peak_torque_n_m", [](const View& v) { return v.force().peak_torque_n_m; }, "largest"),
      key(
          "power_w", [](const View& v) { return v.force().power_w; }, "mean"),
      key(
          "chip_area_mm2", [](const View& v) { return v.force().chip_area_m2; }, "of the cut across the feed"),
      key(
          "patch_area_mm2", [](const View& v) { return cutting::patch_area_m2(v.revolution->deflected.engagement); },
          "of the cutter in the material"),
      key(
          "removal_rate_mm3_per_s", [](const View& v) { return v.force().removal_rate_m3_per_s; }, "material a second"),
      key(
          "missed_share", [](const View& v) { return v.force().missed_share; },
          "of the engaged edge, what cuts nothing because of runout"),
      key(
          "deflection_um",
          [](const View& v) {
            return v.on_robot() ? std::optional(v.revolution->deflected.deflection_m) : std::nullopt;
          },
          "of the tip under the mean force; none: no robot")
          .entries(3)
          .null_list(),
      key(
          "peak_deflection_um",
          [](const View& v) {
            return v.on_robot() ? std::optional(v.revolution->deflected.peak_deflection_m) : std::nullopt;
          },
          "greatest over the revolution; none: no robot")
          .nullable(),
      key(
          "axial_depth_left_mm", [](const View& v) { return v.revolution->deflected.cut.axial_depth_m; },
          "of the deflected tool"),
      key(
          "settled", [](const View& v) { return v.revolution->deflected.status; }, settled_names,
          "whether depth and force agree"),
      key(
          "condition_number",
          [](const View& v) {
            return v.on_robot() ? std::optional(v.revolution->posture->condition_number) : std::nullopt;
          },
          "of the Jacobian; none: no robot")
          .nullable(),
      key(
          "spindle_rotation",
          [](const View& v) {
            const RevolutionForces& r = *v.revolution;
            return r.spindle_rotation ? std::optional(RotationView{&*r.spindle_rotation, r.posture->pose.gamma_rad})
                                      : std::nullopt;
          },
          rotation_table(), "of a robot")
          .nullable(),
      key(
          "vibration", [](const View& v) { return v.revolution->vibration ? &*v.revolution->vibration : nullptr; },
          vibration_table(), "where the dynamics are known")
          .nullable(),
      key(
          "engagement",
          [](const View& v) {
            std::vector<RingView> out;
            const Engagement& engagement = v.revolution->deflected.engagement;
            for (std::size_t i = 0; i < engagement.slices.size(); ++i) out.push_back({&engagement, i});
            return out;
          },
          ring_table(), "rings of the cutter with their angles in the cut"),
      key(
          "rotation_deg", [](const View& v) { return v.force().rotation_rad; }, "of the first tooth at the tip")
          .exact()};
}

/// Forces over the rotation, by axis.
std::vector<Row<RevolutionView>> course_keys() {
  using View = RevolutionView;
  std::vector<Row<View>> rows;
  const auto by_axis = [&rows](const std::string& before, auto force, const char* meaning) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto course = [axis, force](const View& v) {
        return Eigen::VectorXd(v.sign * force(v).row(axis).transpose());
      };
      rows.push_back(key(fmt::format("{}f{}_n", before, "xyz"[axis]), course, meaning).exact());
    }
  };
  by_axis(
      "", [](const View& v) -> const Eigen::Matrix3Xd& { return v.force().force_n; }, "over the rotation");
  rows.push_back(key(
                     "torque_by_rotation_n_m", [](const View& v) { return v.force().torque_n_m; }, "over the rotation")
                     .exact());
  const std::size_t rigid = rows.size();
  by_axis(
      "vibrating_", [](const View& v) -> const Eigen::Matrix3Xd& { return v.revolution->vibrating_force_n; },
      "of the tool that vibrates, over its last revolution");
  for (std::size_t k = rigid; k < rows.size(); ++k) {
    rows[k] = where([](const View& v) { return v.revolution->vibrating_force_n.cols() > 0; }, std::move(rows[k]));
  }
  return rows;
}

// Along a program

/// A number of a block's force.
Row<ForcesLine> of_force(Row<cutting::BlockForce> row) {
  return keys_of<ForcesLine>(std::vector{std::move(row)},
                             [](const ForcesLine& at) -> const cutting::BlockForce& { return at.result->force; })
      .front();
}

/// A number that needs a robot.
template <class F>
Row<ForcesLine> of_robot(std::string name, F value, std::string meaning) {
  return key(
             std::move(name),
             [value](const ForcesLine& at) {
               return at.result->joints.size() > 0 ? std::optional<double>(value(*at.result)) : std::nullopt;
             },
             std::move(meaning))
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
      of_force(key("radial_depth_mm", &BlockForce::radial_depth_m, "greatest, across the feed"))};
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

/// The blocks that cut and their values of a key, those left out of which it is not known.
using Ranked = std::pair<double, ForcesLine>;
std::vector<Ranked> cutting_lines(const ForcesResult& forces, std::string_view name) {
  const auto row = std::ranges::find_if(line_table().rows(), [&](const auto& one) { return one.key.name == name; });
  std::vector<Ranked> out;
  for (const ForcesLine& at : lines_of(forces)) {
    if (!at.result->force.cuts()) continue;
    if (const Json value = row->write(at, *row); value.is_number()) out.emplace_back(value.get<double>(), at);
  }
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
                               const std::vector<Ranked> values = cutting_lines(forces, name);
                               return values.empty()
                                          ? std::nullopt
                                          : std::optional(*std::ranges::max_element(values, {}, &Ranked::first));
                             },
                             highest_table(), "none: no block cuts, or it is not known")
                             .nullable());
        }
        return rows;
      }(),
      Use::written);
  return table;
}

/// The blocks with the highest peak force, the worst first.
std::vector<ForcesLine> worst_lines(const ForcesResult& forces) {
  constexpr std::size_t most = 10;
  std::vector<Ranked> order = cutting_lines(forces, "peak_f_n");
  std::ranges::stable_sort(order, std::ranges::greater(), &Ranked::first);
  order.resize(std::min(order.size(), most));
  std::vector<ForcesLine> out;
  for (const Ranked& one : order) out.push_back(one.second);
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
          "blocks", [](const ForcesResult& result) { return lines_of(result); }, line_table(), "of the program"),
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

std::vector<ForcesLine> lines_of(const ForcesResult& forces) {
  const ProgramForces& program = *forces.program;
  std::vector<ForcesLine> out;
  out.reserve(program.blocks.size());
  double path_m = 0.0, time_s = 0.0;
  for (const BlockResult& row : program.blocks) {
    const program::Block& block = program.program.blocks[row.force.block];
    path_m += (block.end.tip_m - program.program.begin_of(row.force.block).tip_m).norm();
    time_s += block.duration_s;
    out.push_back({.forces = &forces, .result = &row, .path_m = path_m, .time_s = time_s});
  }
  return out;
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
        std::vector<Row<RevolutionView>> revolution = revolution_keys();
        add_rows(revolution, course_keys());
        const auto view = [](const ForcesResult& result) {
          return RevolutionView{&*result.revolution, sign_of(result)};
        };
        for (Row<ForcesResult>& row : keys_of<ForcesResult>(revolution, view)) {
          rows.push_back(
              where([](const ForcesResult& result) { return result.revolution.has_value(); }, std::move(row)));
        }
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
