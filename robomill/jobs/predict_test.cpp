#include "robomill/jobs/predict.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace predict_test {

const std::filesystem::path examples = ROBOMILL_SOURCE_DIR "/examples";

double first_peak_hz(const std::string& file) {
  return predict_tip(examples / "joint-bar" / file, {}).peaks.at(0).frequency_hz;
}

// The README's figures. A clamped Euler-Bernoulli beam of 169.82 mm: (1.8751)^2 / (2π L²) sqrt(EI/(ρA)) = 294.75 Hz;
// with the loss factor 0.02 the peak of |H| lies within 0.02 % of it.
TEST(JointBar, PeaksAreThoseOfTheReadme) {
  const double area_radius = 0.012 / 4.0;  // sqrt(I / A) of a round
  const double clamped_hz =
      std::pow(1.8751040687 / 0.16982, 2) * area_radius * std::sqrt(200e9 / 7800.0) / (2.0 * std::numbers::pi);
  EXPECT_NEAR(first_peak_hz("rigid.toml"), clamped_hz, 2e-4 * clamped_hz);
  EXPECT_NEAR(first_peak_hz("assembly.toml"), 294.32, 0.02);
  EXPECT_NEAR(first_peak_hz("soft.toml"), 275.0, 0.1);
  // Source: the root 1.838110 of 1 + cos x cosh x + μ x (cos x sinh x - sin x cosh x), μ = 3.1 g / 149.808 g.
  EXPECT_NEAR(first_peak_hz("mass.toml"), std::pow(1.838110 / 1.8751040687, 2) * clamped_hz, 0.05);
}

class Predicted : public ::testing::Test {
 protected:
  Predicted() {
    folder_.file("lobes.toml", R"([tool]
teeth = 4
diameter_mm = 12
[cut]
direction = "down"
radial_depth_mm = 6
feed_per_tooth_mm = 0.06
[coefficients]
tangential_n_per_mm2 = 712
radial_n_per_mm2 = 287
[lobes]
spindle_speed_rpm = [9000, 14000]
axial_depth_mm = [0, 10]
grid = [11, 10]
method = "zeroth-order"
)");
  }
  std::filesystem::path job(const std::string& source) {
    return folder_.file("job.toml", "[job]\n" + source + "\nlobes = \"lobes.toml\"\nband_hz = [1500, 4000]\n");
  }
  static std::string assembly() { return "assembly = \"" + (examples / "new-tool/assembly.toml").string() + "\""; }

  test::Folder folder_;
};

// A measurement that is the prediction itself, on other lines, is no distance away; one of another joint is as far as
// both predictions are.
TEST_F(Predicted, IsComparedAtTheLinesOfTheMeasurement) {
  const TipPrediction rigid = predict_tip(examples / "joint-bar/rigid.toml", {});
  modal::FrfSet measured = coupling::tip_frfs(rigid.file.assembly, Eigen::VectorXd::LinSpaced(571, 30.3, 600.3)).frfs;
  modal::write_frfs(folder_.at("tip.json"), measured);
  const TipPrediction same = predict_tip(examples / "joint-bar/rigid.toml", folder_.at("tip.json"));
  ASSERT_EQ(same.error.size(), 2U);
  EXPECT_LT(same.error[0].relative, 1e-12);
  EXPECT_NEAR(same.peaks.at(0).measured_frequency_hz, same.peaks.at(0).frequency_hz, 0.05);
  const TipPrediction other = predict_tip(examples / "joint-bar/soft.toml", folder_.at("tip.json"));
  const modal::FrfSet soft = coupling::tip_frfs(other.file.assembly, measured.frequency_hz).frfs;
  EXPECT_NEAR(other.error[0].relative,
              (soft.frfs[0].receptance - measured.frfs[0].receptance).norm() / measured.frfs[0].receptance.norm(),
              1e-12);
  EXPECT_GT(other.error[0].relative, 0.5);
}

