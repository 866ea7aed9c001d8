#include "robomill/process/decide/outcome.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/decision/program/looks.hpp"
#include "robomill/process/blocks/joint_torques.hpp"
#include "robomill/process/decide/loads.hpp"
#include "robomill/process/decide/units.hpp"

namespace robomill::process {
namespace {

using decision::ProgramLimit;

/// Rounding of feeds and what dexels see of the same cut twice.
constexpr double violation_tolerance = 0.005;

void add_if_broken(std::vector<Violation>& out, const Violation& violation) {
  if (decision::shortfall(violation) > violation_tolerance) out.push_back(violation);
}

void of_spindle(const DecideProblem& problem, const BlockResult& row, std::size_t block, std::vector<Violation>& out) {
  const double speed = row.force.spindle_speed_rad_per_s;
  const double slowest = problem.machine.min_spindle_speed_rad_per_s;
  const double fastest = problem.machine.max_spindle_speed_rad_per_s;
  if (speed < slowest * (1.0 - 1e-9)) {
    out.push_back({{ProgramLimit::spindle_range, speed, slowest}, block});
  }
  if (fastest > 0.0 && speed > fastest * (1.0 + 1e-9)) {
    out.push_back({{ProgramLimit::spindle_range, speed, fastest}, block});
  }
  if (problem.machine.spindle.empty()) return;
  const decision::SpindleCapacity able = decision::capacity_at(problem.machine.spindle, speed);
  if (!(able.torque_n_m > 0.0)) {
    const double first = problem.machine.spindle.front().spindle_speed_rad_per_s;
    const double last = problem.machine.spindle.back().spindle_speed_rad_per_s;
    out.push_back({{ProgramLimit::spindle_range, speed, speed < first ? first : last}, block});
    return;
  }
  add_if_broken(out, {{ProgramLimit::torque, row.force.revolution_torque_n_m, able.torque_n_m}, block});
  add_if_broken(out, {{ProgramLimit::power, row.force.sustained_power_w, able.power_w}, block});
}

/// Feed, the speeds of the joints, and the chip where it is to be thick enough.
void of_motion(const JudgedRun& run, std::size_t block, double chip_m, double least_chip_m,
               std::vector<Violation>& out) {
  const DecideOptions& options = run.problem.options;
  const program::Program& program = run.forces.program->program;
  const double duration_s = program.blocks[block].duration_s;
  const double feed = way_m(program, block, block) / duration_s;
  for (const double most : {options.max_feed_m_per_s, run.problem.max_tip_speed_m_per_s}) {
    if (most > 0.0) add_if_broken(out, {{ProgramLimit::tip_speed, feed, most}, block});
  }
  const std::vector<robot::Joint>& joints = run.forces.cell->robot.arm.joints;
  Violation fastest = {{.limit = ProgramLimit::joint_speed}, block};
  for (std::size_t k = 0; k < joints.size() && block > 0; ++k) {
    const auto joint = static_cast<Eigen::Index>(k);
    const double turn =
        run.forces.program->blocks[block].joints(joint) - run.forces.program->blocks[block - 1].joints(joint);
    const double speed = std::abs(turn) / duration_s;
    if (!(joints[k].max_velocity > 0.0)) continue;
    if (fastest.allowed > 0.0 && speed / joints[k].max_velocity <= fastest.value / fastest.allowed) continue;
    fastest.value = speed;
    fastest.allowed = joints[k].max_velocity;
  }
  if (fastest.allowed > 0.0) add_if_broken(out, fastest);
  // A tip that stands has no feed to raise, and a plunge keeps the one it has.
  if (least_chip_m > 0.0 && feed > 0.0 && !plunges_in_line(program, block)) {
    add_if_broken(out, {{ProgramLimit::least_chip, chip_m, least_chip_m}, block});
  }
}

void of_cutting_speed(const JudgedRun& run, std::size_t block, std::vector<Violation>& out) {
  const double speed =
      run.blocks.rows[block].spindle_speed_rad_per_s * engaged_radius_m(run.forces.program->cuts[block].engagement);
  const auto& [slowest, fastest] = run.problem.options.cutting_speed_m_per_s;
  const bool too_fast = fastest > 0.0 && speed > fastest * (1.0 + violation_tolerance);
  const bool too_slow = speed < slowest * (1.0 - violation_tolerance);
  if (too_fast || too_slow) out.push_back({{ProgramLimit::cutting_speed, speed, too_fast ? fastest : slowest}, block});
}

void of_block(const JudgedRun& run, std::size_t block, const std::array<double, 2>& chip_m,
              std::vector<Violation>& out) {
  const auto& [problem, forces, blocks, torques, reversals] = run;
  const BlockRow& row = blocks.rows[block];
  const BlockResult& load = forces.program->blocks[block];
  const DecideOptions& options = problem.options;
  const double margin = row.unstable() ? std::min(row.stability_margin, 0.0) : row.stability_margin;
  add_if_broken(out, {{ProgramLimit::stability, margin, problem.machine.depth_margin}, block});
  if (options.max_force_n > 0.0) {
    add_if_broken(out, {{ProgramLimit::force, load.force.peak_force_n, options.max_force_n}, block});
  }
  for (const double most_m : {options.max_deflection_m, problem.finish.max_deflection_m}) {
    if (most_m > 0.0) add_if_broken(out, {{ProgramLimit::deflection, load.peak_deflection_m.norm(), most_m}, block});
  }
  const double surface_m = left_surface_error_m(forces, row);
  if (problem.finish.max_surface_error_m > 0.0 && std::isfinite(surface_m)) {
    add_if_broken(out, {{ProgramLimit::surface_error, surface_m, problem.finish.max_surface_error_m}, block});
  }
  if (std::isfinite(row.steady.vibration_share)) {
    const double feed_m = load.force.feed_per_tooth_m;  // blocks that share an evaluation differ in it a little
    add_if_broken(out, {{ProgramLimit::forced_vibration, row.steady.vibration_share * feed_m, feed_m}, block});
  }
  const double chip =
      load.force.feed_per_tooth_m * cutting::greatest_chip_share(forces.program->cuts[block].engagement);
  if (chip_m[1] > 0.0) add_if_broken(out, {{ProgramLimit::greatest_chip, chip, chip_m[1]}, block});
  of_motion(run, block, chip, options.chip_thickness_m[0], out);
  of_cutting_speed(run, block, out);
  of_spindle(problem, load, block, out);
  const double share = greatest_torque_share(forces.cell->robot.arm, torques[block]);
  add_if_broken(out, {{ProgramLimit::joint_torque, share, 1.0}, block});
  if (!problem.options.avoid_reversals) return;
  if (std::ranges::find(reversals, block, &robot::LoadReversal::block) != reversals.end()) {
    out.push_back({{ProgramLimit::reversal, 1.0, 0.0}, block});
  }
}

}  // namespace

bool rises_with_feed(ProgramLimit limit) {
  constexpr std::array loads = {ProgramLimit::force,        ProgramLimit::torque,        ProgramLimit::power,
                                ProgramLimit::deflection,   ProgramLimit::tip_speed,     ProgramLimit::joint_speed,
                                ProgramLimit::joint_torque, ProgramLimit::greatest_chip, ProgramLimit::surface_error};
  return std::ranges::find(loads, limit) != loads.end();
}

double left_surface_error_m(const ForcesResult& forces, const BlockRow& row) {
  return std::abs(forces.program->stock ? row.surface_left_m : row.steady.surface_error_m);
}

JudgedRun::JudgedRun(const DecideProblem& asked, const ForcesResult& run, const ProgramBlocks& judged)
    : problem(asked),
      forces(run),
      blocks(judged),
      torques(judged.joint_loads),
      reversals(robot::load_reversals(torques)) {}

std::vector<Violation> violations_of(const JudgedRun& run, const std::array<double, 2>& chip_m) {
  std::vector<Violation> out;
  for (std::size_t i = 0; i < run.blocks.rows.size(); ++i) {
    if (run.blocks.rows[i].cuts) of_block(run, i, chip_m, out);
  }
  return out;
}

Outcome outcome_of(const JudgedRun& run, const std::array<double, 2>& chip_m) {
  const auto& [problem, forces, blocks, torques, reversals] = run;
  Outcome out;
  double last_speed = 0.0;
  for (std::size_t i = 0; i < blocks.rows.size(); ++i) {
    const program::Block& block = forces.program->program.blocks[i];
    out.total_time_s += block.duration_s;
    const BlockRow& row = blocks.rows[i];
    if (!row.cuts) continue;
    const BlockResult& load = forces.program->blocks[i];
    out.cutting_time_s += block.duration_s;
    const double speed = row.spindle_speed_rad_per_s;
    if (last_speed > 0.0) out.total_time_s += std::abs(speed - last_speed) / problem.options.spindle_ramp_rad_per_s2;
    out.lowest_spindle_speed_rad_per_s = last_speed > 0.0 ? std::min(out.lowest_spindle_speed_rad_per_s, speed) : speed;
    out.highest_spindle_speed_rad_per_s = std::max(out.highest_spindle_speed_rad_per_s, speed);
    last_speed = speed;
    if (row.unstable()) {
      ++out.unstable_blocks;
    } else if (row.stability_margin < 0.0) {
      ++out.uncertain_blocks;
    }
    out.least_stability_margin = std::fmin(out.least_stability_margin, row.stability_margin);
    out.peak_force_n = std::max(out.peak_force_n, load.force.peak_force_n);
    out.revolution_torque_n_m = std::max(out.revolution_torque_n_m, load.force.revolution_torque_n_m);
    out.sustained_power_w = std::max(out.sustained_power_w, load.force.sustained_power_w);
    out.peak_deflection_m = std::max(out.peak_deflection_m, load.peak_deflection_m.norm());
    out.greatest_torque_share =
        std::max(out.greatest_torque_share, greatest_torque_share(forces.cell->robot.arm, torques[i]));
    out.peak_vibration_m = std::fmax(out.peak_vibration_m, row.steady.vibration.amplitude_m);
    out.worst_surface_error_m = std::fmax(out.worst_surface_error_m, left_surface_error_m(forces, row));
  }
  std::vector<std::size_t> turned;
  turned.reserve(reversals.size());
  for (const robot::LoadReversal& reversal : reversals) turned.push_back(reversal.block);
  turned.erase(std::unique(turned.begin(), turned.end()), turned.end());
  out.reversals = turned.size();
  for (const Violation& violation : violations_of(run, chip_m)) {
    const auto same = std::ranges::find(out.violations, violation.limit, &Violation::limit);
    if (same == out.violations.end()) {
      out.violations.push_back(violation);
    } else if (decision::shortfall(violation) > decision::shortfall(*same)) {
      *same = violation;
    }
  }
  return out;
}

}  // namespace robomill::process
