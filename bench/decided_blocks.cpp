// Whether a decided program keeps its limits, by means that have no part in the decision: decided_blocks JOB.toml
// [blocks] [seed] [--fine]. It decides the job's program as `robomill plan` does, with the dynamics of its cell, and
// 1. cuts blocks drawn at random, and those told to chatter as programmed, in time: tooth by tooth, from rest, with
//    loss of contact, as programmed and as decided;
// 2. says what the check of the trajectory's samples found;
// 3. holds the exact run's forces, chips, torque and power of every block against their limits.
// Ends with 1 where a decided block chatters in time or a limit is crossed. --fine cuts each once more with steps half
// as long: the verdicts must be the same.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/plan_stages.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/path/files/smoothing_toml.hpp"
#include "robomill/simulation/posture.hpp"

namespace {

using namespace robomill;
using simulation::Verdict;

struct Settings {
  std::filesystem::path job = {};
  std::size_t blocks = 50;
  std::uint64_t seed = 1;
  bool fine = false;
};

/// A program as it was run and judged.
struct Judged {
  const process::ForcesResult& forces;
  const process::ProgramBlocks& blocks;
};

/// A free vibration of the structure has so many time constants in the first run, and the quarters of the time at which
/// verdicts look lie one apart.
constexpr double time_constants = 4.0;
constexpr double shortest_s = 1.0, longest_s = 32.0;
/// The changes from period to period in one quarter of the time over those in the one before: beyond these the motion
/// itself tells (robomill/simulation/README.md, "Verdict").
constexpr double dies = 0.7, grows = 1.4;
/// What the exact run may miss a limit by: rounding of feeds, and what dexels see of the same cut twice.
constexpr double slack = 0.005;

/// What a block does in time.
struct InTime {
  bool cuts = false;
  bool chatters = false;
  bool by_motion = false;     ///< it dies or grows; else the small vibration tells, or chatter has its full size
  double seconds = 0.0;       ///< simulated
  double quarters = 0.0;      ///< changes in the last quarter over those in the one before
  double multiplier = 0.0;    ///< size of the small vibration's, of the simulation's own equations; 0: not found
  double frequency_hz = 0.0;  ///< of the chatter
  int steps_per_revolution = 0;
  bool resolved = true;
  bool fine_differs = false;  ///< the verdict with steps half as long
  std::string error = {};
};

/// Of the slowest free vibration.
double time_constant_s(const modal::TipModes& structure) {
  return structure.pole.size() > 0 ? 1.0 / structure.pole.real().cwiseAbs().minCoeff() : 0.0;
}

bool chatters(const simulation::Simulation& run) {
  return run.verdict == Verdict::undecided ? run.growth_per_period >= 1.0 : run.verdict == Verdict::chatter;
}

/// Simulated for time_constants of the slowest mode, and twice as long each time until the motion tells, and not
/// otherwise than the growth of a small vibration does: a mode that grows slowly may still hide behind one that dies.
/// The steps are those that the forced vibration needs: chatter and a hard entry ask for ever shorter ones.
void simulate(const simulation::PostureCut& cut, bool fine, InTime& out) {
  constexpr double forced_s = 0.05;
  simulation::SimulationOptions options = {
      .seconds = forced_s, .sample_rate_hz = 2048.0, .regeneration = false, .tolerance = 1e-2};
  options.steps_per_revolution = simulation::simulate(cut, options).steps_per_revolution;
  options.regeneration = true;
  options.seconds = std::clamp(time_constants * time_constant_s(cut.structure), shortest_s, longest_s);
  for (;; options.seconds *= 2.0) {
    const simulation::Simulation run = simulation::simulate(cut, options);
    const bool known = run.small.status == simulation::SmallVibration::Status::found;
    out.chatters = chatters(run);
    out.seconds = options.seconds;
    out.quarters = std::pow(run.growth_per_period, std::floor(0.25 * std::floor(options.seconds / run.period_s)));
    out.multiplier = known ? run.small.spectral_radius : 0.0;
    out.steps_per_revolution = options.steps_per_revolution;
    out.resolved = run.resolved;
    out.frequency_hz = run.chatter_frequency_hz;
    const bool grows_in_small = known && out.multiplier >= 1.0;
    out.by_motion = run.diverged || out.quarters < dies || out.quarters > grows || (out.chatters && !grows_in_small);
    const bool told = out.by_motion || (out.chatters && grows_in_small);  // chatter that has reached its size
    if ((told && (!known || out.chatters == grows_in_small)) || 2.0 * options.seconds > longest_s) break;
  }
  if (!fine) return;
  options.steps_per_revolution *= 2;
  out.fine_differs = chatters(simulation::simulate(cut, options)) != out.chatters;
}

InTime in_time(const Judged& program, std::size_t block, const process::DynamicsAt& dynamics, bool fine) {
  InTime out;
  const process::BlockRow& row = program.blocks.rows[block];
  if (!row.cuts) return out;
  out.cuts = true;
  const cutting::PoseEngagement& engaged = program.forces.program->cuts[block];
  const process::BlockResult& load = program.forces.program->blocks[block];
  const Eigen::Matrix3d base_from_feed = program.forces.cell->robot.workpiece.linear() * engaged.work_from_feed;
  simulation::PostureCut cut;
  cut.cutter = program.forces.cut.cutter;
  cut.engagement = engaged.engagement;
  cut.coefficients = program.forces.cut.coefficients;
  cut.motion = {.feed_per_tooth_m = load.force.feed_per_tooth_m,
                .spindle_speed_rad_per_s = row.spindle_speed_rad_per_s};
  cut.structure = modal::tip_modes(modal::turned(dynamics(load.joints).modes, base_from_feed.transpose()), {}, 0.0);
  try {
    simulate(cut, fine, out);
  } catch (const std::exception& error) {
    out.error = error.what();
  }
  return out;
}

/// Blocks of the decided program that cut: so many at random, then those that chatter as programmed by the solver, at
/// most as many again.
struct Drawn {
  std::vector<std::size_t> random = {}, unstable = {};
};

Drawn draw(const Judged& before, const Judged& after, const Settings& settings) {
  Drawn out;
  std::vector<std::size_t> cutting;
  for (std::size_t i = 0; i < after.blocks.rows.size(); ++i) {
    if (after.blocks.rows[i].cuts) cutting.push_back(i);
  }
  Random random(settings.seed);
  const std::size_t count = std::min(settings.blocks, cutting.size());
  for (std::size_t k = 0; k < count; ++k) std::swap(cutting[k], cutting[k + random.index(cutting.size() - k)]);
  out.random.assign(cutting.begin(), cutting.begin() + static_cast<std::ptrdiff_t>(count));
  std::ranges::sort(out.random);
  for (std::size_t i = 0; i < before.blocks.rows.size() && out.unstable.size() < count; ++i) {
    const bool drawn = std::ranges::binary_search(out.random, i);
    if (before.blocks.rows[i].unstable() && !drawn) out.unstable.push_back(i);
  }
  return out;
}

std::string text_of(const InTime& found, const process::BlockRow& row) {
  if (!found.cuts) return "- | - | -";
  if (!found.error.empty()) return fmt::format("{:.4f} | - | {}", row.stability.at.spectral_radius, found.error);
  const std::string verdict =
      found.chatters ? fmt::format("chatter of {:.0f} Hz", found.frequency_hz) : std::string("stable");
  const std::string multiplier = found.multiplier > 0.0 ? fmt::format("{:.4f}", found.multiplier) : std::string("-");
  return fmt::format("{:.4f} | {} | {}{}, {:.2f} in {:.3g} s", row.stability.at.spectral_radius, multiplier, verdict,
                     found.by_motion ? "" : "*", found.quarters, found.seconds);
}

/// How the verdicts of one program stand to the solver's.
struct Score {
  int simulated = 0, agree = 0, by_motion = 0, failed = 0, unresolved = 0, fine_differ = 0;
  int chatter = 0;          ///< in time
  int stable_chatters = 0;  ///< … and told stable
  int chatter_stable = 0;   ///< told to chatter, and stable in time
  int multipliers = 0;      ///< of small vibrations that were found
  double longest_s = 0.0, multiplier_off = 0.0;
  int least_steps = std::numeric_limits<int>::max(), most_steps = 0;
  void add(const InTime& found, const process::BlockRow& row) {
    if (!found.cuts) return;
    ++simulated;
    if (!found.error.empty()) {
      ++failed;
      return;
    }
    if (found.chatters == row.unstable()) ++agree;
    if (found.chatters) ++chatter;
    if (found.chatters && !row.unstable()) ++stable_chatters;
    if (!found.chatters && row.unstable()) ++chatter_stable;
    if (found.by_motion) ++by_motion;
    if (!found.resolved) ++unresolved;
    if (found.fine_differs) ++fine_differ;
    longest_s = std::max(longest_s, found.seconds);
    least_steps = std::min(least_steps, found.steps_per_revolution);
    most_steps = std::max(most_steps, found.steps_per_revolution);
    if (found.multiplier > 0.0) {
      ++multipliers;
      multiplier_off = std::max(multiplier_off, std::abs(found.multiplier - row.stability.at.spectral_radius));
    }
  }
  void print(const char* name, bool fine) const {
    if (simulated == 0) return;
    fmt::print(
        "- {}: {} of {} chatter in time; {} verdicts agree with |μ|, told stable and chatters: {}, told to chatter and "
        "stable: {}. {} told by motion that dies or grows. The small vibration's |μ|, found for {}, differs by {:.1e} "
        "at most. {} to {} steps a revolution, up to {:.3g} s; {} not resolved, {} failed{}.\n",
        name, chatter, simulated, agree, stable_chatters, chatter_stable, by_motion, multipliers, multiplier_off,
        least_steps, most_steps, longest_s, unresolved, failed,
        fine ? fmt::format(", {} otherwise with half the step", fine_differ) : std::string());
  }
};

/// As programmed and as decided.
using Found = std::array<InTime, 2>;

std::vector<Found> cut_in_time(const std::array<Judged, 2>& programs, const std::vector<std::size_t>& blocks,
                               const process::DynamicsAt& dynamics, bool fine) {
  std::vector<Found> out(blocks.size());
  const auto begun = std::chrono::steady_clock::now();
  const std::clock_t worked = std::clock();
  parallel_for(2 * blocks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t block = blocks[k / 2];
      InTime& found = out[k / 2].at(k % 2);
      found = in_time(programs.at(k % 2), block, dynamics, fine);
      fmt::print(stderr, "{}: {}\n", block + 1, text_of(found, programs.at(k % 2).blocks.rows[block]));
    }
  });
  fmt::print("{} cuts in time: {:.0f} s of processor time, {:.0f} s.\n\n", 2 * blocks.size(),
             static_cast<double>(std::clock() - worked) / CLOCKS_PER_SEC,
             std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
  return out;
}

