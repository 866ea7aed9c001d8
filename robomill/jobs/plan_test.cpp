#include "robomill/jobs/plan.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "robomill/base/cost.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/files/in_words.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/jobs/lobes_file.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::jobs {
namespace plan_test {

const std::string data = ROBOMILL_SOURCE_DIR "/data/";

class Plan : public ::testing::Test {
 protected:
  void SetUp() override {
    write("lobes.toml", test_support::lobes_file(R"(spindle_speed_rpm = [6000, 9000]
axial_depth_mm = [0, 3]
grid = [31, 20]
method = "semi-discretization"
intervals = 20
)"));
  }

  std::filesystem::path write(const std::string& name, const std::string& text) { return folder_.file(name, text); }
  std::filesystem::path job(const std::string& more = "") {
    return write("job.toml", "[job]\nmodes = \"" + data + "robot-modes.toml\"\nlobes = \"lobes.toml\"\n" + more);
  }

  /// Writes H_xx of the robot from 0 Hz on, without a header.
  modal::Frf write_xx() {
    const modal::FrfSet set = modal::synthesize(data::robot_modes(), Eigen::VectorXd::LinSpaced(2801, 0.0, 700.0));
    const modal::Frf& xx = *set.find(modal::parse_frf_name("xx"));
    std::ofstream file(folder_.at("xx.txt"));
    file.precision(15);
    for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
      file << set.frequency_hz(i) << ' ' << xx.receptance(i).real() << ' ' << xx.receptance(i).imag() << '\n';
    }
    return xx;
  }

