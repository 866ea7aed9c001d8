#include "robomill/cell/dynamics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/files/posture_json.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "testing/support.hpp"

namespace robomill::cell {
namespace dynamics_test {

using robomill::test::Folder;
using robomill::test::rejection;

const std::string cell = R"([robot]
dh = [{ a_mm = 350, alpha_deg = -90, d_mm = 449.4 }, { a_mm = 1150, theta_offset_deg = -90 },
      { a_mm = 41, alpha_deg = -90, theta_offset_deg = 180 }, { alpha_deg = 90, d_mm = -1200 }, { alpha_deg = -90 },
      { alpha_deg = 180, d_mm = -420, theta_offset_deg = 180 }]
joint_min_position_deg = [-180, -120, -120, -350, -120, -350]
joint_max_position_deg = [180, 120, 120, 350, 120, 350]
joint_stiffness_n_m_per_rad = [2.2072e6, 3.37672e6, 2.77569e6, 2.35016e6, 2.15746e6, 0.467056e6]
joint_damping_n_m_s_per_rad = [1200, 1500, 900, 400, 300, 60]
joint_rotor_inertia_kg_m2 = [60, 50, 40, 10, 8, 4]
links = [{ mass_kg = 300, center_mm = [-100, 50, 0], inertia_kg_m2 = [10, 20, 30, 1, 2, 3] },
         { mass_kg = 200, inertia_kg_m2 = [5, 9, 9, 0, 0, 0] }, { mass_kg = 150, inertia_kg_m2 = [4, 4, 4, 0, 0, 0] },
         { mass_kg = 50, inertia_kg_m2 = [1, 1, 1, 0, 0, 0] }, { mass_kg = 30, inertia_kg_m2 = [0.5, 0.5, 0.5, 0, 0, 0] },
         { mass_kg = 20, inertia_kg_m2 = [0.5, 0.5, 0.5, 0, 0, 0] }]
[tool]
length_mm = 300
mount_rotation_deg = [0, 90, 0]
)";
std::vector<double> radians(std::vector<double> degrees) {
  for (double& angle : degrees) angle *= units::deg;
  return degrees;
}
const std::vector<double> joints = radians({10.0, -5.0, 15.0, 20.0, 60.0, -10.0});

const std::string lobes_of_cell = R"([tool]
teeth = 3
diameter_mm = 16
[cut]
direction = "up"
radial_depth_mm = 8
[coefficients]
tangential_n_per_mm2 = 800
radial_n_per_mm2 = 250
[lobes]
spindle_speed_rpm = [3000, 15000]
axial_depth_mm = [0, 5]
grid = [10, 10]
[uncertainty]
samples = 20
grid = [4, 4]
[dynamics]
cell = "cell.toml"
)";

std::string with_postures(const std::string& postures) {
  return cell + postures;
}

TEST(Posture, OfACellWithoutMeasurementsIsMarkedSo) {
  const Folder folder;
  const ModesOfPosture posture = posture_modes(folder.file("cell.toml", cell), joints);
  const nlohmann::json json = nlohmann::json::parse(posture_modes_json(posture));
  EXPECT_EQ(json["posture"]["source"], "cell");
  EXPECT_EQ(json["posture"]["measured_nearby"], false);
  EXPECT_TRUE(json["posture"]["distance_deg"].is_null());
  EXPECT_EQ(json["posture"]["joints_deg"].size(), 6U);
  ASSERT_EQ(json["modes"].size(), json["posture"]["modes"].size());
  EXPECT_GT(json["modes"][0]["std"]["residue"], 0.0);
  EXPECT_FALSE(json["notes"].empty());
}

TEST(Posture, IsTheSameFromMeasurementsInFlangeAndInBaseAxes) {
  const Folder folder;
  const std::filesystem::path plain = folder.file("cell.toml", cell);
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(496, 5.0, 500.0);
  for (const PostureAxes axes : {PostureAxes::base, PostureAxes::flange}) {
    const ModesOfPosture true_modes = posture_modes(plain, joints, axes);
    modal::write_frfs(folder.path() / (axes == PostureAxes::base ? "base.uff" : "flange.uff"),
                      modal::synthesize(true_modes.prediction.modes, lines));
  }
  const std::string at = "[[postures]]\njoints_deg = [10, -5, 15, 20, 60, -10]\n";
  const auto modes = [&](const char* name, const std::string& rest) {
    return posture_modes(folder.file(name, with_postures(at + rest)), radians({5.0, 0.0, 10.0, 0.0, 50.0, 0.0}))
        .prediction;
  };
  const modal::PosturePrediction base = modes("base.toml", "frf = \"base.uff\"\n");
  const modal::PosturePrediction flange = modes("flange.toml", "frf = \"flange.uff\"\naxes = \"flange\"\n");
  ASSERT_EQ(base.modes.modes.size(), flange.modes.modes.size());
  for (std::size_t k = 0; k < base.modes.modes.size(); ++k) {
    const modal::Mode &a = base.modes.modes[k], &b = flange.modes.modes[k];
    EXPECT_NEAR(a.frequency_hz, b.frequency_hz, 1e-4 * a.frequency_hz);
    const Eigen::Matrix3cd one = a.right * a.left.transpose(), other = b.right * b.left.transpose();
    EXPECT_LT((one - other).norm(), 1e-2 * one.norm());
  }
}