/// Prints the table and its summary. Whether every decided block is stable in time.
bool judge_in_time(const std::array<Judged, 2>& programs, const process::DynamicsAt& dynamics,
                   const Settings& settings) {
  const Drawn drawn = draw(programs[0], programs[1], settings);
  std::vector<std::size_t> blocks = drawn.random;
  blocks.insert(blocks.end(), drawn.unstable.begin(), drawn.unstable.end());
  const std::vector<Found> found = cut_in_time(programs, blocks, dynamics, settings.fine);
  fmt::print("| block | line |");
  for (const char* when : {"programmed", "decided"}) {
    fmt::print(" {}: rpm | depth, mm | \\|μ\\| | \\|μ\\| in time | in time |", when);
  }
  fmt::print("\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::array<Score, 2> score;         // of the blocks drawn at random
  std::array<Score, 2> unstable_too;  // of the others
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const std::size_t i = blocks[k];
    const bool random = k < drawn.random.size();
    fmt::print("| {}{} | {} |", i + 1, random ? "" : "†", programs[1].forces.program->program.blocks[i].line);
    for (std::size_t p = 0; p < 2; ++p) {
      const process::BlockRow& row = programs.at(p).blocks.rows[i];
      (random ? score : unstable_too).at(p).add(found[k].at(p), row);
      fmt::print(" {:.0f} | {:.3f} | {} |", row.spindle_speed_rad_per_s / units::rpm, row.axial_depth_m / units::mm,
                 text_of(found[k].at(p), row));
    }
    fmt::print("\n");
  }
  fmt::print(
      "\n†: not drawn, but told to chatter as programmed. The number: changes of the motion from period to period in "
      "the last quarter of the time over those in the one before; *: they neither die nor grow, and the small "
      "vibration tells, or chatter has its full size.\n\n");
  score[0].print("as programmed, drawn", settings.fine);
  score[1].print("as decided, drawn", settings.fine);
  unstable_too[0].print("as programmed, told to chatter", settings.fine);
  unstable_too[1].print("as decided, the same blocks", settings.fine);
  const auto holds = [](const Score& s) { return s.chatter == 0 && s.failed == 0; };
  return holds(score[1]) && holds(unstable_too[1]);
}

