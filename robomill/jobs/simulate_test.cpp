#include "robomill/jobs/simulate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <complex>
#include <numbers>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/simulation/drilling.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::jobs {
namespace simulate_test {

using test::rejection;
using test_support::replaced;

const std::string feed = "feed_per_tooth_mm = 0.05\n";

std::string milling(const std::string& dynamics) {
  return "[tool]\nteeth = 2\ndiameter_mm = 12\n[cut]\ndirection = \"up\"\nradial_depth_mm = 1.8\n" + feed +
         "[coefficients]\ntangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n"
         "[lobes]\nspindle_speed_rpm = [6000, 9000]\naxial_depth_mm = [0, 3]\n[dynamics]\n" +
         dynamics;
}
const std::string one_mode = "x = [{ frequency_hz = 922, damping_ratio = 0.011, modal_mass_kg = 0.03993 }]\ny = []\n";

SimulateJob job_of(const std::filesystem::path& lobes, double depth_mm = 0.3) {
  return {.lobes = lobes,
          .point = {6500 * units::rpm, depth_mm * units::mm},
          .options = {.seconds = 0.1, .sample_rate_hz = 5000.0}};
}

TEST(RunSimulate, IsTheStagesOwnSimulationOfTheFile) {
  const test::Folder folder;
  const SimulateJob job = job_of(
      folder.file("lobes.toml",
                  milling(one_mode) +
                      "[workpiece_dynamics]\ny = [{ frequency_hz = 300, damping_ratio = 0.02, modal_mass_kg = 2 }]\n"));
  const SimulateResult result = run_simulate(job);
  EXPECT_FALSE(result.fit || result.workpiece_fit);
  const stability::LobesProblem& problem = result.cut.problem;
  const simulation::MillingCut cut = {
      .milling = problem.milling,
      .structure = modal::joined(modal::tip_modes(problem.dynamics, {}, 0.0),
                                 modal::tip_modes(problem.workpiece_dynamics, {}, 0.0, modal::ModeOwner::workpiece)),
      .spindle_speed_rad_per_s = 6500 * units::rpm,
      .axial_depth_m = 0.3 * units::mm};
  const simulation::Simulation direct = simulation::simulate(cut, job.options);
  EXPECT_TRUE(result.simulation.displacement_m == direct.displacement_m);
  EXPECT_EQ(result.simulation.small.spectral_radius, direct.small.spectral_radius);
}

TEST(RunSimulate, DrillsWhereTheFileSaysSo) {
  const test::Folder folder;
  const SimulateJob job = job_of(
      folder.file("drill.toml",
                  "[tool]\nteeth = 2\ndiameter_mm = 10\n[cut]\nkind = \"drilling\"\nfeed_per_revolution_mm = 0.1\n"
                  "[coefficients]\ntangential_n_per_mm2 = 900\nradial_n_per_mm2 = 500\n"
                  "[dynamics]\nx = [{ frequency_hz = 400, damping_ratio = 0.03, modal_mass_kg = 0.3 }]\n"
                  "z = [{ frequency_hz = 900, damping_ratio = 0.03, modal_mass_kg = 0.5 }]\n"
                  "[lobes]\nspindle_speed_rpm = [1000, 5000]\naxial_depth_mm = [0, 5]\n"),
      1.0);
  const SimulateResult result = run_simulate(job);
  simulation::DrillingCut cut;
  cut.diameter_m = 10 * units::mm;
  cut.radial_width_m = 1 * units::mm;
  cut.feed_per_revolution_m = 0.1 * units::mm;
  cut.coefficients = result.cut.problem.milling.coefficients;
  cut.structure = modal::tip_modes(result.cut.problem.dynamics, {}, 0.0);
  cut.spindle_speed_rad_per_s = 6500 * units::rpm;
  EXPECT_TRUE(result.simulation.force_n == simulation::simulate(cut, job.options).force_n);
}

// The mode of the other file, as its receptance.
TEST(RunSimulate, FitsModesToFrfs) {
  const test::Folder folder;
  std::string csv = "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n";
  const double natural = 2.0 * std::numbers::pi * 922.0;
  for (int line = 400; line <= 4000; ++line) {
    const double omega = std::numbers::pi * line;
    const std::complex<double> h =
        1e9 / (0.03993 * std::complex<double>(natural * natural - omega * omega, 0.022 * natural * omega));
    csv += fmt::format("{},{:.6f}e-9,{:.6f}e-9\n", 0.5 * line, h.real(), h.imag());
  }
  folder.file("tip.csv", csv);
  const SimulateResult fitted =
      run_simulate(job_of(folder.file("frf.toml", milling("frf = \"tip.csv\"\nrigid_directions = [\"y\"]\n"))));
  ASSERT_TRUE(fitted.fit);
  EXPECT_FALSE(fitted.workpiece_fit || fitted.cut.problem.has_measured());
  ASSERT_EQ(fitted.cut.problem.dynamics.modes.size(), 1U);
  EXPECT_NEAR(fitted.cut.problem.dynamics.modes[0].frequency_hz, 922.0, 0.1);
  EXPECT_TRUE(fitted.cut.notes.empty());
  EXPECT_EQ(fitted.cut.assumed.back().what, "Direction y, not measured");
  const SimulateResult known = run_simulate(job_of(folder.file("modes.toml", milling(one_mode))));
  EXPECT_EQ(fitted.simulation.verdict, known.simulation.verdict);
  EXPECT_NEAR(fitted.simulation.small.spectral_radius, known.simulation.small.spectral_radius, 1e-3);
}

// They stand in no document.
TEST(RunSimulate, NamesOptionsAsTheCommandLineDoes) {
  const test::Folder folder;
  SimulateJob job = job_of(folder.file("lobes.toml", milling(one_mode)));
  const auto rejects = [&] { return rejection([&] { static_cast<void>(run_simulate(job)); }); };
  job.options.seconds = 1e20;
  EXPECT_EQ(rejects(), "--seconds = 1e+20 s; must be at most 1e7 s. No cut takes a hundred days");
  job.options.seconds = 1e6;
  EXPECT_TRUE(rejects().starts_with("--seconds = 1e+06 s; would take about ")) << rejects();
  job.options = {.seconds = 1.0, .sample_rate_hz = 2e7};
  EXPECT_EQ(rejects(), "--sample-rate-hz = 2e+07 Hz; must be at most 10 MHz");
  job.options = {};
  job.point.spindle_speed_rad_per_s = 0.5 * units::rpm;
  EXPECT_TRUE(rejects().starts_with("--at = 0.5 rpm; must be at least 1 rpm")) << rejects();
}

TEST(RunSimulate, RejectsAMissingFileAndACutWithoutFeed) {
  const test::Folder folder;
  const auto rejects = [](const std::filesystem::path& path) {
    return rejection([&] { static_cast<void>(run_simulate(job_of(path))); });
  };
  EXPECT_NE(rejects(folder.at("missing.toml")).find("missing.toml"), std::string::npos);
  const std::string said = rejects(folder.file("lobes.toml", replaced(milling(one_mode), feed, "")));
  EXPECT_NE(said.find("lobes.toml: cut.feed_per_tooth_mm: must be given and > 0"), std::string::npos) << said;
}

}  // namespace simulate_test
}  // namespace robomill::jobs
