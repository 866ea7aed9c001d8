#include "robomill/process/files/blocks_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/append.hpp"
#include "robomill/io/json.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/vibration_text.hpp"

namespace robomill::process {
namespace {

using io::Json;
using io::number;

/// One block with all that is known of it.
struct BlockLine {
  std::size_t index;
  const program::Block& block;
  const BlockResult& force;
  const BlockRow& row;
  double feed_m_per_s;
};

/// A column of both documents; null where there is none.
struct BlockColumn {
  std::string name;
  std::function<Json(const BlockLine&)> value;
  bool always = false;  ///< also of blocks that do not cut
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

using BlockNumber = double (*)(const BlockLine&);

std::vector<BlockColumn> place_columns(Eigen::Index joints) {
  std::vector<BlockColumn> columns = {
      {"block", [](const BlockLine& r) { return Json(r.index + 1); }, true},
      {"line", [](const BlockLine& r) { return Json(r.block.line); }, true},
      {"x_mm", [](const BlockLine& r) { return number(r.block.end.tip_m.x() / units::mm); }, true},
      {"y_mm", [](const BlockLine& r) { return number(r.block.end.tip_m.y() / units::mm); }, true},
      {"z_mm", [](const BlockLine& r) { return number(r.block.end.tip_m.z() / units::mm); }, true},
  };
  for (Eigen::Index k = 0; k < joints; ++k) {
    columns.push_back({fmt::format("q{}", k + 1), [k](const BlockLine& r) { return number(r.force.joints(k)); }, true});
  }
  return columns;
}

/// Columns of numbers in a shop's units, NaN and infinity: none.
constexpr std::pair<const char*, BlockNumber> of_stability[] = {
    {"axial_depth_mm", [](const BlockLine& r) { return r.row.axial_depth_m / units::mm; }},
    {"radial_depth_mm", [](const BlockLine& r) { return r.row.radial_depth_m / units::mm; }},
    {"spindle_speed_rpm", [](const BlockLine& r) { return r.row.spindle_speed_rad_per_s / units::rpm; }},
    {"feed_mm_per_min", [](const BlockLine& r) { return r.feed_m_per_s / units::mm * units::minute; }},
    {"spectral_radius", [](const BlockLine& r) { return r.row.stability.at.spectral_radius; }},
    {"limit_depth_mm", [](const BlockLine& r) { return r.row.stability.at.limit_depth_m / units::mm; }},
    {"stability_margin", [](const BlockLine& r) { return r.row.stability_margin; }},
    {"chatter_frequency_hz", [](const BlockLine& r) { return r.row.stability.chatter_frequency_hz(); }},
};
constexpr std::pair<const char*, BlockNumber> of_load[] = {
    {"peak_f_n", [](const BlockLine& r) { return r.force.force.peak_force_n; }},
    {"torque_n_m", [](const BlockLine& r) { return r.force.force.mean_torque_n_m; }},
    {"power_w", [](const BlockLine& r) { return r.force.force.power_w; }},
    {"deflection_um", [](const BlockLine& r) { return r.force.deflection_m.norm() / units::um; }},
    {"surface_error_um", [](const BlockLine& r) { return r.row.steady.surface_error_m / units::um; }},
    {"surface_left_um", [](const BlockLine& r) { return r.row.surface_left_m / units::um; }},
    {"gain_margin", [](const BlockLine& r) { return r.row.stability.at.gain_margin; }},
    {"limit_5_percent_mm", [](const BlockLine& r) { return r.row.stability.limit_5_percent_m / units::mm; }},
    {"limit_95_percent_mm", [](const BlockLine& r) { return r.row.stability.limit_95_percent_m / units::mm; }},
    {"condition_number", [](const BlockLine& r) { return r.force.condition_number; }},
    {"joint_torque_share", [](const BlockLine& r) { return r.row.joint_torque_share; }},
    {"cut_joint_torque_n_m", [](const BlockLine& r) { return r.row.cut_joint_torque_n_m; }},
    {"vibration_um", [](const BlockLine& r) { return r.row.steady.vibration.amplitude_m / units::um; }},
};

std::vector<BlockColumn> block_columns(const ForcesResult& forces) {
  std::vector<BlockColumn> columns = place_columns(forces.program->blocks.front().joints.size());
  const auto add = [&columns](const auto& list) {
    for (const auto& [name, get] : list) {
      columns.push_back({name, [value = get](const BlockLine& r) { return number(value(r)); }});
    }
  };
  add(of_stability);
  columns.push_back({"mode", [](const BlockLine& r) {
                       const modal::ModeId mode = r.row.stability.mode();
                       return mode.known() ? Json(to_string(mode)) : Json();
                     }});
  columns.push_back({"regime", [](const BlockLine& r) { return Json(to_string(r.row.stability.regime)); }});
  add(of_load);
  columns.push_back({"lower_bound", [](const BlockLine& r) { return Json(r.row.stability.lower_bound); }});
  columns.push_back({"measured_nearby",
                     [](const BlockLine& r) { return r.row.measured_nearby ? Json(*r.row.measured_nearby) : Json(); }});
  columns.push_back({"evaluation", [](const BlockLine& r) { return Json(r.row.evaluation + 1); }});
  columns.push_back({"note",
                     [](const BlockLine& r) {
                       return block_note(r.force, r.row).empty() ? Json() : Json(block_note(r.force, r.row));
                     },
                     true});
  return columns;
}

/// Calls f with each block.
template <class F>
void each_block(const ForcesResult& forces, const ProgramBlocks& blocks, F&& f) {
  const program::Program& program = forces.program->program;
  for (std::size_t i = 0; i < blocks.rows.size(); ++i) {
    const program::Block& block = program.blocks[i];
    const double way_m = (block.end.tip_m - program.begin_of(i).tip_m).norm();
    f(BlockLine{.index = i,
                .block = block,
                .force = forces.program->blocks[i],
                .row = blocks.rows[i],
                .feed_m_per_s = block.duration_s > 0.0 ? way_m / block.duration_s : 0.0});
  }
}

Json block_cell(const BlockColumn& column, const BlockLine& row) {
  return column.always || row.row.cuts ? column.value(row) : Json();
}

void append_block_cell(std::string& text, const Json& cell) {
  if (cell.is_null()) return;
  if (cell.is_string()) {
    io::append(text, "\"{}\"", cell.get_ref<const std::string&>());
  } else if (cell.is_boolean()) {
    text += cell.get<bool>() ? "true" : "false";
  } else if (cell.is_number_float()) {
    io::append(text, "{:.9g}", cell.get<double>());
  } else {
    io::append(text, "{}", cell.get<std::size_t>());
  }
}

Json scans_json(const ForcesResult& forces, const ProgramBlocks& blocks) {
  Json list = Json::array();
  for (const LimitScan& scan : blocks.scans) {
    const double unit = scan.parameter.ends_with("_deg") ? units::deg : units::mm;
    Json value = Json::array();
    Json limit = Json::array();
    for (const double v : scan.value) value.push_back(number(v / unit));
    for (const double depth_m : scan.limit_m) limit.push_back(number(depth_m / units::mm));
    list.push_back({{"parameter", scan.parameter},
                    {"value", std::move(value)},
                    {"limit_depth_mm", std::move(limit)},
                    {"at_block", blocks.worst + 1},
                    {"at_line", forces.program->program.blocks[blocks.worst].line}});
  }
  return list;
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

Json blocks_summary(const ForcesResult& forces, const ProgramBlocks& blocks) {
  Json worst;
  if (blocks.cutting > 0) {
    const BlockRow& row = blocks.rows[blocks.worst];
    worst = {{"block", blocks.worst + 1},
             {"line", forces.program->program.blocks[blocks.worst].line},
             {"axial_depth_mm", number(row.axial_depth_m / units::mm)},
             {"limit_depth_mm", number(row.stability.at.limit_depth_m / units::mm)},
             {"stability_margin", number(row.stability_margin)},
             {"gain_margin", number(row.stability.at.gain_margin)},
             {"regime", to_string(row.stability.regime)}};
  }
  std::vector<std::string> notes = block_warnings(forces, blocks);
  std::ranges::move(block_notes(blocks), std::back_inserter(notes));
  const auto lost = std::ranges::count_if(
      forces.program->blocks, [](const BlockResult& block) { return block.settled == BlockResult::Settled::lost; });
  return {{"engagement_lost", lost},     {"blocks", blocks.rows.size()},      {"cutting", blocks.cutting},
          {"unstable", blocks.unstable}, {"evaluations", blocks.evaluations}, {"seconds", number(blocks.seconds)},
          {"worst", std::move(worst)},   {"notes", std::move(notes)}};
}

std::string blocks_csv(const ForcesResult& forces, const ProgramBlocks& blocks) {
  const std::vector<BlockColumn> columns = block_columns(forces);
  std::string text;
  for (const BlockColumn& column : columns) text += (text.empty() ? "" : ",") + column.name;
  text += '\n';
  each_block(forces, blocks, [&](const BlockLine& row) {
    for (const BlockColumn& column : columns) {
      if (&column != &columns.front()) text += ',';
      append_block_cell(text, block_cell(column, row));
    }
    text += '\n';
  });
  return text;
}

Json blocks_object(const ForcesResult& forces, const ProgramBlocks& blocks) {
  const std::vector<BlockColumn> columns = block_columns(forces);
  std::vector<Json> lists(columns.size(), Json::array());
  each_block(forces, blocks, [&](const BlockLine& row) {
    for (std::size_t k = 0; k < columns.size(); ++k) lists[k].push_back(block_cell(columns[k], row));
  });
  Json by_column = Json::object();
  for (std::size_t k = 0; k < columns.size(); ++k) by_column[columns[k].name] = std::move(lists[k]);
  return {{"blocks", std::move(by_column)},
          {"summary", blocks_summary(forces, blocks)},
          {"limit_over", scans_json(forces, blocks)}};
}

std::string blocks_json(const ForcesResult& forces, const ProgramBlocks& blocks) {
  return io::dump(blocks_object(forces, blocks));
}

}  // namespace robomill::process