/// One limit over all blocks.
struct Limit {
  const char* name;
  const char* unit;
  double in_si;
  bool at_least;
  double value = 0.0, allowed = 0.0;  ///< of the worst block
  double share = 0.0;                 ///< used of it
  std::size_t block = 0, over = 0;
  void look(std::size_t at, double found, double limit) {
    if (!(limit > 0.0) || !std::isfinite(found)) return;
    const double most = std::numeric_limits<double>::infinity();
    const double used = !at_least ? found / limit : found > 0.0 ? limit / found : most;
    if (used > 1.0 + slack) ++over;
    if (used <= share) return;
    share = used;
    value = found;
    allowed = limit;
    block = at;
  }
};

/// Lines on which the tool runs down along its axis: they are fed no faster than programmed and may cut thinner chips.
std::vector<std::size_t> plunging_lines(const program::Program& program) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const Eigen::Vector3d move = program.blocks[i].end.tip_m - program.begin_of(i).tip_m;
    if (-move.dot(program.blocks[i].end.axis) > 0.5 * move.norm()) out.push_back(program.blocks[i].line);
  }
  std::ranges::sort(out);
  return out;
}

double chip_of(const Judged& program, std::size_t block) {
  return program.forces.program->blocks[block].force.feed_per_tooth_m *
         cutting::greatest_chip_share(program.forces.program->cuts[block].engagement);
}