  test::Folder folder_;
};

// What is promised: over ± 2 % of speed the recommended depth is at most 80 % of the limit, so at 1.2 times it the cut
// is stable.
TEST_F(Plan, RecommendsADepthBelowTheLimitOfTheWholeWindow) {
  const PlanResult result = run_job(job(), 1);
  ASSERT_EQ(result.recommendation.status, decision::Recommendation::Status::found);
  const decision::Operation& op = *result.recommendation.recommended;
  EXPECT_GT(op.axial_depth_m, 0.0);
  for (const double part : {-0.02, -0.01, 0.0, 0.01, 0.02}) {
    const stability::PointResult point =
        stability::evaluate_point(result.cut.problem, result.cut.options,
                                  {.spindle_speed_rad_per_s = op.spindle_speed_rad_per_s * (1.0 + part),
                                   .axial_depth_m = 1.2 * op.axial_depth_m});
    EXPECT_TRUE(point.stable) << part;
  }
  EXPECT_EQ(result.pairs.size(), 4U);
}

// A chart of a part of the spindle's speeds does not keep the best one from being found, and it is said what was
// searched.
TEST_F(Plan, SearchesTheSpindlesSpeeds) {
  const PlanResult narrow = run_job(job(), 1);
  const PlanResult wide = run_job(job("[spindle]\nmin_speed_rpm = 5000\nmax_speed_rpm = 16000\n"), 1);
  EXPECT_NEAR(wide.lobes.spindle_speed_rad_per_s(0), 5000.0 * units::rpm, 1e-9);
  EXPECT_NEAR(wide.lobes.spindle_speed_rad_per_s.tail(1)(0), 16000.0 * units::rpm, 1e-9);
  EXPECT_EQ(wide.lobes.limit.size(), 114U) << "as many speeds to 1,000 rpm as before";
  EXPECT_GT(wide.recommendation.recommended->removal_rate_m3_per_s,
            narrow.recommendation.recommended->removal_rate_m3_per_s);
  const auto says = [](const PlanResult& result, const char* words) {
    return std::ranges::any_of(result.notes, [&](const std::string& n) { return n.find(words) != std::string::npos; });
  };
  EXPECT_TRUE(says(wide, "the spindle from 5000 to 16000 rpm: 5000 to 16000 rpm were searched"));
  EXPECT_FALSE(says(narrow, "searched"));
  const PlanResult slow = run_job(job("[spindle]\nmin_speed_rpm = 100\nmax_speed_rpm = 9000\n"), 1);
  EXPECT_TRUE(says(slow, "900 to 9000 rpm were searched. Slower ones were not."));
}

// Where the chart ends before any chatter, the depths that the cutter has are searched.
TEST_F(Plan, SearchesTheCuttersDepths) {
  write("lobes.toml", test_support::lobes_file(R"(spindle_speed_rpm = [6000, 9000]
axial_depth_mm = [0, 0.1]
grid = [31, 10]
)"));
  const PlanResult shallow = run_job(job(), 1);
  EXPECT_EQ(shallow.recommendation.recommended->limited_by, decision::LimitedBy::depth_range);
  const PlanResult deep = run_job(job("[tool]\nmax_axial_depth_mm = 3\n"), 1);
  EXPECT_EQ(deep.recommendation.recommended->limited_by, decision::LimitedBy::chatter);
  EXPECT_GT(deep.recommendation.recommended->axial_depth_m, shallow.recommendation.recommended->axial_depth_m);
}

// Three modes of the part, softer than any of the tool's: with keep_modes its numbers are those of tool modes that take
// no part. What limits is named by structure and number, and each limit counts for the mode that it names.
TEST_F(Plan, ModesOfTheWorkpieceAreNotThoseOfTheTool) {
  const std::string part =
      "[workpiece_dynamics]\ny = [{ frequency_hz = 400, damping_ratio = 0.005, modal_mass_kg = 0.01 }, "
      "{ frequency_hz = 460, damping_ratio = 0.005, modal_mass_kg = 0.01 }, "
      "{ frequency_hz = 520, damping_ratio = 0.005, modal_mass_kg = 0.001 }]\n";
  const std::string lobes = io::read_file(folder_.at("lobes.toml"));
  for (const std::string& kept : {std::string(), std::string("[dynamics]\nkeep_modes = [1, 7]\n")}) {
    write("lobes.toml", lobes + kept + part);
    const PlanResult result = run_job(job(), 1);
    const decision::LimitShare share =
        decision::limit_share(result.lobes.limit, result.model, result.cut.problem.workpiece_dynamics);
    ASSERT_EQ(share.tool.size(), 8);
    ASSERT_EQ(share.workpiece.size(), 3);
    decision::LimitShare counted = {Eigen::VectorXd::Zero(8), Eigen::VectorXd::Zero(3)};
    double found = 0.0;
    for (const stability::Limit& limit : result.lobes.limit) {
      if (limit.status != stability::Limit::Status::found) continue;
      const bool of_tool = limit.mode.of == modal::ModeOwner::tool;
      ASSERT_GE(limit.mode.number, 1);
      ASSERT_LE(limit.mode.number, of_tool ? 8 : 3);
      EXPECT_TRUE(!of_tool || kept.empty() || limit.mode.number == 1 || limit.mode.number == 7);
      (of_tool ? counted.tool : counted.workpiece)(limit.mode.number - 1) += 1.0;
      found += 1.0;
    }
    EXPECT_GT(counted.workpiece.sum(), 0.0);
    EXPECT_LT((share.tool - counted.tool / found).norm(), 1e-12);
    EXPECT_LT((share.workpiece - counted.workpiece / found).norm(), 1e-12);

    const auto json = nlohmann::json::parse(plan_json(result));
    for (std::size_t i = 0; i < result.lobes.limit.size(); ++i) {
      const stability::Limit& limit = result.lobes.limit[i];
      if (!limit.mode.known()) continue;
      EXPECT_EQ(json["lobes"]["limit"][i]["mode"], limit.mode.number);
      EXPECT_EQ(json["lobes"]["limit"][i]["mode_of"], to_string(limit.mode.of));
    }
    const auto page = nlohmann::json::parse(page::report_json(make_report(result, {})));
    EXPECT_EQ(page["modes"]["modes"].size(), 8U);
    ASSERT_EQ(page["workpiece_modes"]["modes"].size(), 3U);
    EXPECT_EQ(page["workpiece_modes"]["modes"][1]["frequency_hz"], 460);
    EXPECT_EQ(page["plan"]["limit_share"]["workpiece"].size(), 3U);
  }
}

// The plan computes half a turn and mirrors it; the other half computed gives the same.
TEST_F(Plan, LimitOverFeedDirectionIsThatOfTheTurnedProblem) {
  const PlanResult result = run_job(job(), 1);
  const decision::FeedDirections& turned = *result.feed_directions;
  const double speed = result.recommendation.recommended->spindle_speed_rad_per_s;
  ASSERT_EQ(turned.direction_rad.size(), 36);
  for (const Eigen::Index i : {5, 20, 30}) {
    stability::LobesProblem problem = result.cut.problem;
    problem.feed_direction_rad = turned.direction_rad(i);
    const stability::Limit limit = stability::limit_depths(problem, result.cut.options, {speed}).front();
    if (limit.status == stability::Limit::Status::found) {
      EXPECT_NEAR(turned.limit_at_speed_m(i), limit.axial_depth_m, 2e-3 * limit.axial_depth_m);
    } else {
      EXPECT_TRUE(std::isnan(turned.limit_at_speed_m(i)));
    }
  }
  EXPECT_GT(turned.lowest_limit_m.maxCoeff(), 1.05 * turned.lowest_limit_m.minCoeff());
}

TEST_F(Plan, WritesEveryFileAndTheyAgree) {
  const PlanResult result =
      run_job(job("[[cuts]]\nspindle_speed_rpm = 8000\naxial_depth_mm = 2.9\nresult = \"chatter\"\n"), 1);
  write_plan(folder_.at("out"), result);
  const auto json = nlohmann::json::parse(io::read_file(folder_.at("out") / "plan.json"));
  EXPECT_NEAR(json["recommended"]["spindle_speed_rpm"].get<double>(),
              result.recommendation.recommended->spindle_speed_rad_per_s / units::rpm, 1e-6);
  EXPECT_GE(json["recommended"]["margin"].get<double>(), 0.2 - 1e-12);
  EXPECT_EQ(json["modes"]["modes"].size(), 8U);
  EXPECT_EQ(json["lobes"]["limit"].size(), 31U);
  EXPECT_EQ(json["cuts"].size(), 1U);
  EXPECT_EQ(json["cuts"][0]["agrees"], json["cuts"][0]["predicted"] == "chatter");
  for (const char* name : {"modes.json", "lobes.json", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_.at("out") / name)) << name;
  }
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder_.at("out"))) ++files;
  EXPECT_EQ(files, 4U);
}

