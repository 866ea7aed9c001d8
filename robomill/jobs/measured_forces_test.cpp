#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/jobs/outputs.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace measured_forces_test {

using robomill::test::Folder;
using robomill::test::rejection;

const std::string cut =
    "[tool]\nkind = \"flat-end\"\ndiameter_mm = 10\nteeth = 2\nhelix_deg = 40\n"
    "[cut]\naxial_depth_mm = 5\nradial_depth_mm = 5\nfeed_per_tooth_mm = 0.1\ndirection = \"up\"\n"
    "spindle_speed_rpm = 6000\n";
const std::string coefficients =
    "[coefficients]\ntangential_n_per_mm2 = 800\nradial_n_per_mm2 = 300\naxial_n_per_mm2 = 150\n"
    "tangential_edge_n_per_mm = 12\nradial_edge_n_per_mm = 9\naxial_edge_n_per_mm = 2\n";

/// The record of a dynamometer under the workpiece, whose x and y are the feed frame's -y and x, at 5,990 rpm, with air
/// before and after, an offset, and noise of 2 N.
std::string record_of(const process::ForcesResult& result) {
  const cutting::CuttingForce& force = result.revolution->deflected.force;
  Random random(5);
  std::string text = "Time,Fx,Fy,Fz\ns,N,N,N\n";
  for (int i = 0; i < 6000; ++i) {
    const double t = 1e-4 * i;
    const double turns = 5990.0 / 60.0 * t + 0.3;
    const double place = (turns - std::floor(turns)) * static_cast<double>(force.force_n.cols());
    const auto at = static_cast<Eigen::Index>(place);
    const double share = place - static_cast<double>(at);
    Eigen::Vector3d f =
        -(1.0 - share) * force.force_n.col(at) - share * force.force_n.col((at + 1) % force.force_n.cols());
    if (t < 0.1 || t > 0.5) f.setZero();
    text += fmt::format("{:.4f},{:.3f},{:.3f},{:.3f}\n", t, -f.y() + 5.0 + 2.0 * random.normal(),
                        f.x() - 3.0 + 2.0 * random.normal(), f.z() + 2.0 * random.normal());
  }
  return text;
}

struct Files {
  Folder folder;
  std::filesystem::path forces = folder.file("forces.toml", "force_on = \"workpiece\"\n" + cut + coefficients);
  std::filesystem::path record = folder.file("record.csv", record_of(run_forces(forces, {}, {})));
  MeasuredForceJob job{.record = record, .reading = {.channels = {"Fy", "-Fx", "Fz"}}};
};

TEST(MeasuredForces, StandBesideThePrediction) {
  const Files files;
  const process::ForcesResult result = run_measured_forces(files.forces, files.job);
  ASSERT_TRUE(result.measured);
  const nlohmann::json json = nlohmann::json::parse(process::forces_json(result))["measured"];
  EXPECT_EQ(json["channels"], (std::vector<std::string>{"Fy", "-Fx", "Fz"}));
  EXPECT_NEAR(json["spindle_speed_rpm"].get<double>(), 5990.0, 0.5);
  EXPECT_GT(json["air_revolutions"].get<int>(), 10);
  EXPECT_GE(json["from_s"].get<double>(), 0.1);
  EXPECT_LE(json["to_s"].get<double>(), 0.5);
  const nlohmann::json whole = nlohmann::json::parse(process::forces_json(result));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(json["mean_n"][axis].get<double>(), whole["mean_n"][axis].get<double>(), 1.0);
    EXPECT_NEAR(json["scatter_n"][axis].get<double>(), 2.0, 0.5);
    EXPECT_LT(json["error_n"][axis].get<double>(), 1.0);
  }
  EXPECT_EQ(json["fx_n"].size(), whole["fx_n"].size());
  EXPECT_TRUE(process::forces_csv(result).starts_with(
      "rotation_deg,fx_n,fy_n,fz_n,torque_n_m,measured_fx_n,measured_fy_n,measured_fz_n\n"));
  const std::string text = process::summary(result);
  for (const char* part :
       {"measured     record.csv", "peak, predicted", "record's scatter", "revolutions in air was taken off"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  for (const Assumption& one : result.assumed) EXPECT_NE(one.key, "force_on");
}

// Axes that are taken as they are called fit worse than those of the dynamometer, which is a warning.
TEST(MeasuredForces, WarnOfOtherAxes) {
  const Files files;
  const process::ForcesResult result = run_measured_forces(files.forces, {.record = files.record});
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings.back().find("--channels=Fy,-Fx,Fz"), std::string::npos) << result.warnings.back();
}

// Axes that come out left-handed are those of the force on the other body.
TEST(MeasuredForces, WarnOfTheOtherBody) {
  const Files files;
  const auto tool = files.folder.file("tool.toml", "force_on = \"tool\"\n" + cut + coefficients);
  const std::string turned = run_measured_forces(tool, files.job).warnings.back();
  EXPECT_NE(turned.find("force_on = \"workpiece\" in the cut's file. Which"), std::string::npos) << turned;
  const std::string both = run_measured_forces(tool, {.record = files.record}).warnings.back();
  EXPECT_NE(both.find("force_on = \"workpiece\" in the cut's file and --channels=Fy,-Fx,Fz. Which"), std::string::npos)
      << both;
}

TEST(MeasuredForces, SayWhatTheyActOn) {
  const Files files;
  const auto tool = files.folder.file("tool.toml", cut + coefficients);
  const process::ForcesResult result = run_measured_forces(tool, files.job);
  bool said = false;
  for (const Assumption& one : result.assumed) said = said || one.key == "force_on";
  EXPECT_TRUE(said);
}