/// Least and greatest chip: what the job asks for, else what the program makes as it is.
std::array<double, 2> chips_of(const process::DecideOptions& options, const Judged& before) {
  std::array<double, 2> made = {std::numeric_limits<double>::infinity(), 0.0};
  for (std::size_t i = 0; i < before.blocks.rows.size(); ++i) {
    const double chip = before.blocks.rows[i].cuts ? chip_of(before, i) : 0.0;
    if (!(chip > 0.0)) continue;
    made = {std::min(made[0], chip), std::max(made[1], chip)};
  }
  const auto& [least, most] = options.chip_thickness_m;
  return {least > 0.0 ? least : made[0], most > 0.0 ? most : made[1]};
}

/// Prints the worst use of each limit. Whether none is crossed.
bool judge_loads(const jobs::PlanResult& plan, const Judged& before, const Judged& after) {
  const auto& [least_chip, most_chip] = chips_of(plan.job.decide, before);
  const std::vector<std::size_t> plunges = plunging_lines(after.forces.program->program);
  enum Of : std::size_t { margin, force, thick, thin, torque, power, bent, surface, fastest, slowest, joints, count };
  std::array<Limit, count> limits{{{"stability margin", "", 1.0, true},
                                   {"peak force", "N", 1.0, false},
                                   {"greatest chip", "mm", units::mm, false},
                                   {"greatest chip, at least", "mm", units::mm, true},
                                   {"torque over a revolution", "N·m", 1.0, false},
                                   {"sustained power", "kW", units::kw, false},
                                   {"deflection", "µm", units::um, false},
                                   {"surface error", "µm", units::um, false},
                                   {"spindle speed", "rpm", units::rpm, false},
                                   {"spindle speed, at least", "rpm", units::rpm, true},
                                   {"a joint's torque, of its drive's", "", 1.0, false}}};
  const decision::MachineLimits& machine = plan.job.recommend;
  for (std::size_t i = 0; i < after.blocks.rows.size(); ++i) {
    const process::BlockRow& row = after.blocks.rows[i];
    if (!row.cuts) continue;
    const process::BlockResult& load = after.forces.program->blocks[i];
    const double speed = row.spindle_speed_rad_per_s;
    limits[margin].look(i, row.stability_margin, machine.depth_margin);
    limits[force].look(i, load.force.peak_force_n, plan.job.decide.max_force_n);
    limits[thick].look(i, chip_of(after, i), most_chip);
    const bool plunge = std::ranges::binary_search(plunges, after.forces.program->program.blocks[i].line);
    if (!plunge) limits[thin].look(i, chip_of(after, i), least_chip);
    if (!machine.spindle.empty()) {
      const decision::SpindleCapacity able = decision::capacity_at(machine.spindle, speed);
      constexpr double least = 1e-9;  // outside its curve it has nothing
      limits[torque].look(i, load.force.revolution_torque_n_m, std::max(able.torque_n_m, least));
      limits[power].look(i, load.force.sustained_power_w, std::max(able.power_w, least));
    }
    limits[bent].look(i, load.peak_deflection_m.norm(), plan.job.decide.max_deflection_m);
    limits[bent].look(i, load.peak_deflection_m.norm(), plan.job.finish.max_deflection_m);
    limits[surface].look(i, std::abs(row.steady.surface_error_m), plan.job.finish.max_surface_error_m);
    limits[fastest].look(i, speed, machine.max_spindle_speed_rad_per_s);
    limits[slowest].look(i, speed, machine.min_spindle_speed_rad_per_s);
  }
  if (plan.decision->decided->greatest_torque_share > 0.0) {
    limits[joints].look(plan.decided->blocks->worst, plan.decision->decided->greatest_torque_share, 1.0);
  }
  fmt::print(
      "\n| limit | worst | allowed | used, % | in block | blocks beyond by over {:.1f} % |\n"
      "|---|---|---|---|---|---|\n",
      100.0 * slack);
  bool holds = true;
  for (const Limit& limit : limits) {
    if (!(limit.share > 0.0)) continue;
    fmt::print("| {} | {:.4g} {} | {:.4g} | {:.1f} | {} | {} |\n", limit.name, limit.value / limit.in_si, limit.unit,
               limit.allowed / limit.in_si, 100.0 * limit.share, limit.block + 1, limit.over);
    holds = holds && limit.over == 0;
  }
  return holds;
}