TEST_F(Predicted, PlanWarnsOfAMeasurementFarAway) {
  const auto measure = [&](const char* file) {
    const TipPrediction whole = predict_tip(examples / "joint-bar" / file, {});
    modal::write_frfs(folder_.at("tip.json"), whole.tip.frfs);
  };
  folder_.file("job.toml", "[job]\nassembly = \"" + (examples / "joint-bar/soft.toml").string() +
                               "\"\nmeasured = \"tip.json\"\nlobes = \"lobes.toml\"\nband_hz = [200, 600]\n");
  const auto warnings = [&] {
    std::string all;
    for (const std::string& text : run_job(folder_.at("job.toml"), 1).warnings) all += text + "\n";
    return all;
  };
  measure("rigid.toml");
  const std::string far = warnings();
  EXPECT_NE(far.find("The predicted xx differs from the measured one by "), std::string::npos) << far;
  EXPECT_NE(far.find("predicted at 275"), std::string::npos) << far;
  EXPECT_NE(far.find("stands at 294.7"), std::string::npos) << far;
  measure("soft.toml");
  EXPECT_EQ(warnings().find("differs from the measured one"), std::string::npos);
}

bool says(const std::vector<std::string>& texts, const std::string& part) {
  return std::ranges::any_of(texts, [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

// An accelerometer is on the tip where it is compared with the hits, not where it cuts: the FRFs of the plan are those
// of the same bar without it, 294.7 Hz in place of 283.2 Hz.
TEST_F(Predicted, PlanCutsWithoutTheAccelerometer) {
  const TipPrediction loaded = predict_tip(examples / "joint-bar/mass.toml");
  const TipPrediction bare = predict_tip(examples / "joint-bar/rigid.toml");
  modal::write_frfs(folder_.at("tip.json"), loaded.tip.frfs);
  const auto plan = [&](const std::string& more) {
    return run_job(folder_.file("job.toml", "[job]\nassembly = \"" + (examples / "joint-bar/mass.toml").string() +
                                                "\"\nlobes = \"lobes.toml\"\nband_hz = [200, 600]\n" + more),
                   1);
  };
  const PlanResult alone = plan("");
  const auto expect_bare = [&](const PlanResult& result) {
    for (const double hz : {250.0, 283.0, 294.5}) {
      const auto at = [&](const modal::FrfSet& set) {
        Eigen::Index line = 0;
        (set.frequency_hz.array() - hz).abs().minCoeff(&line);
        return set.frfs.at(0).receptance(line);
      };
      EXPECT_LT(std::abs(at(*result.frfs) - at(bare.tip.frfs)), 1e-9 * std::abs(at(bare.tip.frfs))) << hz;
    }
    ASSERT_FALSE(result.model.modes.empty());
    EXPECT_NEAR(result.model.modes.at(0).frequency_hz, 294.7, 0.2);
    EXPECT_TRUE(says(result.notes, "The accelerometer of 0.0031 kg"));
    EXPECT_TRUE(says(result.prediction->notes, "The accelerometer of 0.0031 kg"));
  };
  expect_bare(alone);
  EXPECT_NEAR(alone.prediction->peaks.at(0).frequency_hz, 294.7, 0.2);
  const PlanResult compared = plan("measured = \"tip.json\"\n");
  expect_bare(compared);
  EXPECT_LT(compared.prediction->error.at(0).relative, 1e-9) << "compared with the mass on";
  EXPECT_NEAR(compared.prediction->peaks.at(0).frequency_hz, 283.2, 0.2);
  EXPECT_NEAR(compared.prediction->peaks.at(0).measured_frequency_hz, 283.2, 0.2);
  EXPECT_FALSE(says(compared.warnings, "differs from the measured one"));
  EXPECT_FALSE(says(alone.notes, "where it is compared"));
  EXPECT_TRUE(says(compared.notes, "where it is compared"));
}

TEST_F(Predicted, AssemblyHasTheAccelerometerOnTheTip) {
  std::string text = io::read_file(examples / "joint-bar/mass.toml");
  text.replace(text.find("mass_kg = 0.0031"), 16, "mass_kg = 0.0031\noffset_mm = 3.5");
  const std::filesystem::path file = folder_.file("assembly.toml", text);
  const auto json = nlohmann::json::parse(io::dump(assembly_table().write(predict_tip(file))));
  EXPECT_EQ(json.at("accelerometer_mass_kg"), 0.0031);
  EXPECT_DOUBLE_EQ(json.at("accelerometer_offset_mm").get<double>(), 3.5);
  const TipPrediction bare = predict_tip(examples / "joint-bar/rigid.toml");
  EXPECT_FALSE(nlohmann::json::parse(io::dump(assembly_table().write(bare))).contains("accelerometer_offset_mm"));
}

TEST_F(Predicted, PlanRejectsAToolThatHangsFree) {
  folder_.file("assembly.toml",
               "[frequency]\nrange_hz = [100, 5000]\nstep_hz = 5\n[[tool]]\nlength_mm = 100\ndiameter_mm = 12\n"
               "youngs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\nloss_factor = 0.02\n[holder]\nfree = true\n");
  const std::filesystem::path file = job("assembly = \"assembly.toml\"");
  const std::string words = test::rejection([&] { static_cast<void>(run_job(file, 1)); });
  EXPECT_NE(words.find("assembly.toml:11: holder.free = true; must not be true where the tool is to cut"),
            std::string::npos)
      << words;
  EXPECT_NE(test::rejection([&] { static_cast<void>(run_structure(file, 1)); }).find("holder.free"), std::string::npos);
}

// What robomill joint found replaces the assembly's own: of the rigid bar with it the plan is that of the soft one.
TEST_F(Predicted, PlanTakesTheJointThatWasFound) {
  const TipPrediction soft = predict_tip(examples / "joint-bar/soft.toml");
  coupling::JointFitResult found;
  found.status = coupling::JointFitResult::Status::converged;
  found.joint = *soft.file.assembly.joint;
  found.knowledge[0].identifiable = found.knowledge[2].identifiable = true;
  folder_.file("joint.json", coupling::joint_json(found));
  folder_.file("job.toml", "[job]\nassembly = \"" + (examples / "joint-bar/rigid.toml").string() +
                               "\"\njoint = \"joint.json\"\nlobes = \"lobes.toml\"\nband_hz = [200, 600]\n");
  const PlanResult plan = run_job(folder_.at("job.toml"), 1);
  EXPECT_EQ(plan.prediction->tip.frfs.frfs.at(0).receptance, soft.tip.frfs.frfs.at(0).receptance);
  EXPECT_TRUE(says(plan.notes, "The joint is that of joint.json"));
  EXPECT_TRUE(says(plan.warnings, "joint.json: translational damping and rotational damping are not identifiable"));
  folder_.file("joint.json", "{\"joint\": {}}");
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(run_job(folder_.at("job.toml"), 1));
            }).find("joint.json: joint.translational_stiffness_n_per_m: is missing"),
            std::string::npos);
}