TEST(MeasuredForces, NameTheFileOfABadRecord) {
  const Files files;
  std::string flat = "time_s,Fx,Fy,Fz\n";
  Random random(1);
  for (int i = 0; i < 3000; ++i)
    flat += fmt::format("{:.4f},{:.3f},{:.3f},{:.3f}\n", 1e-4 * i, random.normal(), random.normal(), random.normal());
  const auto air = files.folder.file("air.csv", flat);
  const std::string text = rejection([&] { (void)run_measured_forces(files.forces, {.record = air}); });
  EXPECT_NE(text.find("air.csv: repeats nothing with the rotation"), std::string::npos) << text;
}

// What the record was made with comes back, within three deviations or the 3 % that 100 samples a revolution lose of an
// edge that enters at once.
TEST(SignalCoefficients, OfARecord) {
  const Files files;
  const auto bare = files.folder.file("cut.toml", "force_on = \"workpiece\"\n" + cut);
  const SignalCoefficientsResult result =
      run_signal_coefficients({.record = files.record, .cut = bare, .reading = files.job.reading});
  const auto near = [](const std::vector<double>& found, const std::vector<double>& deviation, double expected) {
    ASSERT_EQ(found.size(), 1U);
    EXPECT_GT(deviation[0], 0.0);
    EXPECT_NEAR(found[0], expected, std::max(3.0 * deviation[0], 0.03 * expected));
  };
  const cutting::SignalFit& fit = result.fit;
  near(fit.coefficients.tangential_n_per_m2, fit.deviations.tangential_n_per_m2, 800e6);
  near(fit.coefficients.radial_n_per_m2, fit.deviations.radial_n_per_m2, 300e6);
  near(fit.coefficients.axial_n_per_m2, fit.deviations.axial_n_per_m2, 150e6);
  near(fit.coefficients.tangential_edge_n_per_m, fit.deviations.tangential_edge_n_per_m, 12e3);
  near(fit.coefficients.radial_edge_n_per_m, fit.deviations.radial_edge_n_per_m, 9e3);
  EXPECT_TRUE(fit.identifiable);
  EXPECT_GT(fit.r_squared.minCoeff(), 0.99);
  ASSERT_TRUE(result.forces.measured);
  EXPECT_LT(result.forces.measured->force.error_ratio_of_all, 0.02);
  const nlohmann::json json = nlohmann::json::parse(document(result, io::Format::json));
  EXPECT_NEAR(json["coefficients"]["tangential_n_per_mm2"][0].get<double>(), 800.0, 10.0);
  EXPECT_GT(json["std"]["tangential_n_per_mm2"][0].get<double>(), 0.0);
  // coefficients.toml is one that forces.toml takes.
  io::write_file(files.folder.at("c.toml"), document(result, io::Format::toml));
  const auto again =
      files.folder.file("again.toml", "force_on = \"workpiece\"\ncoefficients = { file = \"c.toml\" }\n" + cut);
  EXPECT_LT(run_measured_forces(again, files.job).measured->force.error_ratio_of_all, 0.02);
}

// Forces of the wrong sign, or of other axes, are no answer: exit 3, and nobody takes the file for one.
TEST(SignalCoefficients, RejectWhatNoCutHas) {
  const Files files;
  const auto tool = files.folder.file("tool.toml", "force_on = \"tool\"\n" + cut);
  const SignalCoefficientsResult turned =
      run_signal_coefficients({.record = files.record, .cut = tool, .reading = files.job.reading});
  EXPECT_NE(shortfall(turned), "");
  EXPECT_FALSE(turned.forces.revolution);
  EXPECT_TRUE(document(turned, io::Format::toml).starts_with("# Not to be used: "));
  const auto bare = files.folder.file("cut.toml", "force_on = \"workpiece\"\n" + cut);
  const SignalCoefficientsResult other =
      run_signal_coefficients({.record = files.record, .cut = bare, .reading = {.channels = {"Fz", "Fy", "-Fx"}}});
  EXPECT_NE(shortfall(other), "");
  for (const SignalCoefficientsResult* result : {&turned, &other}) {
    const std::string text = summary(*result);
    for (const std::string& warning : result->forces.warnings) EXPECT_NE(text.find(warning), std::string::npos);
    EXPECT_NE(nlohmann::json::parse(document(*result, io::Format::json))["notes"].dump().find("Not to be used"),
              std::string::npos);
  }
}

TEST(SignalCoefficients, SayWhatOfTheDocumentTheyLeaveOut) {
  const Files files;
  const auto full = files.folder.file(
      "full.toml", "force_on = \"workpiece\"\n" + cut + coefficients +
                       "[workpiece_dynamics]\nx = [{ frequency_hz = 900, damping_ratio = 0.03, modal_mass_kg = 3 }]\n");
  const SignalCoefficientsResult result =
      run_signal_coefficients({.record = files.record, .cut = full, .reading = files.job.reading});
  EXPECT_EQ(shortfall(result), "");
  const std::string text = summary(result);
  for (const char* part :
       {"[workpiece_dynamics] of full.toml is left out", "[coefficients] of full.toml have no part"}) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  }
  // What is assumed is said once.
  const std::size_t runout = text.find("Runout");
  ASSERT_NE(runout, std::string::npos) << text;
  EXPECT_EQ(text.find("Runout", runout + 1), std::string::npos) << text;
  EXPECT_EQ(text.find("Edge forces"), std::string::npos) << text;
}

TEST(SignalCoefficients, NeedAllComponents) {
  const Files files;
  const std::string text = rejection([&] {
    (void)run_signal_coefficients(
        {.record = files.record, .cut = files.forces, .reading = {.channels = {"Fy", "-Fx", "none"}}});
  });
  EXPECT_NE(text.find("z is missing"), std::string::npos) << text;
}

}  // namespace measured_forces_test
}  // namespace robomill::jobs
