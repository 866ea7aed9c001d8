#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/program/looks.hpp"
#include "robomill/decision/program_decision.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/block_model.hpp"
#include "testing/process/programs.hpp"
#include "testing/support.hpp"

namespace robomill::process {
namespace decide_rejected_test {

using decision::ProgramLimit;

/// Some of all limits, from those that the program keeps to those that no speed keeps.
void draw_limits(Random& random, const ForcesResult& forces, DecideProblem& problem) {
  const auto chance = [&random] { return random.uniform(0.0, 1.0) < 0.3; };
  double force_n = 0.0, deflection_m = 0.0, power_w = 0.0, torque_n_m = 0.0;
  for (const BlockResult& row : forces.program->blocks) {
    force_n = std::max(force_n, row.force.peak_force_n);
    deflection_m = std::max(deflection_m, row.peak_deflection_m.norm());
    power_w = std::max(power_w, row.force.sustained_power_w);
    torque_n_m = std::max(torque_n_m, row.force.revolution_torque_n_m);
  }
  DecideOptions& options = problem.options;
  if (chance()) options.free = {Free::spindle_speed};
  if (chance()) options.free = {Free::feed};
  if (chance()) options.speed_changes = SpeedChanges::none;
  if (chance()) options.max_force_n = random.uniform(0.2, 1.2) * force_n;
  if (chance()) options.max_deflection_m = random.uniform(0.2, 1.2) * deflection_m;
  if (chance()) options.max_feed_m_per_s = random.uniform(0.001, 0.012);
  if (chance()) options.chip_thickness_m = {0.02e-3, random.uniform(0.021e-3, 0.05e-3)};
  if (chance()) options.cutting_speed_m_per_s = {random.uniform(0.5, 1.5), random.uniform(1.5, 3.0)};
  if (chance()) problem.finish.max_surface_error_m = random.uniform(0.2e-6, 20e-6);
  if (!chance()) return;
  const double torque = random.uniform(0.2, 1.5) * torque_n_m, power = random.uniform(0.2, 1.5) * power_w;
  problem.machine.spindle = {
      {.spindle_speed_rad_per_s = 6000.0 * units::rpm, .torque_n_m = torque, .power_w = power},
      {.spindle_speed_rad_per_s = 18000.0 * units::rpm, .torque_n_m = 0.5 * torque, .power_w = power}};
}

class DecideRejected : public testing::ThreePasses {};

// "rejected 13070 rpm: chip thickness 0.0306 mm; at most 0.06 mm" would contradict itself.
TEST_F(DecideRejected, WhatStopsASpeedLiesBeyondWhatIsAllowed) {
  const DynamicsAt dynamics = constant_dynamics(modes());
  const Judged judged = judge(dynamics);
  std::set<ProgramLimit> seen;
  for (int seed = 1; seed <= test::seeds(300); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    DecideProblem asked = problem(judged, dynamics);
    draw_limits(random, judged.forces, asked);
    const BlockModel model(asked, Progress::none());
    const decision::ProgramDecision choice =
        decision::decide_program(model.cuts(), model.stretches(), model, model.search());
    for (const decision::RejectedSpeed& rejected : choice.rejected) {
      const decision::LimitUse& by = rejected.stopped_by;
      if (by.limit == ProgramLimit::none) continue;
      seen.insert(by.limit);
      // Of loads and of the surface 1 % is kept in reserve, and the text says so.
      const std::string text = limit_text(by);
      const bool reserve = text.find("and a reserve") != std::string::npos;
      EXPECT_GT(decision::shortfall(by), reserve ? -0.0101 : 0.0) << "seed " << seed << ": " << text;
      constexpr std::array with_reserve = {ProgramLimit::force, ProgramLimit::torque, ProgramLimit::power,
                                           ProgramLimit::deflection, ProgramLimit::surface_error};
      EXPECT_TRUE(!reserve || std::ranges::find(with_reserve, by.limit) != with_reserve.end()) << text;
    }
  }
  EXPECT_GE(seen.size(), 5U);
}

}  // namespace decide_rejected_test
}  // namespace robomill::process
