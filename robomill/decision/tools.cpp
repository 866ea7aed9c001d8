#include "robomill/decision/tools.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/coupling/prediction.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/decision/choose.hpp"
#include "robomill/modal/fit.hpp"

namespace robomill::decision {
namespace {

/// The cut with this tool.
ToolCut with_tool(ToolCut cut, const ToolResult& tool) {
  cutting::Milling& milling = cut.problem.milling;
  milling.tool.teeth = tool.teeth;
  milling.tool.diameter_m = tool.diameter_m;
  if (cut.direction) {
    if (*cut.direction == cutting::MillingDirection::slot) cut.radial_depth_m = tool.diameter_m;
    milling.immersion = cutting::immersion(*cut.direction, cut.radial_depth_m, tool.diameter_m);
  } else {
    cut.radial_depth_m = cutting::radial_depth(milling.immersion, tool.diameter_m);
  }
  milling.validate();
  return cut;
}

void find_peak(ToolResult& out) {
  Eigen::Index line = 0;
  out.peak_m_per_n = out.tip.find(modal::parse_frf_name("xx"))->receptance.cwiseAbs().maxCoeff(&line);
  out.peak_hz = out.tip.frequency_hz(line);
}

void fit(ToolResult& out, std::uint64_t seed) {
  modal::FitOptions options;
  options.seed = seed;
  const modal::FitResult found = coupling::fit_tip(out.tip, options, Progress::none());
  out.modes = found.model;
  out.fit_error = found.relative_error;
  out.notes.insert(out.notes.end(), found.warnings.begin(), found.warnings.end());
  if (found.status == modal::FitResult::Status::not_converged) {
    out.notes.emplace_back("The fit of the modes did not converge");
  }
  if (!found.usable()) out.no_cut = "Its modes do not describe its FRFs: no cut is computed from them";
}

void find_best(ToolCut cut, ToolResult& out) {
  cut = with_tool(std::move(cut), out);
  cut.problem.dynamics = out.modes;
  cut.problem.keep_modes.clear();
  const Eigen::VectorXd axis = Eigen::VectorXd::LinSpaced(cut.options.grid[0], cut.options.spindle_speed_rad_per_s[0],
                                                          cut.options.spindle_speed_rad_per_s[1]);
  const std::vector<stability::Limit> limits =
      stability::limit_depths(cut.problem, cut.options, {axis.begin(), axis.end()});
  for (const stability::Limit& limit : limits) {
    if (limit.status != stability::Limit::Status::found) continue;
    out.lowest_limit_m = std::min(out.lowest_limit_m.value_or(limit.axial_depth_m), limit.axial_depth_m);
  }
  out.recommendation = choose(cut.problem, cut.options, limits, {.radial_depth_m = cut.radial_depth_m});
}

void try_tool(coupling::Assembly assembly, const Eigen::VectorXd& frequency_hz, const coupling::ListedTool& tool,
              const std::optional<ToolCut>& cut, std::uint64_t seed, ToolResult& out) {
  assembly.tool = tool.segments;
  coupling::TipResult tip = coupling::tip_frfs(assembly, frequency_hz);
  out.tip = std::move(tip.frfs);
  out.notes = std::move(tip.notes);
  out.suspect_lines = tip.suspect_hz.size();
  find_peak(out);
  fit(out, seed);
  if (!cut || !out.no_cut.empty()) return;
  if (out.teeth == 0) out.teeth = cut->problem.milling.tool.teeth;
  try {
    find_best(*cut, out);
  } catch (const InvalidInput& error) {
    out.lowest_limit_m.reset();
    out.no_cut = error.what();
  }
}

/// A tool that cuts is held, and carries no accelerometer.
void require_cutting(const coupling::Assembly& assembly) {
  if (assembly.holder.free) {
    throw InvalidInput("holder.free", "must not be true where tools are to cut",
                       "A tool that cuts is held by something");
  }
  if (assembly.accelerometer.mass_kg > 0.0) {
    throw InvalidInput("accelerometer.mass_kg", assembly.accelerometer.mass_kg, "kg",
                       "must be 0 where tools are to cut", "A tool that cuts carries no accelerometer");
  }
}

}  // namespace

std::vector<ToolResult> try_tools(const coupling::Assembly& assembly, const Eigen::VectorXd& frequency_hz,
                                  const std::vector<coupling::ListedTool>& tools, const std::optional<ToolCut>& cut,
                                  std::uint64_t seed, Progress& progress) {
  if (tools.empty()) throw InvalidInput("tools", "holds no tool");
  require_cutting(assembly);
  std::vector<ToolResult> out(tools.size());
  progress.start("tools", tools.size());
  parallel_for(tools.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      progress.check();
      ToolResult& row = out[i];
      row.name = tools[i].name;
      row.teeth = tools[i].teeth;
      row.diameter_m = tools[i].segments.front().diameter_m;
      for (const coupling::Segment& segment : tools[i].segments) row.overhang_m += segment.length_m;
      try {
        try_tool(assembly, frequency_hz, tools[i], cut, seed, row);
      } catch (const InvalidInput& error) {
        row.failure = error.what();
      }
      progress.advance();
    }
  });
  return out;
}

}  // namespace robomill::decision
