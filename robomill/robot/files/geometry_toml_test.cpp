#include "robomill/robot/files/geometry_toml.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "testing/robot/cells.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::robot {
namespace geometry_toml_test {

using robomill::test::Folder;
using robomill::test::rejection;

const std::string good = R"([geometry]
stl_unit = "inch"
part = "part.stl"
fixtures = ["vise.stl", "vise.stl"]
cell = [{ name = "table", box_from_mm = [500, -600, 0], box_to_mm = [1500, 600, 700], rotation_deg = [0, 0, 90] },
        { file = "fence.stl", origin_mm = [0, 0, 1000] }]
arm = [{ link = 0, file = "base.stl" },
       { link = 2, from_mm = [0, 0, 0], to_mm = [-1150, 0, 0], diameter_mm = 300 },
       { link = 2, from_mm = [0, 0, 100], to_mm = [0, 0, 100], diameter_mm = 400, origin_mm = [0, 20, 0] },
       { link = 4, name = "forearm", box_from_mm = [100, -100, 100], box_to_mm = [-100, 100, -1200] }]
stickout_mm = 50
shank_diameter_mm = 12
holder = [{ length_mm = 30, diameter_mm = 30, upper_diameter_mm = 40 }, { length_mm = 20, diameter_mm = 63 }]
spindle = { length_mm = 200, diameter_mm = 150 }
clearance_mm = 2
gouge_tolerance_mm = 0.05
self_collision = true
ignore = [{ first = "link 2", second = "forearm" }]
)";

std::string with(const std::string& old_text, const std::string& new_text) {
  return test_support::replaced(good, old_text, new_text);
}

struct Read {
  std::optional<CellGeometry> geometry = {};
  std::vector<std::string> notes = {};
};

Read read(const std::string& text, const std::vector<Eigen::Isometry3d>& frames =
                                       std::vector<Eigen::Isometry3d>(7, Eigen::Isometry3d::Identity())) {
  const Folder folder;
  for (const char* name : {"part.stl", "vise.stl", "fence.stl", "base.stl"}) {
    folder.file(name, testing::binary_stl(testing::box({0, 0, 0}, {25.4e-3, 50.8e-3, 0.254}), units::inch));
  }
  io::TomlFile file(folder.file("cell.toml", text));
  Read out;
  out.geometry = read_geometry(file, testing::kr210_cell(), Eigen::Isometry3d::Identity(), frames, out.notes);
  static_cast<void>(file.done());
  return out;
}

std::string said(const std::string& text) {
  return rejection([&] { static_cast<void>(read(text)); });
}

Eigen::AlignedBox3d extent(const io::TriangleMesh& mesh) {
  Eigen::AlignedBox3d out;
  for (const Eigen::Vector3d& vertex : mesh.vertices_m) out.extend(vertex);
  return out;
}

