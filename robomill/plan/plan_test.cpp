#include "robomill/plan/plan.hpp"

#include <fmt/format.h>
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

// Headerless FRFs that start at 0 Hz, one direction: the fit leaves that line out, and so does the fitted curve.
TEST_F(Plan, StartsFromFrfsWithALineAtZero) {
  const modal::FrfSet set = modal::synthesize(data::robot_modes(), Eigen::VectorXd::LinSpaced(2801, 0.0, 700.0));
  const modal::Frf& xx = *set.find(modal::parse_frf_name("xx"));
  std::ofstream file(folder_.at("xx.txt"));
  file.precision(15);
  for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
    file << set.frequency_hz(i) << ' ' << xx.receptance(i).real() << ' ' << xx.receptance(i).imag() << '\n';
  }
  file.close();
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

// A slot of 40 mm in a block of 600 mm: the spindle feels the slot, Kt a b v = 1,620 W, not the mean over the block.
TEST_F(Plan, HoldsTheSpindleAgainstASlotInALongBlock) {
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
    const auto found = std::ranges::find_if(
        result.warnings, [](const std::string& text) { return text.find("more than the spindle has") != text.npos; });
    return found == result.warnings.end() ? std::string() : *found;
  };
  const std::string weak = warning(2.0, 0.5);
  EXPECT_NE(weak.find("in line 5: 1.55 N·m over a revolution and 1.62 kW over 0.1 s"), std::string::npos) << weak;
  EXPECT_EQ(warning(2.0, 2.0), "");
  EXPECT_NE(warning(1.0, 2.0), "");
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

TEST(EqualDirections, DoublesTheMeasuredOne) {
  modal::ModalModel one;
  one.excitations = one.responses = {{.axis = modal::Axis::x}};
  one.modes = {{.frequency_hz = 500.0,
                .damping_ratio = 0.02,
                .left = Eigen::VectorXcd::Constant(1, 0.01),
                .right = Eigen::VectorXcd::Constant(1, std::complex<double>(0.0, -0.01))}};
  const modal::ModalModel both = with_equal_directions(one);
  const Eigen::Vector2d frequency_hz(100.0, 499.0);
  const modal::FrfSet measured = modal::synthesize(one, frequency_hz);
  const modal::FrfSet planar = modal::synthesize(both, frequency_hz);
  for (const char* name : {"xx", "yy"}) {
    EXPECT_LT((planar.find(modal::parse_frf_name(name))->receptance - measured.frfs[0].receptance).norm(), 1e-18);
  }
  for (const char* name : {"xy", "yx"}) {
    EXPECT_EQ(planar.find(modal::parse_frf_name(name))->receptance.norm(), 0.0);
  }
  EXPECT_THROW(static_cast<void>(with_equal_directions(both)), InvalidInput);
}

}  // namespace
}  // namespace robomill::plan
