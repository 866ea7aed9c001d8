#include "robomill/report/drawing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <regex>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/report/json.hpp"

namespace robomill::report {
namespace {

coupling::Segment segment(double length_mm, double diameter_mm, double bore_mm = 0.0) {
  return {.length_m = length_mm * units::mm,
          .diameter_m = diameter_mm * units::mm,
          .inner_diameter_m = bore_mm * units::mm,
          .youngs_modulus_pa = 200 * units::gpa,
          .density_kg_per_m3 = 7800.0};
}

std::string drawn(const coupling::Assembly& assembly) {
  return assembly_drawing(assembly_json({.assembly = assembly}));
}

struct Box {
  std::string kind;
  double x, y, width, height;
};

std::vector<Box> boxes(const std::string& svg) {
  static const std::regex shape(
      "<rect class=\"([a-z ]+)\" x=\"([-0-9.]+)\" y=\"([-0-9.]+)\" width=\"([-0-9.]+)\" "
      "height=\"([-0-9.]+)\"");
  std::vector<Box> out;
  for (std::sregex_iterator it(svg.begin(), svg.end(), shape), end; it != end; ++it) {
    out.push_back({(*it)[1], std::stod((*it)[2]), std::stod((*it)[3]), std::stod((*it)[4]), std::stod((*it)[5])});
  }
  return out;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// Kept in order, none over another, within the room where all fit; and no arrangement of the same kind is nearer to
// the targets: moving any label or any run of labels that touch makes it worse.
TEST(SideBySide, IsTheNearestArrangementWithoutOverlap) {
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    const std::size_t n = 1 + random.index(12);
    std::vector<double> targets(n);
    std::vector<double> widths(n);
    for (double& target : targets) target = random.uniform(0.0, 900.0);
    for (double& width : widths) width = random.uniform(5.0, 70.0);
    std::ranges::sort(targets);
    const std::vector<double> at = side_by_side(targets, widths, 0.0, 900.0);
    ASSERT_EQ(at.size(), n);
    EXPECT_GE(at.front() - 0.5 * widths.front(), -1e-9);
    EXPECT_LE(at.back() + 0.5 * widths.back(), 900.0 + 1e-9);
    for (std::size_t i = 1; i < n; ++i) EXPECT_GE(at[i] - at[i - 1], 0.5 * (widths[i] + widths[i - 1]) - 1e-9);
    for (std::size_t i = 0; i < n; ++i) {
      // Moved towards its target, a label would touch a neighbour or the edge.
      const double wish = targets[i] - at[i];
      if (std::abs(wish) < 1e-9) continue;
      const bool right = wish > 0.0;
      const double room = right ? (i + 1 < n ? at[i + 1] - 0.5 * widths[i + 1] : 900.0) - at[i] - 0.5 * widths[i]
                                : at[i] - 0.5 * widths[i] - (i > 0 ? at[i - 1] + 0.5 * widths[i - 1] : 0.0);
      EXPECT_LT(room, 1e-9);
    }
  }
}

TEST(SideBySide, LeavesAloneWhatDoesNotTouch) {
  EXPECT_EQ(side_by_side({100.0, 300.0}, {50.0, 50.0}, 0.0, 900.0), (std::vector<double>{100.0, 300.0}));
  EXPECT_EQ(side_by_side({100.0, 100.0}, {50.0, 50.0}, 0.0, 900.0), (std::vector<double>{75.0, 125.0}));
  EXPECT_TRUE(side_by_side({}, {}, 0.0, 900.0).empty());
}

// One scale for lengths and diameters, whatever the proportions.
TEST(Drawing, IsToScale) {
  for (const double stretch : {0.05, 1.0, 40.0}) {
    coupling::Assembly assembly;
    assembly.tool = {segment(30.0 * stretch, 12.0), segment(60.0 * stretch, 16.0, 4.0)};
    assembly.tool[0].flutes = 4;
    assembly.joint = coupling::Joint{.translational_stiffness_n_per_m = 1e7, .rotational_stiffness_n_m_per_rad = 1e5};
    assembly.holder.segments = {segment(40.0 * stretch, 40.0, 16.0)};
    const std::vector<Box> all = boxes(drawn(assembly));
    std::vector<Box> parts;
    std::ranges::copy_if(all, std::back_inserter(parts),
                         [](const Box& b) { return b.kind == "tool" || b.kind == "holder"; });
    ASSERT_EQ(parts.size(), 3U);
    EXPECT_EQ(std::ranges::count(all, std::string("flutes"), &Box::kind), 1);
    const double scale = parts[0].width / (30.0 * stretch);
    const double tenth = 0.11;  // of a unit: coordinates have one decimal
    EXPECT_NEAR(parts[1].width, scale * 60.0 * stretch, 2.0 * tenth * (1.0 + stretch));
    EXPECT_NEAR(parts[2].width, scale * 40.0 * stretch, 2.0 * tenth * (1.0 + stretch));
    EXPECT_NEAR(parts[2].height, parts[0].height * 40.0 / 12.0, 4.0 * tenth);
    EXPECT_NEAR(parts[0].height / 12.0, scale, 0.02 * scale + tenth);
    EXPECT_NEAR(parts[1].x, parts[0].x + parts[0].width, tenth);
    for (const Box& b : all) {
      EXPECT_GE(b.x, 0.0);
      EXPECT_LE(b.x + b.width, 900.1);
    }
  }
}

TEST(Drawing, ShowsWhatHoldsTheTool) {
  coupling::Assembly assembly;
  assembly.tool = {segment(100.0, 12.0)};
  const std::string wall = drawn(assembly);
  EXPECT_NE(wall.find("joined rigidly to a rigid wall"), std::string::npos);
  EXPECT_NE(wall.find("class=\"wall\""), std::string::npos);
  EXPECT_EQ(wall.find("class=\"spring\""), std::string::npos);
  assembly.holder.receptances.frfs.resize(1);
  const std::string measured = drawn(assembly);
  EXPECT_NE(measured.find("a measured holder"), std::string::npos);
  EXPECT_EQ(measured.find("class=\"wall\""), std::string::npos);
}

TEST(Drawing, MarksEveryPointOfADistributedJointOnBothSides) {
  coupling::Assembly assembly;
  assembly.tool = {segment(60.0, 12.0)};
  assembly.joint = coupling::Joint{.translational_stiffness_n_per_m = 1e7,
                                   .rotational_stiffness_n_m_per_rad = 1e5,
                                   .points = 5,
                                   .insertion_length_m = 30.0 * units::mm,
                                   .shank = {segment(30.0, 12.0)}};
  assembly.holder.segments = {segment(50.0, 32.0, 12.0)};
  const std::string svg = drawn(assembly);
  EXPECT_EQ(count(svg, "class=\"point\""), 10U);
  EXPECT_EQ(count(svg, "class=\"plate\""), 1U) << "of the wall; the joint has no gap";
}

// A hundred segments are still a drawing: labels that do not fit are left to the table.
TEST(Drawing, LeavesOutLabelsWithoutRoom) {
  coupling::Assembly assembly;
  for (int i = 0; i < 100; ++i) assembly.tool.push_back(segment(1.0 + i % 3, 10.0 + i % 7));
  const std::string svg = drawn(assembly);
  EXPECT_LT(count(svg, "<text"), 6U);
  EXPECT_EQ(count(svg, "class=\"tool\""), 100U);
}

TEST(Bands, JoinNeighbouringLines) {
  const Eigen::VectorXd axis = Eigen::VectorXd::LinSpaced(10, 10.0, 100.0);
  EXPECT_EQ(bands_json(axis, {}).size(), 0U);
  const nlohmann::ordered_json bands = bands_json(axis, {10.0, 40.0, 50.0, 55.0, 100.0});
  ASSERT_EQ(bands.size(), 3U);
  EXPECT_EQ(bands[0], (nlohmann::ordered_json{10.0, 15.0}));
  EXPECT_EQ(bands[1], (nlohmann::ordered_json{35.0, 55.0}));
  EXPECT_EQ(bands[2], (nlohmann::ordered_json{95.0, 100.0}));
}

}  // namespace
}  // namespace robomill::report
