#include "robomill/jobs/forces.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/arm_modes.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/page/report.hpp"
#include "robomill/process/files/forces_schema.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace forces_test {

using robomill::test::Folder;
using robomill::test::rejection;

const std::filesystem::path examples = std::filesystem::path(ROBOMILL_SOURCE_DIR) / "examples";
const std::filesystem::path along = examples / "force-along-program";

std::vector<std::string> lines(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) out.push_back(line);
  return out;
}

/// The example's forces.toml with a cut of its own in place of a program's.
std::string single_cut() {
  std::string text = io::read_file(along / "forces.toml");
  return text.insert(text.find("spindle_speed_rpm"),
                     "axial_depth_mm = 1\nstepover_mm = 0.5\nfeed_per_tooth_mm = 0.05\ndirection = \"up\"\n");
}

// Compliance, posture and force agree: the deflection is C F with C of the posture, and turning the feed turns it.
TEST(RunForces, BendsTheRobotUnderTheMeanForce) {
  const process::ForcesResult result = run_forces(examples / "ball-end-ur5e" / "cut-1.toml", {}, {});
  ASSERT_TRUE(result.revolution && result.revolution->posture);
  const process::RevolutionForces& r = *result.revolution;
  const Eigen::Vector3d expected = r.posture->compliance_m_per_n * r.deflected.force.mean_n;
  EXPECT_LE((r.deflected.deflection_m - expected).norm(), 1e-3 * expected.norm());
  EXPECT_NEAR(r.deflected.cut.axial_depth_m, 1e-3 - r.deflected.deflection_m.z(), 1e-10);
  EXPECT_LT(r.deflected.cut.axial_depth_m, 1e-3);
  EXPECT_TRUE(r.posture->compliance_m_per_n.isApprox(r.posture->compliance_m_per_n.transpose(), 1e-2));
  EXPECT_FALSE(r.spindle_rotation) << "a UR5e has no spherical wrist";
}

// Beside it stands the cut as if the arm were rigid: that of a file without a robot.
TEST(RunForces, OfARobotThatDoesNotDeflect) {
  const Folder folder;
  std::string text = io::read_file(examples / "ball-end-ur5e" / "cut-1.toml");
  const process::ForcesResult bent = run_forces(examples / "ball-end-ur5e" / "cut-1.toml", {}, {});
  const process::ForcesResult alone =
      run_forces(folder.file("alone.toml", text.substr(0, text.find("[robot]"))), {}, {});
  const auto with = nlohmann::json::parse(process::forces_json(bent));
  const auto without = nlohmann::json::parse(process::forces_json(alone));
  EXPECT_EQ(with["rigid_mean_n"], without["mean_n"]);
  EXPECT_EQ(with["rigid_peak_n"], without["peak_n"]);
  EXPECT_TRUE(without["rigid_mean_n"].is_null());
  EXPECT_NE(process::summary(bent).find("mean, rigid"), std::string::npos);
}

// The joints' own inertia alone gives other modes of the arm.
TEST(RunForces, OfTheJointsOwnInertia) {
  const Folder folder;
  const std::filesystem::path from = examples / "ball-end-ur5e";
  const std::string text = io::read_file(from / "cut-1.toml");
  folder.file("cell.toml", io::read_file(from / "cell.toml"));
  const auto inertia = [&](const std::string& more) {
    return process::read_forces(folder.file("cut.toml", text + more)).robot_inertia;
  };
  EXPECT_EQ(inertia(""), robot::Inertia::full);
  EXPECT_EQ(inertia("inertia = \"full\"\n"), robot::Inertia::full);
  EXPECT_EQ(inertia("inertia = \"diagonal\"\n"), robot::Inertia::diagonal);
  EXPECT_NE(rejection([&] { (void)inertia("inertia = \"half\"\n"); }).find("robot.inertia"), std::string::npos);
  const robot::Cell arm = cell::read_cell(from / "cell.toml").robot;
  const Eigen::VectorXd joints = Eigen::VectorXd::Constant(6, 0.7);
  const modal::ModalModel full = cell::arm_modes(arm, joints),
                          own = cell::arm_modes(arm, joints, robot::Inertia::diagonal);
  EXPECT_GT(std::abs(full.modes[0].frequency_hz / own.modes[0].frequency_hz - 1.0), 1e-3);
}