TEST(GeometryToml, ReadsAllOfIt) {
  std::vector<Eigen::Isometry3d> frames(7, Eigen::Isometry3d::Identity());
  frames[0] = Eigen::Translation3d(0, 0, 0.5) * frames[0];
  frames[2] = dh_link({.a_m = 1.15});
  const Read found = read(good, frames);
  ASSERT_TRUE(found.geometry);
  EXPECT_TRUE(found.notes.empty());
  const CellGeometry& all = *found.geometry;
  ASSERT_EQ(all.part.size(), 1U);
  EXPECT_EQ(all.part[0].name, "part");
  EXPECT_LT((extent(all.part[0].mesh).max() - Eigen::Vector3d(25.4e-3, 50.8e-3, 0.254)).norm(), 1e-8);
  ASSERT_EQ(all.fixtures.size(), 2U);
  EXPECT_EQ(all.fixtures[0].name, "vise");
  EXPECT_EQ(all.fixtures[1].name, "vise (2)");
  ASSERT_EQ(all.cell.size(), 2U);
  EXPECT_EQ(all.cell[0].name, "table");
  EXPECT_LT((extent(all.cell[0].mesh).min() - Eigen::Vector3d(-0.6, 0.5, 0.0)).norm(), 1e-12);
  EXPECT_LT((extent(all.cell[0].mesh).max() - Eigen::Vector3d(0.6, 1.5, 0.7)).norm(), 1e-12);
  EXPECT_EQ(all.cell[1].name, "fence");
  EXPECT_NEAR(extent(all.cell[1].mesh).min().z(), 1.0, 1e-8);
  ASSERT_EQ(all.arm.size(), 4U);
  EXPECT_EQ(all.arm[0].name, "link 0");
  EXPECT_EQ(all.arm[0].pose.translation().z(), 0.5);
  EXPECT_EQ(all.arm[1].name, "link 2");
  ASSERT_TRUE(all.arm[1].capsule);
  // Along the link from its DH frame back to its joint.
  EXPECT_LT((all.arm[1].pose * all.arm[1].capsule->to_m).norm(), 1e-12);
  EXPECT_EQ(all.arm[1].capsule->diameter_m, 0.3);
  EXPECT_EQ(all.arm[2].name, "link 2 (2)");
  EXPECT_LT((all.arm[2].pose.translation() - Eigen::Vector3d(1.15, 0.02, 0.0)).norm(), 1e-12);
  EXPECT_EQ(all.arm[3].name, "forearm");
  EXPECT_LT((extent(all.arm[3].mesh).min() - Eigen::Vector3d(-0.1, -0.1, -1.2)).norm(), 1e-12);
  EXPECT_TRUE(all.tool.edges.empty());
  EXPECT_DOUBLE_EQ(all.tool.stickout_m, 0.05);
  EXPECT_DOUBLE_EQ(all.tool.shank_diameter_m, 0.012);
  ASSERT_EQ(all.tool.holder.size(), 2U);
  EXPECT_DOUBLE_EQ(all.tool.holder[0].upper_diameter_m, 0.04);
  EXPECT_DOUBLE_EQ(all.tool.holder[1].upper_diameter_m, 0.063);
  ASSERT_EQ(all.tool.spindle.size(), 1U);
  EXPECT_DOUBLE_EQ(all.tool.spindle[0].length_m, 0.2);
  EXPECT_DOUBLE_EQ(all.clearance_m, 2e-3);
  EXPECT_DOUBLE_EQ(all.gouge_tolerance_m, 50e-6);
  EXPECT_TRUE(all.self_collision);
  ASSERT_EQ(all.ignored.size(), 1U);
  EXPECT_EQ(all.ignored[0].second, "forearm");
}

TEST(GeometryToml, IsAbsentWhereTheFileHasNone) {
  EXPECT_FALSE(read("# no table\n").geometry);
}

TEST(GeometryToml, TakesASpindleOfAnyKind) {
  const Read mesh = read(with("{ length_mm = 200, diameter_mm = 150 }", "{ file = \"fence.stl\" }"));
  ASSERT_EQ(mesh.geometry->tool.spindle_bodies.size(), 1U);
  EXPECT_EQ(mesh.geometry->tool.spindle_bodies[0].name, "spindle");
  const Read both =
      read(with("{ length_mm = 200, diameter_mm = 150 }",
                "[{ length_mm = 9, diameter_mm = 8 }, { box_from_mm = [1, 1, 1], box_to_mm = [0, 0, 0] }]"));
  EXPECT_EQ(both.geometry->tool.spindle.size(), 1U);
  EXPECT_EQ(both.geometry->tool.spindle_bodies.at(0).name, "spindle (2)");
}

