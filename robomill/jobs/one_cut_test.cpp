#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/choose.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/monitor.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/simulate.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "testing/support.hpp"

/// One cut in the files of several verbs: what they say of it is the same.
namespace robomill::jobs {
namespace one_cut_test {

using test::Folder;

struct RandomCut {
  std::string tool, cut, coefficients, dynamics;
  bool planned = true;  ///< a flat end whose chart is quick: without runout, or with straight teeth
};

/// A stiff tool, so that a millimetre or so is stable.
std::string dynamics_of(Random& random) {
  const auto mode = [&] {
    return fmt::format("[{{ frequency_hz = {:.6g}, damping_ratio = {:.3g}, modal_mass_kg = {:.3g} }}]",
                       random.uniform(500.0, 1500.0), random.uniform(0.02, 0.05), random.uniform(0.2, 0.6));
  };
  std::string text = "x = " + mode() + "\ny = ";
  text += mode() + "\n";
  return text;
}

RandomCut random_cut(Random& random, int seed) {
  RandomCut out;
  const int teeth = 2 + seed % 3;
  const double diameter_mm = random.uniform(8.0, 20.0);
  const char* const kinds[] = {"flat-end", "flat-end", "ball-end", "bull-nose"};
  const char* const kind = kinds[seed % 4];
  const bool flat = seed % 4 < 2;
  const bool runout = seed % 3 == 1;
  const double helix_deg = random.uniform(0.0, 45.0);
  const bool straight = runout && flat && seed % 2 == 0;
  out.planned = flat && (straight || !runout);
  out.tool = fmt::format("[tool]\nkind = \"{}\"\nteeth = {}\ndiameter_mm = {:.6g}\nhelix_deg = {:.4g}\n", kind, teeth,
                         diameter_mm, straight ? 0.0 : helix_deg);
  if (seed % 4 == 3) out.tool += fmt::format("corner_radius_mm = {:.4g}\n", 0.2 * diameter_mm);
  if (runout) out.tool += fmt::format("runout_um = {:.3g}\nrunout_angle_deg = 20\n", random.uniform(2.0, 40.0));
  if (seed % 5 == 2) {
    const double unequal = random.uniform(0.0, 0.1) * 360.0 / teeth;
    out.tool += "pitch_deg = [";
    for (int j = 0; j < teeth; ++j) {
      const double pitch = 360.0 / teeth + (j == 0 ? unequal : j == 1 ? -unequal : 0.0);
      out.tool += fmt::format("{}{:.10g}", j > 0 ? ", " : "", pitch);
    }
    out.tool += "]\n";
  }
  const double feed_mm = random.uniform(0.03, 0.15);
  const char* const directions[] = {"up", "down", "slot"};
  const char* const direction = directions[(seed / 2) % 3];
  out.cut = fmt::format("[cut]\ndirection = \"{}\"\nfeed_per_tooth_mm = {:.4g}\n", direction, feed_mm);
  const double radial_mm = random.uniform(0.1, 0.9) * diameter_mm;
  if (std::string(direction) != "slot") out.cut += fmt::format("radial_depth_mm = {:.5g}\n", radial_mm);
  out.coefficients = fmt::format(
      "[coefficients]\ntangential_n_per_mm2 = {:.5g}\nradial_n_per_mm2 = {:.5g}\ntangential_edge_n_per_mm = {:.4g}\n"
      "radial_edge_n_per_mm = {:.4g}\n",
      random.uniform(500.0, 2000.0), random.uniform(100.0, 700.0), random.uniform(0.0, 30.0),
      random.uniform(0.0, 30.0));
  if (!flat) out.coefficients += "axial_n_per_mm2 = 120\naxial_edge_n_per_mm = 3\n";
  out.dynamics = dynamics_of(random);
  if (!flat) out.dynamics += "z = [{ frequency_hz = 2000, damping_ratio = 0.03, modal_mass_kg = 2 }]\n";
  return out;
}

const std::string chart = "[lobes]\nspindle_speed_rpm = [6000, 12000]\naxial_depth_mm = [0, 4]\ngrid = [21, 12]\n";

std::string lobes_text(const RandomCut& c) {
  return c.tool + c.cut + c.coefficients + "[dynamics]\n" + c.dynamics + chart;
}

std::string forces_text(const RandomCut& c, const stability::OperatingPoint& at) {
  return c.tool + c.cut +
         fmt::format("axial_depth_mm = {:.12g}\nspindle_speed_rpm = {:.12g}\n", at.axial_depth_m / units::mm,
                     at.spindle_speed_rad_per_s / units::rpm) +
         c.coefficients;
}

void expect_within(double a, double b, const std::string& what) {
  EXPECT_NEAR(a, b, 0.01 * std::max(std::abs(a), std::abs(b)) + 1e-12) << what;
}

/// The mean of the force over the whole revolutions of the second half.
Eigen::Vector3d mean_force(const simulation::Simulation& s, double speed_rad_per_s) {
  const double samples_a_turn = s.sample_rate_hz * units::revolution / speed_rad_per_s;
  const double turns = std::floor(0.5 * static_cast<double>(s.force_n.rows()) / samples_a_turn);
  const auto last = static_cast<Eigen::Index>(std::lround(turns * samples_a_turn));
  return s.force_n.bottomRows(last).colwise().mean();
}

/// What lobes --at, simulate and forces say of one point.
void expect_one_cut(const RandomCut& c, const std::filesystem::path& lobes, const stability::OperatingPoint& at,
                    const Folder& folder, const std::string& seed) {
  const process::ForcesResult forces = run_forces(folder.file("forces.toml", forces_text(c, at)), {}, {});
  const cutting::CuttingForce& force = forces.revolution->deflected.force;
  // Chips as a rigid cutter cuts them: vibration of teeth that differ, or that leave the cut, changes the mean.
  // Slices of its own choice are few enough for the vibration, and their steps raise the peak of a helix by up to 2 %.
  const SimulateResult in_time = run_simulate(
      {.lobes = lobes,
       .point = at,
       .options = {
           .seconds = 0.25, .sample_rate_hz = 20480.0, .loss_of_contact = false, .regeneration = false, .slices = 24}});
  const LobesFile read = read_lobes(lobes);
  if (!read.problem.spatial) {
    const double torque_n_m = decision::mean_torque_of(read.problem.milling)(at.axial_depth_m);
    expect_within(torque_n_m, force.mean_torque_n_m, seed + ": mean torque of the decision");
  }
  const Eigen::Vector3d mean = mean_force(in_time.simulation, at.spindle_speed_rad_per_s);
  EXPECT_LE((mean - force.mean_n).norm(), 0.01 * force.rms_n.norm()) << seed << ": simulate's mean force";
  // Means over a degree, as forces gives them, are lower where the peak is sharp.
  const cutting::Engagement engagement = cutting::engage(forces.cut.cutter, forces.cut.cut);
  const cutting::CuttingForce fine = cutting::cutting_force(forces.cut.cutter, engagement, forces.cut.coefficients,
                                                            forces.cut.motion, {.steps = 3600});
  EXPECT_NEAR(fine.peak_force_n, force.peak_force_n, 0.02 * force.peak_force_n) << seed << ": peak force";
  expect_within(in_time.simulation.vibrating_peak_force_n, fine.peak_force_n, seed + ": simulate's peak force");
}

/// Of the cuts, so that processors share them.
constexpr int parts = 4;
class RandomCuts : public ::testing::TestWithParam<int> {};

// Flat ends: plan, lobes --at, forces, simulate and what the monitor advises from.
TEST_P(RandomCuts, AreTheSameInEveryVerb) {
  const Folder folder;
  Random random(17 + static_cast<std::uint64_t>(GetParam()));
  const int seeds = test::seeds(25);
  for (int i = 0; i < seeds; ++i) {
    const int n = GetParam() + parts * i;
    const std::string seed = fmt::format("seed {}", n);
    const RandomCut c = random_cut(random, n);
    const auto lobes = folder.file("lobes.toml", lobes_text(c));
    if (!c.planned) {
      const stability::OperatingPoint at{random.uniform(6000.0, 12000.0) * units::rpm, 1e-3};
      expect_one_cut(c, lobes, at, folder, seed);
      continue;
    }
    const auto job = folder.file(
        "job.toml",
        "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\n[safety]\nspeed_window = 0\ndepth_margin = 0.4\n");
    const LobesFile read = read_milling(lobes);
    folder.file("modes.json", modal::modes_json(read.problem.dynamics));
    const PlanResult plan = run_job(job, 1);
    ASSERT_TRUE(plan.recommendation.recommended) << seed << plan.recommendation.reason;
    const decision::Operation& op = *plan.recommendation.recommended;
    const stability::OperatingPoint at{op.spindle_speed_rad_per_s, op.axial_depth_m};
    const LobesJobResult of_cut = run_lobes({.lobes = lobes, .points = {at}});
    const stability::PointResult& point = of_cut.lobes.points.front();
    EXPECT_TRUE(point.stable) << seed;
    if (std::isfinite(point.limit_depth_m)) {
      expect_within(op.limit_depth_m, point.limit_depth_m, seed + ": limit");
      expect_within(op.margin, 1.0 - op.axial_depth_m / point.limit_depth_m, seed + ": margin");
      const stability::PointResult limit = stability::evaluate_point(
          read.problem, read.options,
          {.spindle_speed_rad_per_s = at.spindle_speed_rad_per_s, .axial_depth_m = op.limit_depth_m});
      expect_within(op.chatter_frequency_hz, limit.chatter_frequency_hz, seed + ": chatter frequency at the limit");
    }
    const process::ForcesResult forces = run_forces(folder.file("forces.toml", forces_text(c, at)), {}, {});
    const cutting::CuttingForce& force = forces.revolution->deflected.force;
    expect_within(op.torque_n_m, force.mean_torque_n_m, seed + ": mean torque");
    expect_within(op.power_w, force.power_w, seed + ": mean power");
    expect_within(op.removal_rate_m3_per_s, force.removal_rate_m3_per_s, seed + ": removal rate");
    expect_one_cut(c, lobes, at, folder, seed);

    // The same tables in one document.
    const auto whole =
        folder.file("whole.toml", "[job]\nmodes = \"modes.json\"\n[safety]\nspeed_window = 0\ndepth_margin = 0.4\n" +
                                      chart + forces_text(c, at));
    const PlanResult same = run_job(whole, 1);
    ASSERT_TRUE(same.recommendation.recommended) << seed;
    EXPECT_EQ(same.recommendation.recommended->axial_depth_m, op.axial_depth_m) << seed;
    EXPECT_EQ(same.recommendation.recommended->torque_n_m, op.torque_n_m) << seed;
    const LobesJobResult of_job = run_lobes({.lobes = whole, .points = {at}});
    EXPECT_EQ(std::isfinite(of_job.lobes.points.front().limit_depth_m), std::isfinite(point.limit_depth_m)) << seed;
    if (std::isfinite(point.limit_depth_m)) {
      expect_within(of_job.lobes.points.front().limit_depth_m, point.limit_depth_m, seed + ": limit of the job");
    }
    EXPECT_EQ(run_forces(whole, {}, {}).revolution->deflected.force.peak_force_n, force.peak_force_n) << seed;

    monitor::MonitorFile monitor;
    monitor.lobes = lobes;
    monitor.options.sample_rate_hz = 10240.0;
    monitor.options.spindle_speed_rad_per_s = op.spindle_speed_rad_per_s;
    const live::AdviceBasis basis = read_advice_basis(monitor, Progress::none());
    ASSERT_TRUE(basis.lobes) << seed;
    for (std::size_t k = 0; k < basis.lobes->limit.size(); ++k) {
      const stability::Limit &advised = basis.lobes->limit[k], &planned = plan.lobes.limit[k];
      ASSERT_EQ(advised.status, planned.status) << seed;
      expect_within(advised.axial_depth_m, planned.axial_depth_m, seed + ": the monitor's limit");
      expect_within(advised.chatter_frequency_hz, planned.chatter_frequency_hz, seed + ": its chatter frequency");
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Parts, RandomCuts, ::testing::Range(0, parts));

}  // namespace one_cut_test
}  // namespace robomill::jobs