TEST(RunForces, OfFilesThatWereRead) {
  const std::filesystem::path cell = examples / "ball-end-ur5e" / "cell.toml";
  const std::filesystem::path cut = examples / "ball-end-ur5e" / "cut-1.toml";
  process::ForcesFile file = process::read_forces(cut);
  file.cell = "elsewhere.toml";
  EXPECT_EQ(process::forces_json(run_forces(file, {}, cell::read_cell(cell))),
            process::forces_json(run_forces(cut, {}, cell)));
}

// The numbers of examples/ball-end-ur5e/README.md.
TEST(RunForces, RunsThePublishedCuts) {
  const double mean_z[] = {15.341, 15.423, 21.986};
  const double left_mm[] = {0.60395, 0.60086, 0.65104};
  for (int i = 0; i < 3; ++i) {
    const std::string name = "cut-" + std::to_string(i + 1) + ".toml";
    const process::ForcesResult result = run_forces(examples / "ball-end-ur5e" / name, {}, {});
    EXPECT_EQ(result.revolution->deflected.status, cutting::StaticDeflection::Status::found);
    EXPECT_NEAR(result.revolution->deflected.force.mean_n.z(), mean_z[i], 1e-3 * mean_z[i]) << name;
    EXPECT_NEAR(1e3 * result.revolution->deflected.cut.axial_depth_m, left_mm[i], 1e-3 * left_mm[i]) << name;
  }
}

TEST(RunForces, WritesARevolution) {
  const process::ForcesResult result = run_forces(examples / "ball-end-ur5e" / "cut-1.toml", {}, {});
  const std::vector<std::string> rows = lines(process::forces_csv(result));
  ASSERT_EQ(rows.size(), 361U);
  EXPECT_EQ(rows.front(), "rotation_deg,fx_n,fy_n,fz_n,torque_n_m");
  const nlohmann::json json = nlohmann::json::parse(process::forces_json(result));
  for (const char* key : {"mean_n", "peak_n", "rms_n", "deflection_um"}) EXPECT_EQ(json[key].size(), 3U) << key;
  for (const char* key : {"power_w", "chip_area_mm2", "torque_n_m", "axial_depth_left_mm"}) {
    EXPECT_TRUE(json[key].is_number()) << key;
  }
  EXPECT_FALSE(json["engagement"].empty());
  EXPECT_EQ(json["fx_n"].size(), 360U);
  page::Report page;
  page.forces = process::forces_json(result);
  EXPECT_NE(page::report_html(page).find("\"forces\":{"), std::string::npos);
}

TEST(RunForces, ReportsTheForceOnTheWorkpieceWithTheOtherSign) {
  const Folder folder;
  const std::string one = single_cut();
  const auto on_tool = nlohmann::json::parse(process::forces_json(run_forces(folder.file("tool.toml", one), {}, {})));
  const auto on_part = nlohmann::json::parse(
      process::forces_json(run_forces(folder.file("part.toml", "force_on = \"workpiece\"\n" + one), {}, {})));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(on_tool["mean_n"][axis].get<double>(), -on_part["mean_n"][axis].get<double>());
  }
  EXPECT_EQ(on_tool["power_w"], on_part["power_w"]);
  EXPECT_TRUE(on_tool["deflection_um"].is_null());
}

// A mode of the part makes the cut vibrate; far too stiff to move, it leaves the force alone.
TEST(RunForces, VibratesWithThePart) {
  const Folder folder;
  std::string text = single_cut();
  text += "[workpiece_dynamics]\nz = [{ frequency_hz = 300, damping_ratio = 0.05, modal_mass_kg = 3e4 }]\n";
  const process::ForcesResult result = run_forces(folder.file("forces.toml", text), {}, {});
  ASSERT_TRUE(result.revolution->vibration.has_value());
  EXPECT_EQ(result.revolution->vibration->verdict, simulation::Verdict::stable);
  const Eigen::Matrix3Xd& vibrating = result.revolution->vibrating_force_n;
  const cutting::CuttingForce& still = result.revolution->deflected.force;
  ASSERT_EQ(vibrating.cols(), still.force_n.cols());
  EXPECT_LE((vibrating.rowwise().mean() - still.mean_n).norm(), 0.03 * still.mean_n.norm());
  const nlohmann::json json = nlohmann::json::parse(process::forces_json(result));
  EXPECT_EQ(json["vibrating_fy_n"].get<std::vector<double>>().at(7), vibrating(1, 7));
  EXPECT_EQ(lines(process::forces_csv(result)).front(),
            "rotation_deg,fx_n,fy_n,fz_n,torque_n_m,vibrating_fx_n,vibrating_fy_n,vibrating_fz_n");
}