// Nothing is computed from a structure of which one direction is not known, before somebody says what it is.
TEST_F(Plan, ADirectionThatWasNotMeasuredHasToBeSaid) {
  write_xx();
  const std::string source = "[job]\nfrf = \"xx.txt\"\nlobes = \"lobes.toml\"\nband_hz = [400, 650]\nfit_modes = 2\n";
  const auto plan = [&](const std::string& more) { return run_job(write("job.toml", source + more), 1); };
  const std::string said = test::rejection([&] { static_cast<void>(plan("")); });
  EXPECT_NE(said.find("job.toml: job: nothing is known of y"), std::string::npos) << said;
  EXPECT_NE(said.find("rigid_directions = [\"y\"]"), std::string::npos) << said;
  const PlanResult rigid = plan("rigid_directions = [\"y\"]\n");
  EXPECT_EQ(rigid.model.modes.size(), 2U);
  EXPECT_TRUE(std::ranges::any_of(rigid.assumed, [](const Assumption& one) {
    return one.what == "Direction y, not measured" && one.taken == "rigid" && one.key == "job.rigid_directions";
  }));
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(plan("rigid_directions = [\"x\"]\n"));
            }).find("job.rigid_directions: names x, which was measured"),
            std::string::npos);
  const std::string both = test::rejection([&] { static_cast<void>(run_job(job("equal_directions = true\n"), 1)); });
  EXPECT_NE(both.find("job.toml: job.equal_directions: needs FRFs or modes of one direction"), std::string::npos)
      << both;
}

