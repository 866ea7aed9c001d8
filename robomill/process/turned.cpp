#include "robomill/process/turned.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/blocks/stand_at.hpp"
#include "robomill/process/decide/collisions.hpp"
#include "robomill/process/decide/gamma_map.hpp"
#include "robomill/process/decide/units.hpp"
#include "robomill/process/decide/way_model.hpp"
#include "robomill/process/program_forces.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::process {
namespace {

/// γ that differs by no more is the judged one: such a block keeps its joints to the last bit.
constexpr double same_gamma_rad = 1e-9;
/// A joint that goes further into a block than as judged, by that and the turn itself, changes the way to stand.
constexpr double other_way_rad = 90.0 * units::deg;

void check_asked(const std::vector<GammaKnot>& gamma) {
  if (gamma.empty()) throw InvalidInput("gamma", "must have a knot");
  for (std::size_t k = 0; k < gamma.size(); ++k) {
    if (!std::isfinite(gamma[k].path_m)) throw InvalidInput("path_m", gamma[k].path_m, "m", "must be finite");
    if (!std::isfinite(gamma[k].gamma_rad))
      throw InvalidInput("gamma_rad", gamma[k].gamma_rad, "rad", "must be finite");
    if (k > 0 && !(gamma[k].path_m > gamma[k - 1].path_m)) {
      throw InvalidInput("path_m", gamma[k].path_m, "m", "must increase from knot to knot");
    }
  }
}

double gamma_at(const std::vector<GammaKnot>& knots, double path_m) {
  const auto after = std::ranges::lower_bound(knots, path_m, {}, &GammaKnot::path_m);
  if (after == knots.begin()) return knots.front().gamma_rad;
  if (after == knots.end()) return knots.back().gamma_rad;
  const GammaKnot& before = *std::prev(after);
  return std::lerp(before.gamma_rad, after->gamma_rad, (path_m - before.path_m) / (after->path_m - before.path_m));
}

/// The blocks of a program while they are turned.
class Turning {
 public:
  /// @param turn_rad  of each block's end, from where the run has it
  Turning(ForcesResult& forces, std::vector<double> turn_rad)
      : forces_(forces),
        run_(*forces.program),
        cell_(forces.cell->robot),
        turn_rad_(std::move(turn_rad)),
        reason_(turn_rad_.size()) {}

  /// Whether any block stands otherwise than in the run.
  [[nodiscard]] bool turns() const {
    return std::ranges::any_of(turn_rad_, [](double turn) { return std::abs(turn) > same_gamma_rad; });
  }
  void run(Progress& progress) {
    stand(progress);
    keep_clear(progress);
    bend(progress);
  }
  /// Takes the blocks out in which the robot cannot stand.
  std::vector<LostBlock> take_lost() {
    std::vector<LostBlock> out;
    for (std::size_t i = 0; i < reason_.size(); ++i) {
      if (reason_[i].empty()) continue;
      run_.blocks[i].joints.setConstant(std::numeric_limits<double>::quiet_NaN());
      run_.cuts[i] = {};
      out.push_back({.block = i, .reason = std::move(reason_[i])});
    }
    return out;
  }

  /// TurnedProgram::other_way.
  [[nodiscard]] const std::vector<std::size_t>& other_way() const { return other_way_; }

 private:
  [[nodiscard]] bool turns(std::size_t block) const { return std::abs(turn_rad_[block]) > same_gamma_rad; }
  [[nodiscard]] bool stands_turned(std::size_t block) const { return turns(block) && reason_[block].empty(); }

  /// From block to block, each the way nearest to the one before; after a lost one nearest to where the run has it.
  void stand(Progress& progress) {
    const std::optional<robot::SphericalWristInverse> inverse = spherical_wrist(cell_.arm);
    std::optional<Eigen::VectorXd> before;
    Eigen::VectorXd planned_before;
    for (std::size_t i = 0; i < run_.blocks.size(); ++i) {
      progress.check();
      Eigen::VectorXd& joints = run_.blocks[i].joints;
      const Eigen::VectorXd planned = joints;
      if (turns(i)) {
        robot::ToolPose pose = robot::tool_pose(cell_, robot::forward(cell_.arm, joints));
        pose.gamma_rad += turn_rad_[i];
        const std::optional<Eigen::VectorXd> turned = stand_at(cell_, inverse, pose, before.value_or(joints));
        if (!turned) {
          reason_[i] = "the robot cannot stand so";
          before.reset();
          continue;
        }
        joints = *turned;
      }
      if (before) {
        const double more = ((joints - *before) - (planned - planned_before)).cwiseAbs().maxCoeff();
        if (more > other_way_rad + std::abs(turn_rad_[i] - turn_rad_[i - 1])) other_way_.push_back(i);
      }
      before = joints;
      planned_before = planned;
    }
  }

  /// As the map of γ: a posture that is not the program's must keep clear of obstacles.
  void keep_clear(Progress& progress) {
    const std::unique_ptr<robot::CollisionChecker> checker = collision_checker(*forces_.cell, forces_.cut.cutter);
    if (!checker) return;
    each_turned(progress, 8, [&](std::size_t i) {
      const robot::Clearance clearance = checker->check(run_.blocks[i].joints);
      if (clearance.status != robot::Clearance::Status::clear) reason_[i] = cell::near_miss_text(clearance);
    });
  }

