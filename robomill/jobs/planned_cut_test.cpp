// One structure, range and margin behind the plan of a job, its chart and the advice of its monitor.
#include "robomill/jobs/planned_cut.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/monitor.hpp"
#include "robomill/live/advisor.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/stability/forced_vibration.hpp"
#include "robomill/stability/lobes.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace planned_cut_test {

/// A cut with modes of its own that are stiff: what a template would show.
std::string lobes_text(const std::string& dynamics) {
  return "[tool]\nteeth = 3\ndiameter_mm = 12\n[cut]\ndirection = \"down\"\nradial_depth_mm = 6\n"
         "feed_per_tooth_mm = 0.05\n[coefficients]\ntangential_n_per_mm2 = 700\nradial_n_per_mm2 = 200\n[dynamics]\n" +
         dynamics + "[lobes]\nspindle_speed_rpm = [5000, 15000]\naxial_depth_mm = [0, 6]\ngrid = [60, 40]\n";
}
const std::string stiff =
    "x = [{ frequency_hz = 620, damping_ratio = 0.03, modal_mass_kg = 9 }]\n"
    "y = [{ frequency_hz = 660, damping_ratio = 0.03, modal_mass_kg = 9 }]\n";

class Planned : public ::testing::Test {
 protected:
  /// A job that starts from modes which were measured.
  std::filesystem::path job(double frequency_hz, double mass_kg, const std::string& more = {}) {
    const std::string mode =
        fmt::format("[{{ frequency_hz = {}, damping_ratio = 0.02, modal_mass_kg = {} }}]\n", frequency_hz, mass_kg);
    const LobesFile measured = read_lobes(folder_.file("measured.toml", lobes_text("x = " + mode + "y = " + mode)));
    folder_.file("modes.json", modal::modes_json(measured.problem.dynamics));
    return folder_.file("job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\n" + more);
  }
  live::AdviceBasis basis(const std::filesystem::path& lobes) {
    monitor::MonitorFile file;
    file.options.sample_rate_hz = 10'240.0;
    file.anti_alias_filter = true;
    file.lobes = lobes;
    return read_advice_basis(file, Progress::none());
  }

  static bool has(const std::vector<std::string>& notes, const std::string& text) {
    return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(text) != std::string::npos; });
  }

  test::Folder folder_;
};

// One file of modes in job and cut is one structure.
TEST_F(Planned, TheSameModesAreNoOtherStructure) {
  static_cast<void>(job(500.0, 0.5));
  const auto lobes = folder_.file("lobes.toml", lobes_text("modes = \"modes.json\"\n"));
  EXPECT_FALSE(has(run_lobes({.lobes = lobes}).cut.notes, "plans this cut"));
}

TEST_F(Planned, TheJobIsTheOneDocumentThatNamesTheCut) {
  const auto lobes = folder_.file("lobes.toml", lobes_text(stiff));
  folder_.file("broken.toml", "[job\nlobes = \"lobes.toml\"\n");
  folder_.file("other.toml", "[job]\nmodes = \"m.json\"\nlobes = \"another.toml\"\n");
  folder_.file("unmeasured.toml", "[job]\nhits = \"hits.toml\"\nlobes = \"lobes.toml\"\n");
  EXPECT_TRUE(jobs_of_cut(lobes).empty());
  const auto one = job(500.0, 0.5);
  EXPECT_EQ(jobs_of_cut(lobes), std::vector{one});
  EXPECT_TRUE(has(basis(lobes).notes, "The structure and the range of speeds are those of job.toml."));
  folder_.file("second.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\n");
  EXPECT_EQ(jobs_of_cut(lobes).size(), 2U) << "either may be meant";
  EXPECT_TRUE(has(basis(lobes).notes,
                  "job.toml and second.toml plan the cut of lobes.toml: the structure of none of them was taken"));
}