// One mode for a band full of them: the plan ends with the fit, and what an earlier run made of better modes goes.
TEST_F(Plan, ComputesNothingFromModesThatDoNotDescribeTheFrfs) {
  write_xx();
  const std::filesystem::path out = folder_.at("out");
  const auto file = write("job.toml",
                          "[job]\nfrf = \"xx.txt\"\nlobes = \"lobes.toml\"\nband_hz = [5, 700]\nfit_modes = 1\n"
                          "equal_directions = true\n");
  const PlanResult accepted = run_job(file, 1, Progress::none(), out, true);
  EXPECT_GT(accepted.fit->relative_error, modal::unusable_fit_error);
  EXPECT_TRUE(accepted.has_lobes());
  write_plan(out, accepted);
  EXPECT_TRUE(std::filesystem::exists(out / "lobes.json"));

  const PlanResult ended = run_job(file, 1, Progress::none(), out);
  EXPECT_FALSE(ended.has_lobes());
  EXPECT_EQ(ended.recommendation.status, decision::Recommendation::Status::no_safe_depth);
  EXPECT_NE(ended.recommendation.reason.find("--accept-fit"), std::string::npos) << ended.recommendation.reason;
  write_plan(out, ended);
  EXPECT_FALSE(std::filesystem::exists(out / "lobes.json"));
  for (const char* name : {"tip.uff", "modes.json", "plan.json", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(out / name)) << name;
  }
  const auto json = nlohmann::json::parse(io::read_file(out / "plan.json"));
  EXPECT_TRUE(json["recommended"].is_null());
  EXPECT_EQ(json["modes"]["fit"]["usable"], false);
  EXPECT_FALSE(json.contains("lobes"));
}

// The best pocket of the lobes is a resonance: roughing takes it and says what it leaves, finishing keeps its limit at
// every speed of the window.
TEST_F(Plan, FinishingKeepsTheSurfaceErrorThatRoughingReports) {
  const PlanResult rough = run_job(job(), 1);
  const decision::Operation& free = *rough.recommendation.recommended;
  ASSERT_TRUE(std::isfinite(free.surface_error_m));
  ASSERT_GT(free.peak_deflection_m, 0.0);
  const stability::SurfacePoint there =
      stability::surface_point(rough.cut.problem, {free.spindle_speed_rad_per_s, free.axial_depth_m});
  EXPECT_EQ(free.surface_error_m, there.surface_location_error_m);
  EXPECT_EQ(free.peak_deflection_m, there.peak_deflection_m);
  const auto recommended = nlohmann::json::parse(plan_json(rough))["recommended"];
  EXPECT_NEAR(recommended["surface_error_um"].get<double>(), free.surface_error_m / units::um, 1e-9);
  EXPECT_NEAR(recommended["peak_deflection_um"].get<double>(), free.peak_deflection_m / units::um, 1e-9);
  const double turns_per_min = recommended["spindle_speed_rpm"].get<double>();
  EXPECT_NEAR(recommended["cutting_speed_m_per_min"].get<double>(), std::numbers::pi * 12e-3 * turns_per_min, 1e-6);
  EXPECT_NEAR(recommended["feed_mm_per_min"].get<double>(), 3 * 0.01 * turns_per_min, 1e-6);

  const double most_um = 0.3 * std::abs(free.surface_error_m) / units::um;
  const PlanResult fine = run_job(job("[finishing]\nmax_surface_error_um = " + std::to_string(most_um) + "\n"), 1);
  ASSERT_EQ(fine.recommendation.status, decision::Recommendation::Status::found);
  std::vector<decision::Operation> all = fine.recommendation.alternatives;
  all.push_back(*fine.recommendation.recommended);
  bool bound = false;
  for (const decision::Operation& op : all) {
    bound = bound || op.limited_by == decision::LimitedBy::surface_error;
    for (const double part : {-0.02, 0.0, 0.02}) {
      const stability::SurfacePoint surface =
          stability::surface_point(fine.cut.problem, {op.spindle_speed_rad_per_s * (1.0 + part), op.axial_depth_m});
      EXPECT_LE(std::abs(surface.surface_location_error_m), most_um * units::um * (1.0 + 1e-9));
    }
  }
  EXPECT_TRUE(bound);
  EXPECT_LE(fine.recommendation.recommended->removal_rate_m3_per_s, free.removal_rate_m3_per_s);
}