/// Prints what the check of every sample found. Whether it found no violation.
bool judge_path(const jobs::PlanResult& plan) {
  const std::optional<process::SmoothResult>& path = plan.decided->path;
  if (!path) {
    fmt::print("\nNo trajectory: the cell has no [smoothing].\n");
    return true;
  }
  const path::CheckResult& check = path->first().summary.check;
  fmt::print("\nTrajectory: {:.2f} s, {} samples, {} violations of limits.\n", check.duration_s, check.samples,
             check.violations());
  const auto used = [](const path::Usage& usage) { return usage.limit > 0.0 ? 100.0 * usage.max / usage.limit : 0.0; };
  std::array<double, 3> joint = {0.0, 0.0, 0.0};
  for (const path::CheckResult::Joint& one : check.joints) {
    joint = {std::max(joint[0], used(one.velocity)), std::max(joint[1], used(one.acceleration)),
             std::max(joint[2], used(one.jerk))};
  }
  fmt::print(
      "Used, %, of a joint's velocity {:.2f}, acceleration {:.2f}, jerk {:.2f}; of the tip's {:.2f}, {:.2f}, {:.2f}; "
      "of "
      "the axis's {:.2f}, {:.2f}, {:.2f}; of the programmed feed {:.2f}; of the tolerance of the tip {:.2f}, of the "
      "axis "
      "{:.2f}.\n",
      joint[0], joint[1], joint[2], used(check.tip_velocity), used(check.tip_acceleration), used(check.tip_jerk),
      used(check.axis_velocity), used(check.axis_acceleration), used(check.axis_jerk), used(check.feed),
      used(check.tip_error_m), used(check.axis_error_rad));
  return path->holds();
}