// With a measured holder the prediction stands on the holder's lines and is compared between them.
TEST_F(Predicted, OfAMeasuredHolderIsComparedBetweenItsLines) {
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(601, 50.0, 650.0);
  coupling::Assembly whole = predict_tip(examples / "joint-bar/soft.toml", {}).file.assembly;
  coupling::Assembly holder = whole;
  holder.tool = whole.holder.segments;
  holder.joint.reset();
  holder.holder = {};
  modal::write_frfs(folder_.at("holder.uff"), coupling::tip_frfs(holder, lines, {.rotations = true}).frfs);
  std::string text = io::read_file(examples / "joint-bar/soft.toml");
  text.erase(text.find("[frequency]"), text.find("[[tool]]") - text.find("[frequency]"));
  text.erase(text.find("[holder]"));
  const std::filesystem::path file = folder_.file("assembly.toml", text + "[holder]\nreceptances = \"holder.uff\"\n");
  modal::write_frfs(folder_.at("tip.uff"),
                    coupling::tip_frfs(whole, Eigen::VectorXd::LinSpaced(500, 60.25, 559.25)).frfs);
  const TipPrediction prediction = predict_tip(file, folder_.at("tip.uff"));
  EXPECT_EQ(prediction.tip.frfs.frequency_hz.size(), 601);
  EXPECT_LT(prediction.error.at(0).relative, 0.01) << "a straight line between the lines would be 0.02 away";
  EXPECT_NEAR(prediction.peaks.at(0).frequency_hz, 275.0, 0.2);
}