TEST_F(Plan, FinishingNeedsAWall) {
  std::string lobes = io::read_file(folder_.at("lobes.toml"));
  const std::string direction = "direction = \"up\"\nradial_depth_mm = 1.8";
  lobes.replace(lobes.find(direction), direction.size(), "entry_deg = 30\nexit_deg = 150");
  write("lobes.toml", lobes);
  const std::string text =
      test::rejection([&] { static_cast<void>(run_job(job("[finishing]\nmax_surface_error_um = 5\n"), 1)); });
  EXPECT_NE(text.find("job.toml: finishing"), std::string::npos) << text;
  EXPECT_NE(text.find("goes with a cut that finishes a wall"), std::string::npos) << text;
}

// Headerless FRFs that start at 0 Hz, one direction: the fit leaves that line out, and so does the fitted curve.
TEST_F(Plan, StartsFromFrfsWithALineAtZero) {
  const modal::Frf xx = write_xx();
  const PlanResult result = run_job(write("job.toml",
                                          "[job]\nfrf = \"xx.txt\"\nlobes = \"lobes.toml\"\nband_hz = [400, "
                                          "650]\nfit_modes = 2\nequal_directions = true\n"),
                                    1);
  EXPECT_EQ(result.model.modes.size(), 4U);
  const page::Report report = make_report(result, {});
  const auto fitted = nlohmann::json::parse(report.fitted);
  ASSERT_EQ(fitted["receptance_m_per_n"].size(), 1U);
  EXPECT_EQ(fitted["frequency_hz"].size() + 1, static_cast<std::size_t>(xx.receptance.size()));
  const auto& curve = fitted["receptance_m_per_n"]["xx"];
  const std::complex<double> at(curve["re"][2159].get<double>(), curve["im"][2159].get<double>());
  EXPECT_LT(std::abs(at - xx.receptance(2160)), 0.05 * std::abs(xx.receptance(2160)));
  EXPECT_NO_THROW(static_cast<void>(page::report_html(report)));
}

TEST_F(Plan, AddsTheForcesOfACutAndHoldsTheSpindleAgainstThem) {
  std::string lobes = io::read_file(folder_.at("lobes.toml"));
  for (const auto& [from, to] : {std::pair{"\"up\"", "\"down\""}, {"= 1.8", "= 6"}, {"= 0.01", "= 0.1"}}) {
    lobes = test_support::replaced(lobes, from, to);
  }
  write("lobes.toml", lobes);
  write("forces.toml", R"([tool]
kind = "flat-end"
teeth = 3
diameter_mm = 12
[cut]
axial_depth_mm = 2
radial_depth_mm = 6
direction = "down"
feed_per_tooth_mm = 0.1
spindle_speed_rpm = 8000
[coefficients]
tangential_n_per_mm2 = 712
radial_n_per_mm2 = 287
)");
  const std::string weak =
      "forces = \"forces.toml\"\n[spindle]\ncurve = [{ speed_rpm = 6000, torque_n_m = 0.1, "
      "power_kw = 0.1 }, { speed_rpm = 9000, torque_n_m = 0.1, power_kw = 0.1 }]\n";
  const PlanResult result = run_job(job(weak), 1);
  ASSERT_TRUE(result.programmed.forces && result.programmed.forces->revolution);
  const auto warned = std::ranges::count_if(result.warnings, [](const std::string& warning) {
    return warning.find("more than the spindle has") != std::string::npos;
  });
  EXPECT_EQ(warned, 1);
  const std::filesystem::path out = folder_.at("out");
  write_plan(out, result);
  EXPECT_TRUE(std::filesystem::exists(out / "forces.csv"));
  const auto json = nlohmann::json::parse(io::read_file(out / "plan.json"));
  EXPECT_NEAR(json["forces"]["power_w"].get<double>(), 712e6 * 2e-3 * 6e-3 * 0.1e-3 * 3.0 * 8000.0 / 60.0, 1.0);
  EXPECT_NE(io::read_file(out / "report.html").find("\"forces\":{"), std::string::npos);
}

