#include "robomill/process/files/blocks_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/cutting/files/cut_schema.hpp"
#include "robomill/io/columns.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/vibration_text.hpp"

namespace robomill::process {
namespace {

using io::add_rows;
using io::columns_key;
using io::Json;
using io::key;
using io::Row;
using io::Schema;
using io::Use;

/// One block with all that is known of it.
struct BlockLine {
  std::size_t index = 0;
  const program::Block* block = nullptr;
  const BlockResult* force = nullptr;
  const BlockRow* row = nullptr;
  double feed_m_per_s = 0.0;
};

/// Warnings of stretches beyond these are counted.
constexpr std::size_t most_stretches = 8;
/// A limit whose 95 % quantile is this multiple of the 5 % one is hardly known.
constexpr double hardly_known = 4.0;

std::string chatter_warning(const ForcesResult& forces, const ProgramBlocks& blocks) {
  const BlockRow& row = blocks.rows[blocks.worst];
  std::string text =
      fmt::format("{} of {} blocks that cut are predicted to chatter; the worst is {}: {:.4g} mm deep", blocks.unstable,
                  blocks.cutting, named_block(forces, blocks.worst), row.axial_depth_m / units::mm);
  if (row.stability.limited()) {
    text += fmt::format(" at a limit of {:.4g} mm", row.stability.at.limit_depth_m / units::mm);
  }
  return text + fmt::format(", {} chatter of {} at {:.4g} Hz.", to_string(row.stability.regime),
                            to_string(row.stability.mode()), row.stability.chatter_frequency_hz());
}

/// Empty: the tip of no block vibrates by more than the feed per tooth.
std::string vibration_warning(const ForcesResult& forces, const ProgramBlocks& blocks) {
  const auto share = [](const BlockRow& row) { return row.cuts ? row.steady.vibration_share : unknown; };
  const auto count = std::ranges::count_if(blocks.rows, [&](const BlockRow& row) { return share(row) > 1.0; });
  if (count == 0) return {};
  std::size_t worst = 0;
  for (std::size_t i = 1; i < blocks.rows.size(); ++i) {
    if (!(share(blocks.rows[i]) <= share(blocks.rows[worst])) && share(blocks.rows[i]) > 0.0) worst = i;
  }
  const SteadyMotion& steady = blocks.rows[worst].steady;
  return fmt::format(
      "In {} of {} blocks that cut forced vibration exceeds the feed per tooth: teeth leave the cut and meet it again, "
      "which neither force nor stability describe. In {}, the worst, {}.",
      count, blocks.cutting, named_block(forces, worst), vibration_text(steady.vibration, steady.vibration_share));
}

std::string unmatched_warning(const ForcesResult& forces, const ProgramBlocks& blocks, std::size_t first) {
  const auto count = std::ranges::count_if(blocks.rows, [](const BlockRow& row) { return row.unmatched > 0; });
  return fmt::format(
      "In {} blocks, the first {}, modes of the nearest measured posture have no counterpart in the others ({} there) "
      "and are left out: the limits are too deep where these would chatter.",
      count, named_block(forces, first), blocks.rows[first].unmatched);
}

std::string beyond_warning(const ForcesResult& forces, const BeyondMeasured& stretch, double band_within) {
  std::string text = stretch.first == stretch.last ? fmt::format("In {}", named_block(forces, stretch.first))
                                                   : fmt::format("From {} to {}", named_block(forces, stretch.first),
                                                                 named_block(forces, stretch.last));
  text += fmt::format(" the robot stands up to {:.3g}° of a joint from the nearest measured posture",
                      stretch.farthest_rad / units::deg);
  if (stretch.band > 0.0) {
    text += fmt::format("; the 5 to 95 % band of the limit is up to {:.0f} % of it", 100.0 * stretch.band);
    if (band_within > 0.0) {
      text += fmt::format(" (median within the measured region: {:.0f} %)", 100.0 * band_within);
    }
  }
  return text + ".";
}

/// The same key, null of a block that does not cut.
Row<BlockLine> while_cutting(Row<BlockLine> row) {
  row.key.nullable = true;
  row.write = [write = std::move(row.write)](const BlockLine& at, const Row<BlockLine>& self) {
    return at.row->cuts ? write(at, self) : Json();
  };
  return row;
}

std::vector<Row<BlockLine>> block_place_keys() {
  std::vector<Row<BlockLine>> rows = {
      key(
          "block", [](const BlockLine& at) { return at.index + 1; }, "number in the program, from 1"),
      key(
          "line", [](const BlockLine& at) { return at.block->line; }, "of the program's file"),
      key(
          "x_mm", [](const BlockLine& at) { return at.block->end.tip_m.x(); }, "of the tip at its end"),
      key(
          "y_mm", [](const BlockLine& at) { return at.block->end.tip_m.y(); }, "the same"),
      key(
          "z_mm", [](const BlockLine& at) { return at.block->end.tip_m.z(); }, "the same")};
  constexpr Eigen::Index most_joints = 6;
  for (Eigen::Index k = 0; k < most_joints; ++k) {
    rows.push_back(where([k](const BlockLine& at) { return at.force->joints.size() > k; },
                         key(
                             fmt::format("q{}", k + 1), [k](const BlockLine& at) { return at.force->joints(k); },
                             "position of the joint at its end, in rad or m")));
  }
  return rows;
}

std::vector<Row<BlockLine>> block_stability_keys() {
  return {
      key(
          "axial_depth_mm", [](const BlockLine& at) { return at.row->axial_depth_m; },
          "of the engaged part along the tool's axis, where most of the cutter is in the material"),
      key(
          cutting::radial_depth_key, [](const BlockLine& at) { return at.row->radial_depth_m; },
          "the same across the feed"),
      key(
          "spindle_speed_rpm", [](const BlockLine& at) { return at.row->spindle_speed_rad_per_s; }, "spindle speed"),
      key(
          "feed_mm_per_min", [](const BlockLine& at) { return at.feed_m_per_s / units::mm * units::minute; },
          "mean of the block")
          .in_unit(),
      key(
          "spectral_radius", [](const BlockLine& at) { return at.row->stability.at.spectral_radius; },
          "of one tooth period, of one revolution for unequal teeth; from 1 on the block chatters"),
      key(
          "limit_depth_mm", [](const BlockLine& at) { return at.row->stability.at.limit_depth_m; },
          "lowest unstable depth from a sixteenth to eight times the depth; none: none"),
      key(
          "stability_margin", [](const BlockLine& at) { return at.row->stability_margin; },
          "1 - depth / limit, with the 5 % quantile of the limit"),
      key(
          "chatter_frequency_hz", [](const BlockLine& at) { return at.row->stability.chatter_frequency_hz(); },
          "at the limit; without one, of the least damped motion"),
      key(
          "mode",
          [](const BlockLine& at) {
            const modal::ModeId mode = at.row->stability.mode();
            return mode.known() ? to_string(mode) : std::string();
          },
          "that moves most there"),
      key(
          "regime", [](const BlockLine& at) { return at.row->stability.regime; }, stability::regime_names,
          "what makes the cut unstable at the limit")};
}

std::vector<Row<BlockLine>> block_load_keys() {
  return {key(
              "peak_f_n", [](const BlockLine& at) { return at.force->force.peak_force_n; }, "largest force"),
          key(
              "torque_n_m", [](const BlockLine& at) { return at.force->force.mean_torque_n_m; }, "mean"),
          key(
              "power_w", [](const BlockLine& at) { return at.force->force.power_w; }, "mean"),
          key(
              "deflection_um", [](const BlockLine& at) { return at.force->deflection_m.norm(); },
              "of the tip under the mean force"),
          key(
              "surface_error_um", [](const BlockLine& at) { return at.row->steady.surface_error_m; },
              "greatest error of the steady vibration on all that the pass leaves, along the normal; positive: "
              "material is left"),
          key(
              "surface_left_um", [](const BlockLine& at) { return at.row->surface_left_m; },
              "the same of the finished surface, which no later block takes away"),
          key(
              "gain_margin", [](const BlockLine& at) { return at.row->stability.at.gain_margin; },
              "smallest factor on the cutting stiffness at which the radius is 1"),
          key(
              "limit_5_percent_mm", [](const BlockLine& at) { return at.row->stability.limit_5_percent_m; },
              "quantile of the limit"),
          key(
              "limit_95_percent_mm", [](const BlockLine& at) { return at.row->stability.limit_95_percent_m; },
              "quantile of the limit"),
          key(
              "condition_number", [](const BlockLine& at) { return at.force->condition_number; },
              "of the Jacobian at its end"),
          key(
              "joint_torque_share", [](const BlockLine& at) { return at.row->joint_torque_share; },
              "greatest share of a drive's torque limit, weight and cut; none: no limit, or unknown masses"),
          key(
              "cut_joint_torque_n_m", [](const BlockLine& at) { return at.row->cut_joint_torque_n_m; },
              "the greatest that the cut alone puts on a joint that turns"),
          key(
              "vibration_um", [](const BlockLine& at) { return at.row->steady.vibration.amplitude_m; },
              "forced vibration: half the peak to peak of the tip about its mean, where that is greatest"),
          key(
              "lower_bound", [](const BlockLine& at) { return at.row->stability.lower_bound; },
              "process damping, which is not known, raises the limit"),
          key(
              "measured_nearby", [](const BlockLine& at) { return at.row->measured_nearby; },
              "the robot stands within the measured region; none: no measured postures"),
          key(
              "evaluation", [](const BlockLine& at) { return at.row->evaluation + 1; },
              "number of the evaluation that the block shares with those like it")};
}

const io::Columns<BlockLine>& block_columns() {
  static const Schema<BlockLine> rows(
      "block_columns", "a list a key, an entry a block; null of a block that does not cut",
      [] {
        std::vector<Row<BlockLine>> all = block_place_keys();
        for (Row<BlockLine>& row : block_stability_keys()) all.push_back(while_cutting(std::move(row)));
        for (Row<BlockLine>& row : block_load_keys()) all.push_back(while_cutting(std::move(row)));
        all.push_back(key(
                          "note", [](const BlockLine& at) { return block_note(*at.force, *at.row); },
                          "what is to be known of its numbers")
                          .nullable());
        return all;
      }(),
      Use::written);
  static const io::Columns<BlockLine> columns(rows);
  return columns;
}

std::vector<BlockLine> block_lines(const BlocksView& view) {
  const program::Program& program = view.forces->program->program;
  std::vector<BlockLine> out;
  out.reserve(view.blocks->rows.size());
  for (std::size_t i = 0; i < view.blocks->rows.size(); ++i) {
    const program::Block& block = program.blocks[i];
    const double way_m = (block.end.tip_m - program.begin_of(i).tip_m).norm();
    out.push_back({.index = i,
                   .block = &block,
                   .force = &view.forces->program->blocks[i],
                   .row = &view.blocks->rows[i],
                   .feed_m_per_s = block.duration_s > 0.0 ? way_m / block.duration_s : 0.0});
  }
  return out;
}

/// A scan around the worst block.
struct ScanView {
  const LimitScan* scan = nullptr;
  std::size_t block = 0, line = 0;
  [[nodiscard]] double unit() const { return scan->parameter.ends_with("_deg") ? units::deg : units::mm; }
};

const Schema<ScanView>& scan_table() {
  static const Schema<ScanView> table(
      "limit_scan", "the limit over one coordinate of the tool's pose, around the worst block",
      {key(
           "parameter", [](const ScanView& at) { return at.scan->parameter; }, "which coordinate")
           .words({"x_mm", "y_mm", "z_mm", "gamma_deg"}),
       key(
           "value",
           [](const ScanView& at) {
             std::vector<double> out = at.scan->value;
             for (double& value : out) value /= at.unit();
             return out;
           },
           "of it, in the unit of its name"),
       key(
           "limit_depth_mm", [](const ScanView& at) { return at.scan->limit_m; },
           "none: no limit, or the robot cannot stand there")
           .nullable(),
       key(
           "at_block", [](const ScanView& at) { return at.block + 1; }, "the worst block"),
       key(
           "at_line", [](const ScanView& at) { return at.line; }, "its line")},
      Use::written);
  return table;
}

/// The worst block of those that cut.
const Schema<BlockLine>& worst_table() {
  const auto named = [](const std::vector<Row<BlockLine>>& from, std::initializer_list<std::string_view> names) {
    std::vector<Row<BlockLine>> out;
    for (const std::string_view name : names)
      out.push_back(*std::ranges::find_if(from, [&](const Row<BlockLine>& row) { return row.key.name == name; }));
    for (Row<BlockLine>& row : out) row.key.nullable = row.key.holds == io::Holds::number;
    return out;
  };
  static const Schema<BlockLine> table(
      "worst_block", "the block nearest to chatter, of those that cut",
      [&] {
        std::vector<Row<BlockLine>> rows = named(block_place_keys(), {"block", "line"});
        add_rows(rows, named(block_stability_keys(), {"axial_depth_mm", "limit_depth_mm", "stability_margin"}));
        add_rows(rows, named(block_load_keys(), {"gain_margin"}));
        add_rows(rows, named(block_stability_keys(), {"regime"}));
        return rows;
      }(),
      Use::written);
  return table;
}

}  // namespace

std::string block_note(const BlockResult& force, const BlockRow& row) {
  if (force.settled == BlockResult::Settled::lost) return "engagement lost";
  if (!row.cuts) return {};
  if (force.settled == BlockResult::Settled::unsettled) return "deflection does not settle";
  if (row.stability.below_range()) return "unstable at the least depth that was looked at: the limit is no higher";
  if (row.stability.limit_95_percent_m > hardly_known * row.stability.limit_5_percent_m) {
    return "the limit is hardly known: see its 5 and 95 % quantiles";
  }
  if (row.stability.lower_bound) return "limit is a lower bound: process damping is not known";
  if (!row.stability.limited()) {
    return fmt::format("no limit up to {:.4g} mm", row.stability.searched_depth_m[1] / units::mm);
  }
  return {};
}

std::vector<std::string> block_warnings(const ForcesResult& forces, const ProgramBlocks& blocks) {
  std::vector<std::string> out;
  if (blocks.unstable > 0) out.push_back(chatter_warning(forces, blocks));
  if (std::string text = vibration_warning(forces, blocks); !text.empty()) out.push_back(std::move(text));
  if (const auto unmatched = std::ranges::find_if(blocks.rows, [](const BlockRow& row) { return row.unmatched > 0; });
      unmatched != blocks.rows.end()) {
    out.push_back(unmatched_warning(forces, blocks, static_cast<std::size_t>(unmatched - blocks.rows.begin())));
  }
  for (std::size_t i = 0; i < std::min(most_stretches, blocks.beyond.size()); ++i) {
    out.push_back(beyond_warning(forces, blocks.beyond[i], blocks.band_within));
  }
  if (blocks.beyond.size() > most_stretches) {
    out.push_back(fmt::format("{} more stretches leave the measured postures.", blocks.beyond.size() - most_stretches));
  }
  return out;
}

std::vector<std::string> block_notes(const ProgramBlocks& blocks) {
  std::vector<std::string> out;
  const auto bounds = std::ranges::count_if(blocks.rows, [](const BlockRow& row) { return row.stability.lower_bound; });
  if (bounds > 0) {
    out.push_back(fmt::format(
        "{} a lower bound: process damping, which is not known, lifts limits at low speed.",
        bounds == 1 ? "The limit of one block is" : fmt::format("The limit of each of {} blocks is", bounds)));
  }
  const auto with_error = [](const BlockRow& row) { return std::isfinite(row.steady.surface_error_m); };
  const auto with_left = [](const BlockRow& row) { return std::isfinite(row.surface_left_m); };
  if (std::ranges::any_of(blocks.rows, with_error) && std::ranges::none_of(blocks.rows, with_left)) {
    out.emplace_back(
        "What blocks leave of the finished surface is not known: surface_error_um counts what later passes take away.");
  }
  if (blocks.rigid_workpiece) {
    out.emplace_back(
        "The workpiece is taken as rigid in the blocks: the structure that the files give it takes no part. A thin "
        "part has lower limits than these.");
  }
  return out;
}

const Schema<BlocksView>& blocks_summary_table() {
  static const Schema<BlocksView> table(
      "blocks_summary", "how many blocks there are, how many chatter, and the worst",
      {key(
           "engagement_lost",
           [](const BlocksView& view) {
             return std::ranges::count_if(view.forces->program->blocks, [](const BlockResult& block) {
               return block.settled == BlockResult::Settled::lost;
             });
           },
           "blocks in which the tool is pushed out of the cut"),
       key(
           "blocks", [](const BlocksView& view) { return view.blocks->rows.size(); }, "of the program"),
       key(
           "cutting", [](const BlocksView& view) { return view.blocks->cutting; }, "that cut"),
       key(
           "unstable", [](const BlocksView& view) { return view.blocks->unstable; }, "predicted to chatter"),
       key(
           "evaluations", [](const BlocksView& view) { return view.blocks->evaluations; }, "different cuts computed"),
       key(
           "seconds", [](const BlocksView& view) { return view.blocks->seconds; }, "computing time"),
       key(
           "worst",
           [](const BlocksView& view) {
             return view.blocks->cutting > 0 ? std::optional(block_lines(view)[view.blocks->worst]) : std::nullopt;
           },
           worst_table(), "none: no block cuts")
           .nullable(),
       key(
           "notes",
           [](const BlocksView& view) {
             std::vector<std::string> notes = block_warnings(*view.forces, *view.blocks);
             std::ranges::move(block_notes(*view.blocks), std::back_inserter(notes));
             return notes;
           },
           "sentences for the user")},
      Use::written);
  return table;
}

const Schema<BlocksView>& blocks_table() {
  static const Schema<BlocksView> table(
      "blocks", "stability of every block of a program",
      {columns_key(
           "blocks", [](const BlocksView& view) { return block_lines(view); }, block_columns(), "by columns"),
       key(
           "summary", [](const BlocksView& view) { return &view; }, blocks_summary_table(), "of the program"),
       key(
           "limit_over",
           [](const BlocksView& view) {
             const std::size_t worst = view.blocks->worst;
             std::vector<ScanView> out;
             for (const LimitScan& scan : view.blocks->scans)
               out.push_back({&scan, worst, view.forces->program->program.blocks[worst].line});
             return out;
           },
           scan_table(), "scans of the limit around the worst block")},
      Use::written, 1);
  return table;
}

std::string blocks_csv(const ForcesResult& forces, const ProgramBlocks& blocks) {
  return block_columns().csv(block_lines({&forces, &blocks}));
}

std::string blocks_json(const ForcesResult& forces, const ProgramBlocks& blocks) {
  return io::dump(blocks_table().write({&forces, &blocks}));
}

}  // namespace robomill::process