TEST(Posture, GivesLobesTheirModesAndTheirUncertainty) {
  const Folder folder;
  folder.file("cell.toml", cell);
  const jobs::LobesJobResult result =
      jobs::run_lobes({.lobes = folder.file("lobes.toml", lobes_of_cell + "joints_deg = [10, -5, 15, 20, 60, -10]\n")});
  const nlohmann::json json = nlohmann::json::parse(jobs::lobes_document(result));
  EXPECT_EQ(json["posture"]["joints_deg"][3], 20.0);
  EXPECT_TRUE(json.contains("uncertainty"));
  EXPECT_NE(
      rejection([&] { (void)jobs::run_lobes({.lobes = folder.file("none.toml", lobes_of_cell)}); }).find("is missing"),
      std::string::npos);
}

TEST(Posture, RejectsWhatCannotBeAPosture) {
  const Folder folder;
  const auto read = [&](const std::string& postures) {
    return rejection([&] { (void)read_cell(folder.file("cell.toml", with_postures(postures))); });
  };
  EXPECT_NE(read("[[postures]]\njoints_deg = [1, 2, 3]\nfrf = \"a.uff\"\n").find("one value a joint"),
            std::string::npos);
  EXPECT_NE(read("[[postures]]\njoints_deg = [1, 2, 300, 4, 5, 6]\nfrf = \"a.uff\"\n").find("joint 3"),
            std::string::npos);
  EXPECT_NE(read("[[postures]]\njoints_deg = [1, 2, 3, 4, 5, 6]\n").find("is missing"), std::string::npos);
  EXPECT_NE(read("[[postures]]\njoints_deg = [1, 2, 3, 4, 5, 6]\nfrf = \"a.uff\"\nmodes = \"b.json\"\n").find("beside"),
            std::string::npos);
  EXPECT_NE(read("[[postures]]\njoints_deg = [1, 2, 3, 4, 5, 6]\nfrf = \"a.uff\"\naxes = \"tool\"\n").find("axes"),
            std::string::npos);
  const std::filesystem::path good = folder.file("good.toml", cell);
  EXPECT_NE(rejection([&] {
              (void)posture_modes(good, {1.0, 2.0});
            }).find("joints: must hold one value a joint, 6"),
            std::string::npos);
  const std::string beyond = rejection([&] { (void)posture_modes(good, radians({1.0, 2.0, 400.0, 4.0, 5.0, 6.0})); });
  EXPECT_NE(beyond.find("joints[3] = 6.98"), std::string::npos) << beyond;
}

TEST(Posture, SaysWhatItAssumesOfDamping) {
  const Folder folder;
  std::string text = cell;
  const std::size_t begin = text.find("joint_damping");
  text.erase(begin, text.find('\n', begin) + 1 - begin);
  const auto assumed = [&](const std::string& of) {
    return nlohmann::json::parse(posture_modes_json(posture_modes(folder.file("cell.toml", of), joints)))["assumed"];
  };
  ASSERT_EQ(assumed(text).size(), 1U);
  EXPECT_EQ(assumed(text)[0]["what"], "Damping of joints 1, 2, 3, 4, 5, 6");
  EXPECT_EQ(assumed(text)[0]["taken"], "2 % of critical of each");
  EXPECT_EQ(assumed(text)[0]["file"], "cell.toml");
  EXPECT_TRUE(assumed(cell).empty());
}

TEST(Posture, HasAMeasurementOfItsOwn) {
  const Folder folder;
  const std::string of = "[[postures]]\nfrf = \"a.uff\"\njoints_deg = ";
  modal::write_frfs(folder.at("a.uff"),
                    modal::synthesize(posture_modes(folder.file("plain.toml", cell), joints).prediction.modes,
                                      Eigen::VectorXd::LinSpaced(99, 4.0, 200.0)));
  const std::filesystem::path twice =
      folder.file("cell.toml", cell + of + "[1, 2, 3, 4, 5, 6]\n" + of + "[9, 2, 3, 4, 5, 6]\n");
  const std::string said = rejection([&] { (void)cell_dynamics(read_cell(twice)); });
  EXPECT_NE(said.find("posture 2: names"), std::string::npos) << said;
  EXPECT_NE(said.find("as posture 1 does"), std::string::npos) << said;
}