TEST(RunForces, RunsAlongAProgramWithTheRobot) {
  const process::ForcesResult result = run_forces(along / "forces.toml", along / "hollow.ngc", along / "cell.toml");
  ASSERT_TRUE(result.program.has_value());
  const process::ProgramForces& program = *result.program;
  ASSERT_EQ(program.blocks.size(), program.program.blocks.size());
  double most = 0.0;
  for (const process::BlockResult& row : program.blocks) {
    ASSERT_EQ(row.joints.size(), 6);
    most = std::max(most, row.force.peak_force_n);
    // The softest direction of this arm is near 0.5 N/um, the stiffest near 5.
    const double force = row.force.mean_force_n.norm();
    EXPECT_LE(row.deflection_m.norm(), force / 0.3e6);
    EXPECT_GE(row.deflection_m.norm(), force / 9e6);
    EXPECT_GE(row.peak_deflection_m.norm(), row.deflection_m.norm() * (1.0 - 1e-3));
  }
  EXPECT_GT(most, 50.0);
  EXPECT_LT(most, 500.0);
  const std::vector<std::string> rows = lines(process::forces_csv(result));
  EXPECT_EQ(rows.size(), program.blocks.size() + 1);
  EXPECT_EQ(rows.front().rfind("block,line,x_mm,y_mm,z_mm,axial_depth_mm,radial_depth_mm,mean_fx_n", 0), 0U);
  const nlohmann::json json = nlohmann::json::parse(process::forces_json(result));
  EXPECT_EQ(json["blocks"].size(), program.blocks.size());
  const std::vector<process::SpindleLoad> loads = process::spindle_loads(result);
  ASSERT_GT(loads.size(), 200U);
  EXPECT_GT(loads[0].torque_n_m, 0.0);
}

// The documents come in pieces, and are those of the schemas.
TEST(RunForces, WritesAProgramInPieces) {
  const process::ForcesResult result = run_forces(along / "forces.toml", along / "hollow.ngc", along / "cell.toml");
  constexpr std::size_t most_bytes = 100'000;
  std::size_t steps = 0;
  Progress progress([&](const std::string&, double) { ++steps; }, nullptr);
  for (const bool csv : {true, false}) {
    std::string text;
    const auto take = [&](std::string_view piece) {
      EXPECT_LT(piece.size(), most_bytes);
      text += piece;
    };
    csv ? process::write_forces_csv(result, take, progress) : process::write_forces_json(result, take, progress);
    EXPECT_EQ(text, csv ? process::forces_csv(result) : process::forces_json(result));
  }
  EXPECT_GT(steps, 2 * result.program->blocks.size());
  EXPECT_EQ(process::forces_json(result), io::dump(process::forces_table().write(result)));
  const Folder folder;
  write_document(folder.at("forces.csv"), result);
  EXPECT_EQ(io::read_file(folder.at("forces.csv")), process::forces_csv(result));
}

TEST(RunForces, StopsWhileItWrites) {
  const process::ForcesResult result = run_forces(along / "forces.toml", along / "hollow.ngc", along / "cell.toml");
  const std::atomic<bool> stop = true;
  Progress progress({}, &stop);
  const Folder folder;
  EXPECT_THROW(write_document(folder.at("forces.json"), result, progress), Interrupted);
  EXPECT_FALSE(std::filesystem::exists(folder.at("forces.json")));
}