// lobes.toml and forces.toml of one job state one cut: a key has one value in both.
TEST_F(Plan, RejectsAKeyThatItsFilesGiveTwoValues) {
  const auto warnings = [&](const std::string& tool, const std::string& more = {}) {
    write("forces.toml", "[tool]\nkind = \"flat-end\"\n" + tool +
                             "helix_deg = 35\n[cut]\naxial_depth_mm = 1\nradial_depth_mm = 1.8\ndirection = \"up\"\n"
                             "feed_per_tooth_mm = 0.01\nspindle_speed_rpm = 8000\n[coefficients]\n"
                             "tangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n");
    std::vector<std::string> found;
    for (const std::string& warning : run_job(job("forces = \"forces.toml\"\n" + more), 1).warnings) {
      if (warning.find("runs the shank") != std::string::npos) found.push_back(warning);
    }
    return found;
  };
  EXPECT_TRUE(warnings("teeth = 3\ndiameter_mm = 12\n").empty());
  const std::string teeth = test::rejection([&] { static_cast<void>(warnings("teeth = 4\ndiameter_mm = 12\n")); });
  EXPECT_NE(teeth.find("forces.toml:3: tool.teeth = 4; must have one value"), std::string::npos) << teeth;
  EXPECT_NE(teeth.find("lobes.toml:2 has 3"), std::string::npos) << teeth;
  const std::vector<std::string> edges =
      warnings("teeth = 3\ndiameter_mm = 12\ncutting_height_mm = 10\n", "[tool]\nmax_axial_depth_mm = 24\n");
  ASSERT_EQ(edges.size(), 1U);
  EXPECT_EQ(edges[0].find("tool.max_axial_depth_mm is 24 in job.toml, and the edges reach 10 mm up in forces.toml"),
            0U);
}

// A slot of 40 mm in a block of 600 mm: the spindle feels the slot, Kt a b v = 1,620 W, not the mean over the block.
TEST_F(Plan, HoldsTheSpindleAgainstASlotInALongBlock) {
  write("lobes.toml", test_support::replaced(io::read_file(folder_.at("lobes.toml")), "= 712", "= 900"));
  write("forces.toml", R"([tool]
kind = "flat-end"
teeth = 3
diameter_mm = 12
[coefficients]
tangential_n_per_mm2 = 900
[stock]
kind = "box"
min_mm = [-20, -30, -10]
max_mm = [20, 30, 0]
dexel_mm = 0.5
)");
  write("slot.ngc", "G21 G90 G94\nS10000 M3\nG0 X-300 Y0 Z5\nG0 Z-3\nG1 X300 F3000\nM2\n");
  const std::string curve =
      "forces = \"forces.toml\"\nprogram = \"slot.ngc\"\n[spindle]\ncurve = [{{ speed_rpm = 6000, torque_n_m = {0}, "
      "power_kw = {1} }}, {{ speed_rpm = 12000, torque_n_m = {0}, power_kw = {1} }}]\n";
  const auto warning = [&](double torque_n_m, double power_kw) {
    const PlanResult result = run_job(job(fmt::format(fmt::runtime(curve), torque_n_m, power_kw)), 1);
    const auto forces = nlohmann::json::parse(plan_json(result))["forces"];
    EXPECT_EQ(forces["torque_limit_n_m"].get<double>(), torque_n_m);
    EXPECT_EQ(forces["power_limit_w"].get<double>(), 1e3 * power_kw);
    const auto found = std::ranges::find_if(
        result.warnings, [](const std::string& text) { return text.find("more than the spindle has") != text.npos; });
    return found == result.warnings.end() ? std::string() : *found;
  };
  const std::string weak = warning(2.0, 0.5);
  EXPECT_NE(weak.find("in line 5: 1.55 N·m over a revolution and 1.62 kW over 0.1 s"), std::string::npos) << weak;
  EXPECT_EQ(warning(2.0, 2.0), "");
  EXPECT_NE(warning(1.0, 2.0), "");
}