  void bend(Progress& progress) {
    each_turned(progress, 64, [&](std::size_t i) {
      using Status = robot::Stiffness::Status;
      const Status status = bend_block(cell_, run_.blocks[i]);
      if (status == Status::singular) reason_[i] = "the robot is singular there";
      if (status == Status::buckled) reason_[i] = "the cut bends the robot beyond what its joints hold";
    });
  }

  template <class F>
  void each_turned(Progress& progress, std::size_t grain, F&& f) {
    parallel_for(run_.blocks.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        progress.check();
        if (stands_turned(i)) f(i);
      }
    });
  }

  ForcesResult& forces_;
  ProgramForces& run_;
  const robot::Cell& cell_;
  std::vector<double> turn_rad_;
  std::vector<std::size_t> other_way_ = {};
  std::vector<std::string> reason_;  ///< why the robot cannot stand in a block; empty: it can
};

std::vector<std::size_t> shown_blocks(const JudgedProgram& judged) {
  if (!judged.map_blocks.empty()) return judged.map_blocks;
  std::vector<std::size_t> cutting;
  for (std::size_t i = 0; i < judged.blocks.rows.size(); ++i) {
    if (judged.blocks.rows[i].cuts) cutting.push_back(i);
  }
  return map_columns(cutting);
}

/// Of blocks that ask more of a drive than it gives; empty: there is none.
std::string overload_note(const TurnedProgram& turned) {
  std::size_t count = 0, worst = 0;
  double most = 1.0;
  const std::vector<BlockRow>& rows = turned.blocks.rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!(rows[i].joint_torque_share > 1.0)) continue;
    ++count;
    if (rows[i].joint_torque_share <= most) continue;
    most = rows[i].joint_torque_share;
    worst = i;
  }
  if (count == 0) return {};
  return fmt::format(
      "In {} block{} a drive gives more than its torque, weight and cut alone, the most {:.2f} times in {}.", count,
      count == 1 ? "" : "s", most, named_block(turned.forces, worst));
}

std::vector<std::string> notes_of(const TurnedProgram& turned) {
  std::vector<std::string> out = {
      "Engagement and forces are those of the plan: the robot's deflection, turned, does not act back on them."};
  if (turned.forces.cell->geometry) {
    out.emplace_back("Collisions are checked where blocks end, not between.");
  } else {
    out.emplace_back("Nothing was checked for collisions: the cell has no [geometry].");
  }
  if (!turned.other_way.empty()) {
    out.push_back(fmt::format("The robot changes its way to stand {} time{}, first into {}: a joint swings over.",
                              turned.other_way.size(), turned.other_way.size() == 1 ? "" : "s",
                              named_block(turned.forces, turned.other_way.front())));
  }
  const std::string overloaded = overload_note(turned);
  if (!overloaded.empty()) out.push_back(overloaded);
  if (turned.lost.empty()) return out;
  const LostBlock& first = turned.lost.front();
  out.push_back(fmt::format("In {} block{} the robot cannot stand, the first {}: {}.", turned.lost.size(),
                            turned.lost.size() == 1 ? "" : "s", named_block(turned.forces, first.block), first.reason));
  return out;
}

}  // namespace

TurnedProgram judge_turned(const JudgedProgram& judged, const std::vector<GammaKnot>& gamma, Progress& progress) {
  check_asked(gamma);
  TurnedProgram out = {.forces = judged.forces, .blocks = {}};
  const std::vector<double> way = ways_m(out.forces.program->program);
  const std::vector<double>& turned_already = judged.gamma_offset_rad;
  std::vector<double> turn_rad;
  turn_rad.reserve(way.size() - 1);
  for (std::size_t i = 1; i < way.size(); ++i) {
    turn_rad.push_back(gamma_at(gamma, way[i]) - (turned_already.empty() ? 0.0 : turned_already[i]));
  }
  Turning turning(out.forces, std::move(turn_rad));
  turning.run(progress);
  out.lost = turning.take_lost();
  out.other_way = turning.other_way();
  BlocksOptions options = judged.judging.options;
  options.scan_points = 0;
  if (turning.turns()) {
    // As the map: nobody who drags a line of γ waits for more.
    options.alike.joint_rad = std::max(options.alike.joint_rad, look_tolerance.joint_rad);
    options.alike.cut_share = std::max(options.alike.cut_share, look_tolerance.cut_share);
  }
  out.blocks = judge_blocks(out.forces, judged.judging.dynamics, options, progress);
  for (const BlockRow& row : out.blocks.rows) {
    if (row.cuts) out.least_stability_margin = std::fmin(out.least_stability_margin, row.stability_margin);
  }
  out.shown = shown_blocks(judged);
  for (const std::size_t block : out.shown) {
    out.path_m.push_back(way[block + 1]);
    out.gamma_rad.push_back(gamma_at(gamma, way[block + 1]));
  }
  out.notes = notes_of(out);
  return out;
}

}  // namespace robomill::process