// highest and worst are those of all blocks that cut; the way is the sum of the blocks' lengths.
TEST(RunForces, NamesTheHighestAndTheWorstBlocks) {
  const process::ForcesResult result = run_forces(along / "forces.toml", along / "hollow.ngc", along / "cell.toml");
  const nlohmann::json json = nlohmann::json::parse(process::forces_json(result));
  const nlohmann::json& blocks = json["blocks"];
  std::vector<double> forces;
  for (const nlohmann::json& block : blocks) {
    EXPECT_EQ(block["cuts"].get<bool>(), block["cutting_time_s"].get<double>() > 0.0);
    if (block["cuts"].get<bool>()) forces.push_back(block["peak_f_n"]);
  }
  std::ranges::sort(forces, std::greater());
  ASSERT_EQ(json["worst"].size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) {
    const nlohmann::json& worst = json["worst"][i];
    EXPECT_EQ(worst["peak_f_n"].get<double>(), forces[i]);
    EXPECT_EQ(worst, blocks[worst["block"].get<std::size_t>() - 1]);
  }
  for (const auto& [column, highest] : json["highest"].items()) {
    const nlohmann::json& there = blocks[highest["block"].get<std::size_t>() - 1];
    EXPECT_EQ(there[column], highest["value"]) << column;
    EXPECT_EQ(there["line"], highest["line"]) << column;
    for (const nlohmann::json& block : blocks) EXPECT_LE(block[column].get<double>(), highest["value"].get<double>());
  }
  EXPECT_EQ(json["highest"]["peak_f_n"]["block"], json["worst"][0]["block"]);
  double path_mm = 0.0;
  for (std::size_t i = 1; i < blocks.size(); ++i) {
    Eigen::Vector3d step_mm;
    for (const auto& [axis, name] : {std::pair{0, "x_mm"}, {1, "y_mm"}, {2, "z_mm"}}) {
      step_mm[axis] = blocks[i][name].get<double>() - blocks[i - 1][name].get<double>();
    }
    path_mm += step_mm.norm();
    EXPECT_NEAR(blocks[i]["path_mm"].get<double>() - blocks[0]["path_mm"].get<double>(), path_mm, 1e-6);
    EXPECT_GE(blocks[i]["time_s"].get<double>(), blocks[i - 1]["time_s"].get<double>());
  }
  EXPECT_TRUE(json["torque_limit_n_m"].is_null());
  EXPECT_EQ(json["facts"][1]["value"], fmt::format("{} blocks", blocks.size()));
  process::ForcesResult rigid = result;
  rigid.program->blocks.resize(3);
  for (process::BlockResult& row : rigid.program->blocks) row = {.force = {.block = row.force.block}};
  const nlohmann::json in_air = nlohmann::json::parse(process::forces_json(rigid));
  EXPECT_TRUE(in_air["highest"]["peak_f_n"].is_null()) << "no block cuts";
  EXPECT_TRUE(in_air["worst"].empty());
}

const std::string pocket_program =
    "G21 G90 G94\nS10000 M3\nG0 X10 Y10 Z5\nG1 Z-2 F300\nG1 X40 F1200\nG1 Y30\nG0 Z50\nM2\n";
const std::string pocket_tool =
    "[tool]\nkind = \"flat-end\"\nteeth = 3\ndiameter_mm = 12\n[coefficients]\ntangential_n_per_mm2 = 900\n";

// The tool plunges at feed from 5 mm above the part: no material stands there.
TEST(RunForces, APocketWithoutStockIsNoDeeperThanItIs) {
  const Folder folder;
  const std::filesystem::path program = folder.file("pocket.ngc", pocket_program);
  const process::ForcesResult result = run_forces(folder.file("forces.toml", pocket_tool), program, {});
  double deepest_m = 0.0;
  for (const process::BlockResult& row : result.program->blocks)
    deepest_m = std::max(deepest_m, row.force.axial_depth_m);
  EXPECT_NEAR(deepest_m, 2e-3, 0.01e-3);
  const nlohmann::json json = nlohmann::json::parse(process::forces_json(result));
  EXPECT_EQ(json["stock"]["assumed"], true);
  EXPECT_EQ(json["stock"]["top_from"], "program zero");
  EXPECT_EQ(json["stock"]["max_mm"][2], 0.0);
  ASSERT_FALSE(result.assumed.empty());
  EXPECT_EQ(result.assumed[0].what, "Stock");
  EXPECT_EQ(result.assumed[0].taken, process::stock_text(*result.program));
  EXPECT_EQ(result.assumed[0].key, "stock.kind");
  const process::ForcesResult with_depth =
      run_forces(folder.file("forces.toml", "cut = { axial_depth_mm = 1.5 }\n" + pocket_tool), program, {});
  EXPECT_EQ(nlohmann::json::parse(process::forces_json(with_depth))["stock"]["max_mm"][2], -0.5);
}