// Rotations by finite difference: an error of the measurement is amplified in what is kept, and tip.json notes it.
TEST_F(Predicted, KeepsTheMeasuredHolderWithItsDeviation) {
  std::string rows = "frequency_hz";
  for (const char* name : {"1x:1x", "2x:1x", "2x:2x"}) {
    rows += "," + std::string(name) + "_re_m_per_n," + name + "_im_m_per_n";
  }
  for (int line = 1; line <= 40; ++line) {
    rows += "\n" + std::to_string(10 * line) + ",1e-6,-1e-7,0.98e-6,-0.98e-7,0.961e-6,-0.961e-7";
  }
  folder_.file("points.csv", rows + "\n");
  const std::filesystem::path file =
      folder_.file("assembly.toml",
                   "[[tool]]\nlength_mm = 100\ndiameter_mm = 12\nyoungs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\n"
                   "[holder]\nreceptances = \"points.csv\"\npoints_mm = [0, 10]\nmax_amplification = 20\n");
  const TipPrediction prediction = predict_tip(file, {}, {.rotations = true});
  EXPECT_NE(prediction.tip.frfs.find(modal::parse_frf_name("ry:my")), nullptr);
  const Eigen::VectorXd& amplification = prediction.file.holder->amplification;
  ASSERT_EQ(amplification.size(), 40);
  for (const modal::Frf& frf : prediction.holder.frfs) {
    const Eigen::VectorXd expected = 0.01 * amplification.cwiseProduct(frf.receptance.cwiseAbs());
    EXPECT_LT((frf.deviation - expected).norm(), 1e-12 * expected.norm()) << modal::to_string(frf.name);
  }
  const auto json = nlohmann::json::parse(tip_json(prediction));
  EXPECT_EQ(json["unreliable_hz"].size(), 40U);
  EXPECT_EQ(json["notes"][0], prediction.file.holder->notes.at(0));
  EXPECT_TRUE(predict_tip(examples / "joint-bar/rigid.toml").holder.frfs.empty()) << "nothing was measured";
}

// The lines are the assembly's fault, which is what the error names.
TEST_F(Predicted, ErrorsOfTheAssemblyNameItsFile) {
  modal::write_frfs(folder_.at("holder.json"),
                    coupling::tip_frfs(predict_tip(examples / "joint-bar/rigid.toml").file.assembly,
                                       Eigen::VectorXd::LinSpaced(10, 100.0, 1000.0), {.rotations = true})
                        .frfs);
  const std::filesystem::path file =
      folder_.file("assembly.toml",
                   "[frequency]\nrange_hz = [1, 500]\nstep_hz = 1\n[[tool]]\nlength_mm = 100\ndiameter_mm = 12\n"
                   "youngs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\n[holder]\nreceptances = \"holder.json\"\n");
  const std::string words = test::rejection([&] { static_cast<void>(predict_tip(file)); });
  EXPECT_NE(words.find("assembly.toml: frequency_hz = 1 Hz; must lie in the range"), std::string::npos) << words;
}