// From forces along x and y zz follows from the model alone: its deviation is stated, and hits are asked for.
TEST(Posture, AsksForHitsAlongAnAxisThatNobodyHit) {
  const Folder folder;
  const modal::FrfSet nine = modal::synthesize(posture_modes(folder.file("plain.toml", cell), joints).prediction.modes,
                                               Eigen::VectorXd::LinSpaced(99, 4.0, 200.0));
  modal::FrfSet six = nine;
  six.frfs.resize(6);
  modal::write_frfs(folder.at("nine.uff"), nine);
  modal::write_frfs(folder.at("six.uff"), six);
  const auto of = [&](const std::string& file) {
    return posture_modes(
        folder.file("cell.toml", cell + "[[postures]]\nfrf = \"" + file + "\"\njoints_deg = [1, 2, 3, 4, 5, 6]\n"),
        radians({1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
  };
  const auto warned = [](const std::vector<std::string>& warnings) {
    return std::ranges::any_of(warnings, [](const std::string& warning) {
      return warning.find("Nobody hit along the base's z: zz") != std::string::npos;
    });
  };
  const ModesOfPosture without = of("six.uff"), with = of("nine.uff");
  EXPECT_TRUE(warned(posture_warnings(without)));
  EXPECT_FALSE(warned(posture_warnings(without, {true, true, false})));
  EXPECT_FALSE(warned(posture_warnings(with)));
  // One number for how far zz is off, that of the posture.
  for (const std::string& note : without.notes) EXPECT_EQ(note.find("likely off"), std::string::npos) << note;
  const nlohmann::json some = nlohmann::json::parse(posture_modes_json(without))["posture"]["columns"];
  const nlohmann::json all = nlohmann::json::parse(posture_modes_json(with))["posture"]["columns"];
  EXPECT_EQ(some["z"]["measured"], false);
  EXPECT_TRUE(some["z"]["relative_error"].is_null());
  EXPECT_TRUE(some["x"]["held_out_relative_error"].is_number());
  EXPECT_EQ(all["z"]["measured"], true);
  EXPECT_TRUE(all["x"]["held_out_relative_error"].is_null());
  for (const char* axis : {"x", "y", "z"}) {
    EXPECT_GT(some[axis]["deviation"].get<double>(), 0.0) << axis;
    EXPECT_GT(all[axis]["deviation"].get<double>(), 0.0) << axis;
  }
  EXPECT_GT(some["z"]["deviation"], all["z"]["deviation"]);
}

// Without masses measured modes are interpolated: those that do not recur are named, and none left is an error.
TEST(Posture, SaysThatModesCannotBeMatched) {
  const Folder folder;
  std::string bare = cell;
  const std::size_t begin = bare.find("links = ");
  bare.erase(begin, bare.find("[tool]") - begin);
  const auto mode = [](double frequency_hz) {
    const std::string along_z = "{ x = [0, 0], y = [0, 0], z = [0.01, 0] }";
    return "[[modes]]\nfrequency_hz = " + std::to_string(frequency_hz) + "\ndamping_ratio = 0.03\nleft = " + along_z +
           "\nright = " + along_z + "\n";
  };
  // Three postures about as far from the fourth, the first the nearest.
  const std::vector<double> between = radians({9.9, 5.7, 0, 0, 40, 0});
  const auto cell_with = [&](const std::string& all, const std::string& first) {
    folder.file("a.toml", all + first);
    folder.file("b.toml", all + mode(2500));
    folder.file("c.toml", all + mode(6000));
    return folder.file("cell.toml", bare +
                                        "[[postures]]\njoints_deg = [0, 0, 0, 0, 40, 0]\nmodes = \"a.toml\"\n"
                                        "[[postures]]\njoints_deg = [20, 0, 0, 0, 40, 0]\nmodes = \"b.toml\"\n"
                                        "[[postures]]\njoints_deg = [10, 17.3, 0, 0, 40, 0]\nmodes = \"c.toml\"\n");
  };
  const ModesOfPosture some = posture_modes(cell_with(mode(40), mode(900)), between);
  ASSERT_EQ(some.prediction.modes.modes.size(), 1U);
  EXPECT_EQ(some.unmatched, 1U);
  EXPECT_EQ(posture_table().write(some)["unmatched_modes"], 1U);
  const std::vector<std::string> warnings = posture_warnings(some);
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("1 of the 2 modes of the nearest posture"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("posture 1 (a.toml)"), std::string::npos) << warnings[0];
  const std::string none = rejection([&] { (void)posture_modes(cell_with("", mode(900)), between); });
  EXPECT_NE(none.find("cannot be matched with each other here; the nearest is"), std::string::npos) << none;
}

// In the file's words: line, key and degrees.
TEST(Posture, OfLobesIsRejectedWithItsLine) {
  const Folder folder;
  folder.file("cell.toml", cell);
  const auto said = [&](const std::string& angles) {
    const std::filesystem::path file = folder.file("lobes.toml", lobes_of_cell + "joints_deg = [" + angles + "]\n");
    return rejection([&] { (void)jobs::run_lobes({.lobes = file}); });
  };
  EXPECT_NE(said("10, -5, 400, 20, 60, -10").find("lobes.toml:19: dynamics.joints_deg[3] = 400 deg; must lie within"),
            std::string::npos)
      << said("10, -5, 400, 20, 60, -10");
  EXPECT_NE(said("10, -5").find("lobes.toml:19: dynamics.joints_deg: must hold one value a joint, 6; it holds 2"),
            std::string::npos);
}

}  // namespace dynamics_test
}  // namespace robomill::cell