TEST_F(Planned, TakesStructureRangeAndMarginOfTheJob) {
  const auto lobes = folder_.file("lobes.toml", lobes_text(stiff));
  const auto path = job(500.0, 0.5,
                        "[spindle]\nmin_speed_rpm = 6000\nmax_speed_rpm = 18000\n[safety]\ndepth_margin = 0.4\n"
                        "speed_window = 0.05\n");
  LobesFile cut = read_lobes(lobes);
  take_plan(cut, run_structure(path, 1));
  ASSERT_EQ(cut.problem.dynamics.modes.size(), 2U);
  EXPECT_DOUBLE_EQ(cut.problem.dynamics.modes[0].frequency_hz, 500.0);
  // The chart's range and the spindle's, as a plan searches them.
  EXPECT_NEAR(cut.options.spindle_speed_rad_per_s[0] / units::rpm, 5000.0, 1e-9);
  EXPECT_NEAR(cut.options.spindle_speed_rad_per_s[1] / units::rpm, 18000.0, 1e-9);
  const live::AdviceBasis advised = basis(lobes);
  EXPECT_EQ(advised.depth_margin, 0.4);
  EXPECT_EQ(advised.speed_window, 0.05);
  EXPECT_NEAR(advised.lowest_rad_per_s / units::rpm, 6000.0, 1e-9);
  EXPECT_NEAR(advised.highest_rad_per_s / units::rpm, 18000.0, 1e-9);
  EXPECT_DOUBLE_EQ(advised.modes->modes[0].frequency_hz, 500.0);
  // The chart of the file alone says that it is another structure.
  const LobesJobResult alone = run_lobes({.lobes = lobes});
  ASSERT_FALSE(alone.cut.notes.empty());
  EXPECT_NE(alone.cut.notes.back().find("job.toml plans this cut with the structure of its own measurement"),
            std::string::npos);
}

// The tables of a job in one file, in files that it includes, or in files that it names: one cut.
TEST_F(Planned, TheTablesOfAJobStandWhereverTheUserPutsThem) {
  const std::string spindle = "[safety]\nspeed_window = 0\n[spindle]\nmin_speed_rpm = 6000\nmax_speed_rpm = 18000\n";
  const auto named = job(500.0, 0.5, spindle);
  folder_.file("lobes.toml", lobes_text(""));
  const auto whole = folder_.file("whole.toml", "[job]\nmodes = \"modes.json\"\n" + spindle + lobes_text(""));
  const auto included =
      folder_.file("included.toml", "include = \"lobes.toml\"\n[job]\nmodes = \"modes.json\"\n" + spindle);
  const auto bare = folder_.file("bare.toml", "[job]\n" + spindle + lobes_text("modes = \"modes.json\"\n"));
  const PlanResult plan = run_job(named, 1);
  ASSERT_TRUE(plan.recommendation.recommended);
  const decision::Operation& op = *plan.recommendation.recommended;
  const std::string mode = "[{ frequency_hz = 500, damping_ratio = 0.02, modal_mass_kg = 0.5 }]\n";
  const auto inside = folder_.file("inside.toml", "[job]\n" + spindle + lobes_text("x = " + mode + "y = " + mode));
  for (const auto& document : {named, whole, included, bare, inside}) {
    const PlanResult same = run_job(document, 1);
    EXPECT_NEAR(same.recommendation.recommended->axial_depth_m, op.axial_depth_m, 1e-9) << document;
    EXPECT_NEAR(same.recommendation.recommended->spindle_speed_rad_per_s, op.spindle_speed_rad_per_s, 1e-6) << document;
    // Its chart and its monitor take the job itself.
    const stability::OperatingPoint at{op.spindle_speed_rad_per_s, op.axial_depth_m};
    const LobesJobResult chart = run_lobes({.lobes = document, .points = {at}});
    EXPECT_NEAR(chart.lobes.points.front().limit_depth_m, op.limit_depth_m, 1e-3 * op.limit_depth_m) << document;
    const live::AdviceBasis advised = basis(document);
    ASSERT_EQ(advised.lobes->limit.size(), plan.lobes.limit.size()) << document;
    for (std::size_t i = 0; i < plan.lobes.limit.size(); ++i) {
      EXPECT_NEAR(advised.lobes->limit[i].axial_depth_m, plan.lobes.limit[i].axial_depth_m, 1e-8);
      EXPECT_NEAR(chart.lobes.limit[i].axial_depth_m, plan.lobes.limit[i].axial_depth_m, 1e-8);
    }
    EXPECT_NEAR(advised.lowest_rad_per_s / units::rpm, 6000.0, 1e-9) << document;
  }
}

