#include "robomill/robot/files/loads_csv.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/robot/files/stiffness_files.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::robot {
namespace loads_csv_test {

using robomill::test::Folder;
using robomill::test::rejection;
using robomill::test::seeds;
namespace arms = robot::testing;

const std::string header = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm";
const std::string row = "1,2,3,4,5,6,100,-200,300,0.1,-0.2,0.3";

TEST(LoadsCsv, ReadsALoadARow) {
  const Folder folder;
  const LoadsFile file = read_loads(folder.file("loads.csv", "# Tuesday\n" + header + ",mz_n_m,deviation_mm\n" + row +
                                                                 ",7,0.01\n\n" + row + ",8,0.02\n"),
                                    arms::kr210());
  ASSERT_EQ(file.loads.size(), 2U);
  EXPECT_EQ(file.line[0], 3U);
  EXPECT_EQ(file.line[1], 5U);
  const Load& load = file.loads[0];
  EXPECT_DOUBLE_EQ(load.position(5), 6.0 * units::deg);
  EXPECT_EQ(load.wrench.force_n, Eigen::Vector3d(100.0, -200.0, 300.0));
  EXPECT_EQ(load.wrench.moment_n_m, Eigen::Vector3d(0.0, 0.0, 7.0));
  EXPECT_LT((load.displacement_m - Eigen::Vector3d(1e-4, -2e-4, 3e-4)).norm(), 1e-19);
  EXPECT_DOUBLE_EQ(load.deviation_m, 1e-5);
  // A prismatic joint is given in millimetres.
  Arm sliding = arms::kr210();
  sliding.joints[1].prismatic = true;
  std::string columns = header;
  columns.replace(columns.find("q2_deg"), 6, "q2_mm");
  EXPECT_DOUBLE_EQ(read_loads(folder.file("s.csv", columns + "\n" + row + "\n"), sliding).loads[0].position(1), 2e-3);
}

TEST(LoadsCsv, SaysWhatIsWrongAndWhere) {
  const Folder folder;
  const auto said = [&](const std::string& text) {
    const auto path = folder.file("loads.csv", text);
    return rejection([&] {
             const LoadsFile file = read_loads(path, arms::kr210());
             (void)identify_joint_stiffness(arms::kr210(), Eigen::Vector3d::Zero(), file);
           })
        .substr(folder.path().string().size() + 1);
  };
  EXPECT_EQ(said(header + "\n" + row + "\n"),
            "loads.csv: loads = 1 loads; must give at least as many numbers as there are joints, three each. Several "
            "postures and directions are needed");
  EXPECT_EQ(said("q1_deg,fx_n\n1,2\n").substr(0, 33), "loads.csv: has no column q2_deg. ");
  EXPECT_NE(said(header + ",fx_m\n" + row + ",1\n").find("column fx_m that is not known here. Did you mean fx_n?"),
            std::string::npos);
  EXPECT_EQ(said(header + "\n" + row + "\n1,2,3,4,x,6,100,-200,300,0.1,-0.2,0.3\n"),
            "loads.csv:3: q5_deg = \"x\"; must be a finite number");
  EXPECT_EQ(said(header + "\n1,2,3,4,5,6,100,-200,300,0.1,-0.2\n"), "loads.csv:2: dz_mm: is missing");
  EXPECT_EQ(said(header + ",deviation_mm\n" + row + ",0.1\n" + row + ",-0.1\n"),
            "loads.csv:3: deviation_mm = -0.1 mm; must be >= 0");
  EXPECT_NE(rejection([&] { (void)read_loads(folder.at("none.csv"), arms::kr210()); }).find("none.csv"),
            std::string::npos);
}

/// A file of loads on an arm whose stiffness is known.
std::string measured(const Arm& arm, const Eigen::Vector3d& point_m, int count) {
  Random random(61);
  std::string text = header + "\n";
  for (int k = 0; k < count; ++k) {
    const Eigen::VectorXd position = 0.4 * arms::random_position(random, 6);
    const Wrench wrench{.force_n = 500.0 * arms::random_vector(random)};
    const Eigen::Vector3d moved = loaded_posture(arm, position, point_m, wrench).displacement_m;
    for (const double angle : position) text += fmt::format("{},", angle / units::deg);
    text += fmt::format("{},{},{},{},{},{}\n", wrench.force_n.x(), wrench.force_n.y(), wrench.force_n.z(),
                        moved.x() / units::mm, moved.y() / units::mm, moved.z() / units::mm);
  }
  return text;
}

TEST(LoadsCsv, GivesTheStiffnessBackThroughFiles) {
  const Folder folder;
  const Arm arm = arms::kr210();
  const Eigen::Vector3d point_m(0.1, 0.0, 0.2);
  const LoadsFile file = read_loads(folder.file("loads.csv", measured(arm, point_m, 12)), arm);
  const IdentifiedStiffness found = identify_joint_stiffness(arm, point_m, file);
  const auto json = nlohmann::json::parse(stiffness_json(found, arm, file));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(json["joint_stiffness_n_m_per_rad"][i].get<double>(), arm.joints[i].stiffness,
                1e-8 * arm.joints[i].stiffness);
    EXPECT_TRUE(json["identifiable"][i].get<bool>());
    EXPECT_TRUE(json["reason"][i].is_null());
    EXPECT_LT(json["std"][i].get<double>(), 1e-6 * arm.joints[i].stiffness);
  }
  EXPECT_EQ(json["convergence"]["status"], "converged");
  EXPECT_EQ(json["residual_mm"].size(), 12U);
  EXPECT_EQ(json["displacement_mm"].size(), 12U);
  EXPECT_EQ(json["line"][0], 2);
  EXPECT_EQ(json["unit"][0], "N m/rad");
  EXPECT_LT(json["rms_mm"].get<double>(), 1e-9);
}