TEST(RunForces, AProgramThatDoesNotGiveItsStocksHeightNeedsOne) {
  const Folder folder;
  const std::filesystem::path program =
      folder.file("high.ngc", "G21 G90 G94\nS10000 M3\nG0 X0 Y0 Z30\nG1 Z18 F300\nG1 X40 F1200\nM2\n");
  const std::string message =
      rejection([&] { static_cast<void>(run_forces(folder.file("forces.toml", pocket_tool), program, {})); });
  EXPECT_NE(message.find("forces.toml"), std::string::npos) << message;
  EXPECT_NE(message.find("how high the material stands"), std::string::npos) << message;
}

// F in m/min and F in mm per tooth, a feed of the path for one of a tooth, a stock in another corner, a spindle that
// turns left.
TEST(RunForces, SaysWhereAProgramDoesNotFitItsForces) {
  const Folder folder;
  const auto warned = [&](const std::string& old_text, const std::string& new_text, const std::string& stock,
                          const std::string& text) {
    std::string program = pocket_program;
    program.replace(program.find(old_text), old_text.size(), new_text);
    const process::ForcesResult result =
        run_forces(folder.file("forces.toml", "cut = { feed_per_tooth_mm = 0.04 }\n" + pocket_tool + stock),
                   folder.file("pocket.ngc", program), {});
    return std::ranges::any_of(result.warnings,
                               [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
  };
  const std::string feed = "and cut.feed_per_tooth_mm is 0.04", large = "mm is unusual for a cutter of";
  const std::string none = "No block cuts", left = "the spindle turns left";
  for (const std::string& text : {feed, large, none, left}) EXPECT_FALSE(warned("F1200", "F1200", "", text)) << text;
  EXPECT_TRUE(warned("F1200", "F1.2", "", feed));
  EXPECT_TRUE(warned("F1200", "F20000", "", feed));
  EXPECT_TRUE(warned("F1200", "F60000", "", large));
  EXPECT_TRUE(warned("M3", "M4", "", left));
  EXPECT_TRUE(warned("M3", "M3", "[stock]\nkind = \"box\"\nmin_mm = [200, 200, -20]\nmax_mm = [300, 300, 0]\n", none));
}

// One meaning of "cuts" in summary, document and page; and a way through air lowers no figure of a block.
TEST(RunForces, CountsTheSameBlocksEverywhere) {
  const Folder folder;
  const std::filesystem::path program =
      folder.file("slot.ngc", "G21 G90 G94\nS10000 M3\nG0 X-300 Y0 Z5\nG0 Z-3\nG1 X300 F3000\nG1 Y200\nG1 Z40\nM2\n");
  const std::string stock = "[stock]\nkind = \"box\"\nmin_mm = [-20, -30, -10]\nmax_mm = [20, 30, 0]\n";
  const process::ForcesResult result = run_forces(folder.file("forces.toml", pocket_tool + stock), program, {});
  EXPECT_EQ(result.program->cutting_blocks(), 1U);
  EXPECT_EQ(process::spindle_loads(result).size(), 1U);
  const nlohmann::json json = nlohmann::json::parse(process::forces_json(result));
  EXPECT_EQ(json["cutting_blocks"], 1);
  EXPECT_EQ(json["stock"]["assumed"], false);
  page::Report page;
  page.forces = process::forces_json(result);
  const nlohmann::json shown = nlohmann::json::parse(page::report_json(page));
  EXPECT_EQ(shown["forces"]["cutting_blocks"], 1);
  EXPECT_NEAR(shown["forces"]["highest"]["sustained_power_w"]["value"].get<double>(), 1620.0, 10.0);
  const nlohmann::json& row =
      *std::ranges::find_if(json["blocks"], [](const nlohmann::json& block) { return block["line"] == 5; });
  EXPECT_NEAR(row["peak_power_w"].get<double>(), 1620.0, 10.0);
  EXPECT_NEAR(row["revolution_torque_n_m"].get<double>(), 1620.0 / 1047.2, 0.01);
  EXPECT_GT(row["power_w"].get<double>(), 1300.0);
  EXPECT_NEAR(row["cutting_time_s"].get<double>(), 46.0 / 50.0, 0.07);
}

// An arm without a spherical wrist is followed from where it stands.
TEST(RunForces, FollowsAProgramWithAUr5e) {
  const Folder folder;
  std::string cell = io::read_file(examples / "ball-end-ur5e" / "cell.toml");
  cell.replace(cell.find("origin_mm"), 9, "rotation_deg = [0, 0, 0]\norigin_mm");
  cell += "[program]\nmachine = \"xyzac-trt\"\n";
  const std::string start = "start_joints_deg = [0, -90, 90, -90, -90, 0]\n";
  const std::string with_start = std::string(cell).insert(cell.find("dh = ["), start);
  const auto path = folder.file("cell.toml", with_start);
  const process::ForcesResult result = run_forces(along / "forces.toml", along / "hollow.ngc", path);
  ASSERT_EQ(result.program->blocks.front().joints.size(), 6);
  const cell::CellFile file = cell::read_cell(path);
  for (const process::BlockResult& row : result.program->blocks) {
    const program::Block& block = result.program->program.blocks[row.force.block];
    const robot::ToolPose pose = robot::tool_pose(file.robot, robot::forward(file.robot.arm, row.joints));
    EXPECT_LE((pose.tip_m - block.end.tip_m).norm(), 1e-9);
    EXPECT_LE((pose.axis - block.end.axis).norm(), 1e-9);
  }
  EXPECT_NE(
      rejection([&] {
        static_cast<void>(run_forces(along / "forces.toml", along / "hollow.ngc", folder.file("plain.toml", cell)));
      }).find("start_joints_deg"),
      std::string::npos);
}

TEST(RunForces, SaysWhichBlockTheRobotCannotReach) {
  const Folder folder;
  std::string cell = io::read_file(along / "cell.toml");
  cell.replace(cell.find("[1700, 0, 700]"), 14, "[3300, 0, 700]");
  const auto message = [&](const std::filesystem::path& path) {
    return rejection([&] { static_cast<void>(run_forces(along / "forces.toml", along / "hollow.ngc", path)); });
  };
  const std::string text = message(folder.file("cell.toml", cell));
  EXPECT_NE(text.find("hollow.ngc:5"), std::string::npos) << text;
  EXPECT_NE(text.find("out of the robot's reach by"), std::string::npos) << text;
}

// The curve over γ passes through the posture that the cut was computed in.
TEST(RunForces, SweepsAboutTheToolsAxis) {
  const Folder folder;
  static_cast<void>(folder.file("cell.toml", io::read_file(along / "cell.toml")));
  std::string text = single_cut();
  text += "[robot]\ncell = \"cell.toml\"\njoints_deg = [0, -60, 90, 0, 60, 0]\n";
  const auto json = nlohmann::json::parse(process::forces_json(run_forces(folder.file("forces.toml", text), {}, {})));
  const nlohmann::json& sweep = json["spindle_rotation"];
  const double used_deg = sweep["used_deg"];
  double nearest_deg = 360.0;
  double nearest_um = 0.0;
  for (std::size_t i = 0; i < sweep["rotation_deg"].size(); ++i) {
    const double away_deg = std::abs(sweep["rotation_deg"][i].get<double>() - used_deg);
    if (sweep["deflection_um"][i].is_null() || away_deg >= nearest_deg) continue;
    nearest_deg = away_deg;
    nearest_um = sweep["deflection_um"][i];
  }
  const auto bent_um = json["deflection_um"].get<std::array<double, 3>>();
  EXPECT_LT(nearest_deg, 5.0);
  EXPECT_NEAR(nearest_um, std::hypot(bent_um[0], bent_um[1], bent_um[2]), 0.05 * nearest_um);
}

TEST(RunForces, RejectsAPostureBeyondTheLimitsOrSingular) {
  const Folder folder;
  static_cast<void>(folder.file("cell.toml", io::read_file(along / "cell.toml")));
  std::string text = single_cut();
  const auto message = [&](const std::string& joints) {
    const auto path = folder.file("forces.toml", text + "[robot]\ncell = \"cell.toml\"\njoints_deg = " + joints + "\n");
    return rejection([&] { static_cast<void>(run_forces(path, {}, {})); });
  };
  EXPECT_NE(message("[0, -30, 80, 0, 150, 0]").find("limits of joint 5"), std::string::npos);
  EXPECT_NE(message("[0, -30, 80, 0, 0, 0]").find("singular"), std::string::npos);
  EXPECT_NE(message("[0, 0, 0]").find("one angle for each of 6 joints"), std::string::npos);
}

}  // namespace forces_test
}  // namespace robomill::jobs