TEST_F(Predicted, SaysWhatCannotBeCompared) {
  const auto rejection = [&](const modal::FrfSet& set) {
    modal::write_frfs(folder_.at("tip.json"), set);
    return test::rejection(
        [&] { static_cast<void>(predict_tip(examples / "joint-bar/rigid.toml", folder_.at("tip.json"))); });
  };
  modal::FrfSet set{.frequency_hz = Eigen::Vector2d(2000.0, 3000.0), .frfs = {}};
  set.frfs.push_back({.name = modal::parse_frf_name("xx"), .receptance = Eigen::Vector2cd(1e-6, 2e-6)});
  EXPECT_NE(rejection(set).find("no line in the predicted range, 1 to 1000 Hz"), std::string::npos) << rejection(set);
  set.frequency_hz *= 0.1;
  set.frfs[0].name = modal::parse_frf_name("1z:1z");
  EXPECT_NE(rejection(set).find("none of the FRFs that are predicted"), std::string::npos) << rejection(set);
  EXPECT_NE(rejection(set).find("without a number"), std::string::npos) << rejection(set);
  set.frfs[0].name = modal::parse_frf_name("1x:1x");
  modal::write_frfs(folder_.at("tip.json"), set);
  EXPECT_EQ(predict_tip(examples / "joint-bar/rigid.toml", folder_.at("tip.json")).error.size(), 1U);
}

// A round tool is fitted in x alone; fitted in both directions, the FRFs of the plan's own file give the same modes.
TEST_F(Predicted, PlanStandsOnTheModesOfItsTipFrfs) {
  const PlanResult predicted = run_job(job(assembly()), 1);
  ASSERT_TRUE(predicted.prediction->round);
  EXPECT_LT(predicted.fit->relative_error, 0.02) << "hysteretic damping, viscous modes";
  ASSERT_EQ(predicted.recommendation.status, decision::Recommendation::Status::found);
  write_plan(folder_.at("out"), predicted);
  const modal::FrfSet tip = modal::read_frfs({folder_.at("out") / "tip.uff"}).set;
  const modal::ModalModel both = modal::fit_modes(tip, {.band_low_hz = 1500.0, .band_high_hz = 4000.0}).model;
  ASSERT_EQ(both.modes.size(), predicted.model.modes.size());
  const Eigen::Vector2d near_hz(2600.0, 2900.0);
  const modal::FrfSet expected = modal::synthesize(both, near_hz);
  const modal::FrfSet found = modal::synthesize(predicted.model, near_hz);
  for (const char* name : {"xx", "yy"}) {
    const Eigen::VectorXcd& exact = expected.find(modal::parse_frf_name(name))->receptance;
    EXPECT_LT((found.find(modal::parse_frf_name(name))->receptance - exact).norm(), 5e-3 * exact.norm());
  }
  EXPECT_EQ(predicted.uncertain.samples, 0) << "a fit without noise knows nothing of the prediction's error";
  const auto json = nlohmann::json::parse(io::read_file(folder_.at("out") / "plan.json"))["assembly"];
  EXPECT_EQ(json["tool"].size(), 2U);
  EXPECT_NEAR(json["tool"][0]["length_mm"].get<double>(), 26.0, 1e-9);
  EXPECT_NEAR(json["joint"]["rotational_stiffness_n_m_per_rad"].get<double>(), 2.5e4, 1e-6);
  EXPECT_EQ(json["holder"]["segments"].size(), 3U);
  EXPECT_TRUE(json["relative_error"].is_null());
  EXPECT_NEAR(json["peaks"][0]["frequency_hz"].get<double>(), 2734.0, 2.0);
  const page::Report report = make_report(predicted, {});
  const auto frf = nlohmann::json::parse(report.frf);
  const auto fitted = nlohmann::json::parse(report.fitted);
  EXPECT_EQ(frf["receptance_m_per_n"].size(), 2U);
  EXPECT_EQ(fitted["receptance_m_per_n"]["yy"]["re"].size(), frf["frequency_hz"].size());
  EXPECT_EQ(report.measured, "");
  EXPECT_EQ(nlohmann::json::parse(report.assembly), json);
}

}  // namespace predict_test
}  // namespace robomill::jobs