// Teeth, modes and lobes of a job's monitor are those of the job.
TEST_F(Planned, TheMonitorOfAJobIsReadFromTheJob) {
  static_cast<void>(job(500.0, 0.5));
  const auto document =
      folder_.file("whole.toml",
                   "[job]\nmodes = \"modes.json\"\n[signal]\nsample_rate_hz = 10240\nchannels = [\"ax\"]\n[process]\n"
                   "spindle_speed_rpm = 9000\n" +
                       lobes_text(""));
  const monitor::MonitorFile monitor = monitor::read_monitor(document);
  EXPECT_EQ(monitor.lobes, document);
  const live::AdviceBasis advised = read_advice_basis(monitor, Progress::none());
  EXPECT_EQ(advised.teeth, 3);
  EXPECT_DOUBLE_EQ(advised.modes->modes[0].frequency_hz, 500.0);
}

// A blank cut has no structure: a job brings it, alone it is rejected.
TEST_F(Planned, ACutWithoutAStructureNeedsItsJob) {
  const auto lobes = folder_.file("lobes.toml", lobes_text(""));
  const std::string said = test::rejection([&] { static_cast<void>(basis(lobes)); });
  EXPECT_NE(said.find("lobes.toml:11: dynamics"), std::string::npos) << said;
  static_cast<void>(job(500.0, 0.5));
  EXPECT_FALSE(basis(lobes).lobes->limit.empty());
}

// Whatever the structure: what the monitor suggests is stable by the plan's own, with its margin to the limit.
TEST_F(Planned, WhatIsSuggestedIsStable) {
  for (int seed = 1; seed <= test::seeds(100); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const auto lobes = folder_.file("lobes.toml", lobes_text(stiff));
    const auto path = job(random.uniform(300.0, 1500.0), random.uniform(0.1, 1.0));
    LobesFile cut = read_lobes(lobes);
    take_plan(cut, run_structure(path, 1));
    const live::Advisor advisor(basis(lobes));
    monitor::MonitorEvent event;
    event.decision.spindle_speed_rad_per_s = random.uniform(6000.0, 14000.0) * units::rpm;
    event.decision.chatter_frequency_hz = 1.02 * cut.problem.dynamics.modes[0].frequency_hz;
    event.decision.chatter_frequency_std_hz = 2.0;
    advisor.advise(event);
    if (!(event.suggested_spindle_speed_rad_per_s > 0.0) || !(event.suggested_axial_depth_m > 0.0)) continue;
    for (const double off : {0.98, 0.99, 1.0, 1.01, 1.02}) {
      const double radius =
          stability::evaluate_point(cut.problem, cut.options,
                                    {off * event.suggested_spindle_speed_rad_per_s, event.suggested_axial_depth_m})
              .spectral_radius;
      EXPECT_LT(radius, 1.0) << seed << ' ' << off;
    }
  }
}

// In the pockets of the chart tooth passing meets the mode. With small chips it is forced vibration that limits what
// may be suggested there.
TEST_F(Planned, WhatIsSuggestedVibratesLessThanTheFeed) {
  int limited = 0;
  for (int seed = 1; seed <= test::seeds(60); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string text = lobes_text(stiff);
    text.replace(text.find("0.05"), 4, fmt::format("{:.3f}", random.uniform(0.005, 0.03)));
    const auto lobes = folder_.file("lobes.toml", text);
    const auto path = job(random.uniform(300.0, 900.0), random.uniform(0.3, 1.0));
    LobesFile cut = read_lobes(lobes);
    take_plan(cut, run_structure(path, 1));
    monitor::MonitorEvent event;
    event.decision.spindle_speed_rad_per_s = random.uniform(6000.0, 14000.0) * units::rpm;
    event.decision.chatter_frequency_hz = 1.02 * cut.problem.dynamics.modes[0].frequency_hz;
    event.decision.chatter_frequency_std_hz = 2.0;
    live::Advisor(basis(lobes)).advise(event);
    if (!(event.suggested_axial_depth_m > 0.0)) continue;
    const stability::ForcedResponse response(cut.problem);
    double widest_m = 0.0;
    for (const double off : {0.98, 0.985, 0.99, 0.995, 1.0, 1.005, 1.01, 1.015, 1.02}) {
      const double speed = off * event.suggested_spindle_speed_rad_per_s;
      widest_m = std::max(widest_m, response.at({speed, event.suggested_axial_depth_m}).amplitude_m);
    }
    EXPECT_LE(widest_m, 1.01 * cut.problem.milling.feed_per_tooth_m) << seed;
    if (widest_m > 0.7 * cut.problem.milling.feed_per_tooth_m) ++limited;
  }
  EXPECT_GT(limited, 0) << "no suggestion comes near the limit";
}

}  // namespace planned_cut_test
}  // namespace robomill::jobs