TEST(LoadsCsv, AJointThatIsNotSeenKeepsItsStiffness) {
  const Folder folder;
  const Arm arm = arms::kr210();
  const Eigen::Vector3d on_axis_6(0.0, 0.0, 0.2);
  const LoadsFile file = read_loads(folder.file("loads.csv", measured(arm, on_axis_6, 12)), arm);
  const IdentifiedStiffness found = identify_joint_stiffness(arm, on_axis_6, file);
  const auto json = nlohmann::json::parse(stiffness_json(found, arm, file));
  EXPECT_TRUE(json["joint_stiffness_n_m_per_rad"][5].is_null());
  EXPECT_TRUE(json["std"][5].is_null());
  EXPECT_FALSE(json["identifiable"][5].get<bool>());
  EXPECT_FALSE(json["reason"][5].get<std::string>().empty());
  const std::string table = stiffness_csv(found, arm);
  EXPECT_TRUE(table.starts_with("joint,stiffness,std,unit,identifiable,reason\n1,")) << table;
  EXPECT_NE(table.find("\n6,,,N m/rad,false,\""), std::string::npos) << table;
  EXPECT_NE(stiffness_toml(found, arm).find("467056]"), std::string::npos);
  EXPECT_NE(stiffness_toml(found, arm).find("# Joint 6, as before: "), std::string::npos);
  Arm bare = arm;
  bare.joints[5].stiffness = 0.0;
  EXPECT_NE(rejection([&] { (void)stiffness_toml(found, bare); }).find("is not known of joint 6"), std::string::npos);
}

TEST(LoadsCsv, DamagedFilesAreReadOrRejected) {
  const Folder folder;
  Random random(62);
  const std::string good = measured(arms::kr210(), Eigen::Vector3d(0.1, 0.0, 0.2), 4);
  int read = 0;
  for (int k = 0; k < seeds(2000); ++k) {
    std::string text = good;
    text[random.index(text.size())] = static_cast<char>(random.index(256));
    try {
      const auto path = folder.file("loads.csv", text);
      read += read_loads(path, arms::kr210()).loads.size() >= 3 ? 1 : 0;
    } catch (const InvalidInput&) {
      continue;
    }
  }
  EXPECT_GT(read, 3);
}

}  // namespace loads_csv_test
}  // namespace robomill::robot