TEST(GeometryToml, NotesWhatIsNotChecked) {
  const std::string arm = good.substr(good.find("arm = ["), good.find("stickout_mm") - good.find("arm = ["));
  const Read found = read(
      test_support::replaced(with("part = \"part.stl\"\n", ""), arm, "ignore = []\n")
          .substr(0,
                  test_support::replaced(with("part = \"part.stl\"\n", ""), arm, "ignore = []\n").find("ignore = [{")));
  ASSERT_EQ(found.notes.size(), 2U);
  EXPECT_NE(found.notes[0].find("gouges are not checked"), std::string::npos);
  EXPECT_NE(found.notes[1].find("links are not checked"), std::string::npos);
}

TEST(GeometryToml, SaysWhatIsMissing) {
  const auto without = [](const std::string& line) { return said(with(line, "")); };
  EXPECT_NE(without("stickout_mm = 50\n").find("geometry.stickout_mm: is missing"), std::string::npos);
  EXPECT_NE(without("clearance_mm = 2\n").find("geometry.clearance_mm: is missing"), std::string::npos);
  EXPECT_NE(without("gouge_tolerance_mm = 0.05\n").find("geometry.gouge_tolerance_mm: is missing"), std::string::npos);
  EXPECT_NE(without(", box_to_mm = [1500, 600, 700]").find("geometry.cell[1].box_to_mm: is missing"),
            std::string::npos);
  EXPECT_NE(without(", to_mm = [-1150, 0, 0]").find("geometry.arm[2].to_mm: is missing"), std::string::npos);
  EXPECT_NE(without("link = 4, ").find("geometry.arm[4].link: is missing"), std::string::npos);
  EXPECT_NE(said("[geometry]\npart = \"part.stl\"\nstickout_mm = 50\n").find("geometry.holder: is missing"),
            std::string::npos);
}

TEST(GeometryToml, RejectsWhatCannotBeWithItsLine) {
  const auto has = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  has(said(with("\"inch\"", "\"feet\"")), "cell.toml:2: geometry.stl_unit = \"feet\"; must be one of");
  has(said(with("part.stl", "none.stl")), "none.stl");
  has(said(with("link = 4", "link = 7")), "cell.toml:10: geometry.arm[4].link = 7; must be 0 for the base, or 1 to 6");
  has(said(with("diameter_mm = 300", "diameter_mm = 0")), "cell.toml:8: geometry.arm[2].diameter_mm = 0 mm");
  has(said(with("diameter_mm = 63", "diameter_mm = -63")), "geometry.holder[2].diameter_mm = -63 mm");
  has(said(with("clearance_mm = 2", "clearance_mm = -2")), "geometry.clearance_mm = -2 mm");
  has(said(with("stickout_mm = 50", "stickout_mm = 0")), "geometry.stickout_mm = 0 mm");
  has(said(with("name = \"forearm\"", "name = \"link 2\"")), "geometry.arm[4].name");
  has(said(with("\"forearm\" }]", "\"foreram\" }]")), "must name a body");
  has(said(with("box_to_mm = [1500, 600, 700]", "box_to_mm = [1500, 600, 0]")), "must differ from box_from_mm");
  has(said(with("self_collision = true", "self_colision = true")), "self_colision: is not known here");
  has(said(with("{ link = 0, file = \"base.stl\" }", "{ link = 0, file = \"base.stl\", fil = 1 }")), "fil");
}

TEST(GeometryToml, DamagedFilesAreReadOrRejected) {
  Random random(54);
  int read_all = 0;
  for (int k = 0; k < test::seeds(1000); ++k) {
    try {
      read_all += read(test_support::damaged(good, k, random)).geometry ? 1 : 0;
    } catch (const InvalidInput&) {
      continue;
    }
  }
  EXPECT_GT(read_all, 0);
}

// What the file says serves a checker once the cutter is known.
TEST(GeometryToml, ServesAChecker) {
  CellGeometry geometry = *read(good).geometry;
  geometry.tool.edges = {{0.0, 6e-3}, {25e-3, 6e-3}};
  const Cell cell = testing::kr210_cell();
  EXPECT_TRUE(CollisionChecker(cell, geometry).notes().empty());
}

}  // namespace geometry_toml_test
}  // namespace robomill::robot
