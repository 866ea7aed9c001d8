#include "robomill/plan/plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "data/robot_modes.hpp"
#include "robomill/base/test_support.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/units.hpp"
#include "robomill/plan/test_lobes.hpp"

namespace robomill::plan {
namespace {

const std::string data = ROBOMILL_SOURCE_DIR "/data/";

class Plan : public testing::Test {
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
  ASSERT_EQ(result.recommendation.status, Recommendation::Status::found);
  const Operation& op = *result.recommendation.recommended;
  EXPECT_GT(op.axial_depth_m, 0.0);
  for (const double part : {-0.02, -0.01, 0.0, 0.01, 0.02}) {
    const stability::PointResult point =
        stability::evaluate_point(result.cut.problem, result.cut.options,
                                  {.spindle_speed_rad_per_s = op.spindle_speed_rad_per_s * (1.0 + part),
                                   .axial_depth_m = 1.2 * op.axial_depth_m});
    EXPECT_TRUE(point.stable) << part;
  }
  EXPECT_EQ(result.pairs.size(), 4U);
  EXPECT_NEAR(limit_share(result).sum(), 1.0, 1e-12);
}

// The plan computes half a turn and mirrors it; the other half computed gives the same.
TEST_F(Plan, LimitOverFeedDirectionIsThatOfTheTurnedProblem) {
  const PlanResult result = run_job(job(), 1);
  const report::FeedDirections& turned = *result.feed_directions;
  ASSERT_EQ(turned.direction_rad.size(), 36);
  for (const Eigen::Index i : {5, 20, 30}) {
    stability::LobesProblem problem = result.cut.problem;
    problem.feed_direction_rad = turned.direction_rad(i);
    const stability::Limit limit =
        stability::limit_depths(problem, result.cut.options, {turned.spindle_speed_rad_per_s}).front();
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
  const auto json = nlohmann::json::parse(formats::read_file(folder_.at("out") / "plan.json"));
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
  const std::string said = test::refusal([&] { static_cast<void>(plan("")); });
  EXPECT_NE(said.find("job.toml: job: nothing is known of y"), std::string::npos) << said;
  EXPECT_NE(said.find("rigid_directions = [\"y\"]"), std::string::npos) << said;
  const PlanResult rigid = plan("rigid_directions = [\"y\"]\n");
  EXPECT_EQ(rigid.model.modes.size(), 2U);
  EXPECT_NE(std::ranges::find(rigid.warnings, "y was not measured and is taken as rigid."), rigid.warnings.end());
  EXPECT_NE(test::refusal([&] {
              static_cast<void>(plan("rigid_directions = [\"x\"]\n"));
            }).find("job.rigid_directions: names x, which was measured"),
            std::string::npos);
  const std::string both = test::refusal([&] { static_cast<void>(run_job(job("equal_directions = true\n"), 1)); });
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
  EXPECT_EQ(ended.recommendation.status, Recommendation::Status::no_safe_depth);
  EXPECT_NE(ended.recommendation.reason.find("--accept-fit"), std::string::npos) << ended.recommendation.reason;
  write_plan(out, ended);
  EXPECT_FALSE(std::filesystem::exists(out / "lobes.json"));
  for (const char* name : {"tip.uff", "modes.json", "plan.json", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(out / name)) << name;
  }
  const auto json = nlohmann::json::parse(formats::read_file(out / "plan.json"));
  EXPECT_TRUE(json["recommended"].is_null());
  EXPECT_EQ(json["modes"]["fit"]["usable"], false);
  EXPECT_FALSE(json.contains("lobes"));
}

// Headerless FRFs that start at 0 Hz, one direction: the fit leaves that line out, and so does the fitted curve.
TEST_F(Plan, StartsFromFrfsWithALineAtZero) {
  const modal::Frf xx = write_xx();
  const PlanResult result = run_job(write("job.toml",
                                          "[job]\nfrf = \"xx.txt\"\nlobes = \"lobes.toml\"\nband_hz = [400, "
                                          "650]\nfit_modes = 2\nequal_directions = true\n"),
                                    1);
  EXPECT_EQ(result.model.modes.size(), 4U);
  const report::Report report = make_report(result, {});
  ASSERT_EQ(report.frfs.size(), 1U);
  EXPECT_TRUE(std::isnan(report.frfs[0].fitted(0).real()));
  EXPECT_LT(std::abs(report.frfs[0].fitted(2160) - xx.receptance(2160)), 0.05 * std::abs(xx.receptance(2160)));
  EXPECT_NO_THROW(static_cast<void>(report::report_html(report)));
}

TEST_F(Plan, AddsTheForcesOfACutAndHoldsTheSpindleAgainstThem) {
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
  ASSERT_TRUE(result.forces && result.forces->revolution);
  const auto warned = std::ranges::count_if(result.warnings, [](const std::string& warning) {
    return warning.find("more than the spindle has") != std::string::npos;
  });
  EXPECT_EQ(warned, 1);
  const std::filesystem::path out = folder_.at("out");
  write_plan(out, result);
  EXPECT_TRUE(std::filesystem::exists(out / "forces.csv"));
  const auto json = nlohmann::json::parse(formats::read_file(out / "plan.json"));
  EXPECT_NEAR(json["forces"]["power_w"].get<double>(), 712e6 * 2e-3 * 6e-3 * 0.1e-3 * 3.0 * 8000.0 / 60.0, 1.0);
  EXPECT_NE(formats::read_file(out / "report.html").find("id=\"forces\""), std::string::npos);
}

TEST_F(Plan, SaysWhatIsMissing) {
  const auto refusal = [](const std::filesystem::path& path) {
    return test::refusal([&] { static_cast<void>(run_job(path, 1)); });
  };
  EXPECT_NE(refusal(folder_.at("none.toml")).find("none.toml"), std::string::npos);
  const std::string lobes = formats::read_file(folder_.at("lobes.toml"));
  std::string without_feed = lobes;
  without_feed.erase(without_feed.find("feed_per_tooth_mm"), std::string("feed_per_tooth_mm = 0.01").size());
  write("lobes.toml", without_feed);
  EXPECT_NE(refusal(job()).find("feed_per_tooth_mm"), std::string::npos);
}

}  // namespace
}  // namespace robomill::plan