/// The job's program as it is, run and judged as a plan does before it decides.
void run_as_programmed(const cell::CellFile& cell, const process::DynamicsAt& dynamics, jobs::PlanResult& plan) {
  process::ProgramRun run = {.keep_cuts = true, .deflect = true};
  std::optional<program::ProgramReading> reading;
  if (path::has_smoothing(*cell.document)) {
    std::optional<process::SmoothResult>& path = plan.programmed.path;
    path = jobs::run_smooth({.program = plan.job.program, .cell = cell.path, .options = {.place = false}}, cell);
    reading = path->reading;
    run.joints = path->block_joints;
  }
  plan.programmed.forces = jobs::run_forces_along(process::read_forces(plan.job.forces, process::ForcesJob::program),
                                                  plan.job.program, cell, run, reading);
  plan.programmed.blocks = process::judge_blocks(*plan.programmed.forces, dynamics, {.scan_points = 0});
}

Settings read(int argc, char** argv) {
  Settings out;
  int words = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == "--fine") {
      out.fine = true;
      continue;
    }
    if (words == 0) out.job = argv[i];
    if (words == 1) out.blocks = std::strtoull(argv[i], nullptr, 10);
    if (words == 2) out.seed = std::strtoull(argv[i], nullptr, 10);
    ++words;
  }
  return out;
}

int run(const Settings& settings) {
  jobs::PlanResult plan;
  plan.job = jobs::read_job(settings.job);
  if (!plan.job.judges_blocks() || plan.job.has_structure()) {
    throw InvalidInput(settings.job.string(), "must have forces, cell and program, and no dynamics but the cell's");
  }
  const cell::CellFile cell = cell::read_cell(plan.job.cell, cell::Robots::serial);
  constexpr std::array<bool, 3> pushed{true, true, true};  // it chooses warnings alone, which nobody reads here
  const process::DynamicsAt dynamics = process::dynamics_of_cell(cell, pushed, plan.warnings, plan.notes, plan.assumed);
  run_as_programmed(cell, dynamics, plan);
  jobs::decide_conditions(plan, cell, dynamics, {.scan_points = 0}, {}, Progress::none());
  if (plan.decision->status != process::Decision::Status::found) {
    fmt::print("No conditions were decided: {}\n", plan.decision->reason);
    return 1;
  }
  const process::ProgramBlocks& before = *plan.programmed.blocks;
  const process::ProgramBlocks& after = *plan.decided->blocks;
  const std::array<Judged, 2> programs{{{*plan.programmed.forces, before}, {*plan.decided->forces, after}}};
  fmt::print(
      "{}: {} blocks that cut. As programmed {:.2f} s of cutting, {} unstable; as decided {:.2f} s, {}, least "
      "margin {:.3f}.\n\n",
      settings.job.string(), after.cutting, plan.decision->as_programmed.cutting_time_s, before.unstable,
      plan.decision->decided->cutting_time_s, after.unstable, plan.decision->decided->least_stability_margin);
  const bool stable = judge_in_time(programs, dynamics, settings);
  const bool path = judge_path(plan);
  const bool loads = judge_loads(plan, programs[0], programs[1]);
  return stable && path && loads ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const Settings settings = read(argc, argv);
  if (settings.job.empty()) {
    fmt::print(stderr, "decided_blocks JOB.toml [blocks] [seed] [--fine]\n");
    return 2;
  }
  try {
    return run(settings);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
