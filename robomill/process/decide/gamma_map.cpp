#include "robomill/process/decide/gamma_map.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"

namespace robomill::process {
namespace {

constexpr std::size_t most_map_points = 400;
/// Steps of γ to each side where γ is not free.
constexpr double map_step_rad = 30.0 * units::deg;
constexpr int map_steps = 3;

/// A class of a way at a speed: blocks that share a column.
struct MapColumn {
  const WayModel* way = nullptr;
  std::size_t look_class = 0;
  double spindle_speed_rad_per_s = 0.0;
};

}  // namespace

std::vector<std::size_t> map_columns(const std::vector<std::size_t>& cutting) {
  const std::size_t stride = std::max<std::size_t>(1, (cutting.size() + most_map_points - 1) / most_map_points);
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < cutting.size(); k += stride) out.push_back(cutting[k]);
  return out;
}

GammaMap gamma_map(const DecideProblem& problem, const BlockModel& model, const decision::ProgramDecision* choice,
                   const DecideResult& result, Progress& progress) {
  GammaMap out;
  out.least_margin = problem.machine.depth_margin;
  std::vector<double>& gamma = out.gamma_rad;
  gamma = model.search().gamma_rad;
  if (gamma.size() < 2) {
    gamma.clear();
    for (int k = -map_steps; k <= map_steps; ++k) gamma.push_back(k * map_step_rad);
  }
  const program::Program& program = (result.forces ? *result.forces : problem.forces).program->program;
  std::vector<std::size_t> cutting;
  const std::vector<double> way = ways_m(program);
  const auto way_of = [&](std::size_t block) -> const WayModel& {
    return choice != nullptr ? model.way_at(*choice, block) : model.as_programmed();
  };
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    if (problem.blocks.rows[i].cuts && way_of(i).class_of(i)) cutting.push_back(i);
  }
  out.block = map_columns(cutting);
  std::map<std::tuple<const WayModel*, std::size_t, double>, std::size_t> known;
  std::vector<MapColumn> columns;
  std::vector<std::size_t> column_of;
  for (const std::size_t block : out.block) {
    const MapColumn column = {.way = &way_of(block),
                              .look_class = *way_of(block).class_of(block),
                              .spindle_speed_rad_per_s = result.blocks
                                                             ? program.blocks[block].spindle_speed_rad_per_s
                                                             : problem.blocks.rows[block].spindle_speed_rad_per_s};
    const auto [at, fresh] =
        known.emplace(std::tuple(column.way, column.look_class, column.spindle_speed_rad_per_s), columns.size());
    if (fresh) columns.push_back(column);
    column_of.push_back(at->second);
  }
  Eigen::MatrixXd margin(std::ssize(gamma), std::ssize(columns));
  progress.start("map of γ", columns.size() * gamma.size());
  parallel_for(columns.size() * gamma.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const MapColumn& column = columns[i / gamma.size()];
      margin(static_cast<Eigen::Index>(i % gamma.size()), static_cast<Eigen::Index>(i / gamma.size())) =
          column.way->margin(column.look_class, column.spindle_speed_rad_per_s, gamma[i % gamma.size()]);
      progress.advance();
    }
  });
  out.margin.resize(std::ssize(gamma), std::ssize(out.block));
  for (std::size_t k = 0; k < out.block.size(); ++k) {
    out.margin.col(static_cast<Eigen::Index>(k)) = margin.col(static_cast<Eigen::Index>(column_of[k]));
    out.path_m.push_back(way[out.block[k] + 1]);
    out.chosen_rad.push_back(result.gamma_offset_rad.empty() ? 0.0 : result.gamma_offset_rad[out.block[k] + 1]);
  }
  return out;
}

}  // namespace robomill::process