// What nobody asked for ends no plan.
TEST_F(Plan, LeavesOutABandThatWouldTakeTooLong) {
  modal::ModalModel model = data::robot_modes();
  model.modes.front().frequency_std_hz = 0.5;
  write("modes.json", modal::modes_json(model));
  const auto path = write("job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\n");
  const auto left_out = [](const PlanResult& result) {
    return std::ranges::any_of(result.notes, [](const std::string& note) {
      return note.starts_with(
                 "The band of the limit by what the fit leaves uncertain is left out: its 100 samples "
                 "would take about ") &&
             note.ends_with("[uncertainty] in lobes.toml asks for one, of 20 samples or more.");
    });
  };
  const PlanResult with_band = run_job(path, 1);
  EXPECT_EQ(with_band.uncertain.samples, 100);
  EXPECT_FALSE(left_out(with_band));
  const Cost band =
      stability::cost_of_uncertain_limits(with_band.cut.problem, with_band.cut.options, with_band.cut.uncertainty);
  set_cost_limit({.operations = 0.3 * band.operations});
  const PlanResult without = run_job(path, 1);
  EXPECT_EQ(without.uncertain.samples, 0);
  EXPECT_TRUE(left_out(without));
  EXPECT_EQ(without.recommendation.recommended->axial_depth_m, with_band.recommendation.recommended->axial_depth_m);
  write("lobes.toml", test_support::lobes_file("spindle_speed_rpm = [6000, 9000]\naxial_depth_mm = [0, 3]\n"
                                               "grid = [31, 20]\nmethod = \"semi-discretization\"\nintervals = 20\n"
                                               "[uncertainty]\nsamples = 100\ngrid = [40, 30]\n"));
  EXPECT_NE(test::rejection([&] { static_cast<void>(run_job(path, 1)); }).find("would take about "), std::string::npos);
  set_cost_limit({});
}

// The modes of the cut's own file have the same names.
TEST_F(Plan, AnErrorAboutFittedModesIsNotThatOfTheFileTheyReplace) {
  LobesFile cut = read_lobes(write("lobes.toml", test_support::lobes_file("spindle_speed_rpm = [6000, 9000]\n"
                                                                          "axial_depth_mm = [0, 3]\n")));
  cut.drop_dynamics();
  const InvalidInput fast("modes[1].frequency_hz", 5e5, "Hz", "would take about 3 h of one core");
  EXPECT_STREQ(in_words_of(cut, fast).what(),
               "fitted modes[1].frequency_hz = 500000 Hz; would take about 3 h of one core");
}

TEST_F(Plan, SaysWhatIsMissing) {
  const auto rejection = [](const std::filesystem::path& path) {
    return test::rejection([&] { static_cast<void>(run_job(path, 1)); });
  };
  EXPECT_NE(rejection(folder_.at("none.toml")).find("none.toml"), std::string::npos);
  const std::string lobes = io::read_file(folder_.at("lobes.toml"));
  std::string without_feed = lobes;
  without_feed.erase(without_feed.find("feed_per_tooth_mm"), std::string("feed_per_tooth_mm = 0.01").size());
  write("lobes.toml", without_feed);
  EXPECT_NE(rejection(job()).find("feed_per_tooth_mm"), std::string::npos);
}

}  // namespace plan_test
}  // namespace robomill::jobs
