#include "robomill/cutting/files/cut_schema.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace cut_schema_test {

CutTable cut_of(const std::string& text) {
  io::TomlFile file(io::TomlSource("cut.toml", "[cut]\n" + text));
  CutTable out;
  cut_table().read(file, "cut", out);
  static_cast<void>(file.done());
  return out;
}

StockTable stock_table_of(io::TomlFile& file) {
  StockTable out;
  stock_table().read(file, "stock", out);
  return out;
}

std::optional<Stock> stock_in(const std::string& text) {
  io::TomlFile file(io::TomlSource("stock.toml", "[stock]\n" + text));
  std::optional<Stock> out = stock_of(file, stock_table_of(file));
  static_cast<void>(file.done());
  return out;
}

TEST(CutSchema, ReadsEveryKeyInSi) {
  const CutTable cut = cut_of(
      "kind = \"drilling\"\ndirection = \"down\"\nentry_deg = 10\nexit_deg = 90\nstepover_mm = 4\n"
      "axial_depth_mm = 1.5\nfeed_per_tooth_mm = 0.05\nfeed_per_revolution_mm = 0.2\nspindle_speed_rpm = 12000\n"
      "feed_direction_deg = 30\nlead_deg = 10\ntilt_deg = -5\nsurface_radius_along_feed_mm = 50\n"
      "surface_radius_across_feed_mm = -20\nforce_on = \"workpiece\"\n");
  EXPECT_TRUE(cut.drilling);
  EXPECT_EQ(cut.direction, MillingDirection::down);
  EXPECT_DOUBLE_EQ(cut.entry_rad.value(), 10.0 * units::deg);
  EXPECT_DOUBLE_EQ(cut.exit_rad.value(), 90.0 * units::deg);
  EXPECT_DOUBLE_EQ(cut.radial_depth_m.value(), 4e-3);
  EXPECT_DOUBLE_EQ(cut.axial_depth_m.value(), 1.5e-3);
  EXPECT_DOUBLE_EQ(cut.feed_per_tooth_m, 5e-5);
  EXPECT_DOUBLE_EQ(cut.feed_per_revolution_m.value(), 2e-4);
  EXPECT_DOUBLE_EQ(cut.spindle_speed_rad_per_s.value(), 12000.0 * units::rpm);
  EXPECT_DOUBLE_EQ(cut.feed_direction_rad, 30.0 * units::deg);
  EXPECT_DOUBLE_EQ(cut.lead_rad, 10.0 * units::deg);
  EXPECT_DOUBLE_EQ(cut.tilt_rad, -5.0 * units::deg);
  EXPECT_DOUBLE_EQ(cut.curvature_along_feed_per_m, 20.0);
  EXPECT_DOUBLE_EQ(cut.curvature_across_feed_per_m, -50.0);
  EXPECT_TRUE(cut.force_on_workpiece);
  const Cut milled = cut.milled();
  EXPECT_EQ(milled.direction, MillingDirection::down);
  EXPECT_DOUBLE_EQ(milled.radial_depth_m, 4e-3);
  EXPECT_DOUBLE_EQ(milled.curvature_across_feed_per_m, -50.0);
  const io::Json written = cut_table().write(cut);
  EXPECT_EQ(written["surface_radius_across_feed_mm"], -20.0);
  EXPECT_EQ(written["spindle_speed_rpm"], 12000.0);
}

TEST(CutSchema, RejectsInTheFilesWords) {
  const auto expect = [](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(cut_of(text)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("radial_depth_mm = 3\nstepover_mm = 3\n", "cut.toml:3: cut.stepover_mm = 3 mm; must not stand beside");
  expect("radial_depth_mm = 0\n", "cut.toml:2: cut.radial_depth_mm = 0 mm; must be > 0");
  expect("direction = \"Climb\"\n", "Climb milling is \"down\" here");
  expect("direction = \"across\"\n", "must be one of \"up\", \"down\", \"slot\"");
  expect("surface_radius_along_feed_mm = 0\n", "must not be 0");
  expect("spindle_speed_rpm = 0\n", "cut.spindle_speed_rpm = 0 rpm; must be > 0");
  expect("feed_per_tooth_mm = -1\n", "must be >= 0");
  expect("force_on = \"part\"\n", "must be one of \"tool\", \"workpiece\"");
  expect("lead_dg = 3\n", "Did you mean cut.lead_deg?");
}

TEST(CutSchema, AStockHasTheKeysOfItsKind) {
  const std::optional<Stock> box = stock_in("kind = \"box\"\nmin_mm = [0, 0, -5]\nmax_mm = [10, 20, 0]\n");
  ASSERT_TRUE(box);
  EXPECT_DOUBLE_EQ(box->min_m.z(), -5e-3);
  EXPECT_DOUBLE_EQ(box->max_m.y(), 20e-3);
  const std::optional<Stock> round = stock_in("kind = \"cylinder\"\nradius_mm = 4\nbottom_mm = -3\ntop_mm = 1\n");
  ASSERT_TRUE(round);
  EXPECT_EQ(round->shape, Stock::Shape::cylinder);
  EXPECT_DOUBLE_EQ(round->radius_m, 4e-3);
  EXPECT_EQ(round->center_m, Eigen::Vector2d::Zero());
  EXPECT_FALSE(stock_in("dexel_mm = 0.1\n"));
  EXPECT_FALSE(stock_in("kind = \"neighbours\"\n"));
  const auto expect = [](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(stock_in(text)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect("kind = \"box\"\nmin_mm = [0, 0, -5]\n", "stock.max_mm: is missing");
  expect("kind = \"box\"\nmin_mm = [0, 0]\nmax_mm = [10, 20, 0]\n", "stock.min_mm: must hold 3 entries; it holds 2");
  expect("kind = \"box\"\nmin_mm = [0, 0, 1]\nmax_mm = [10, 20, 0]\n",
         "stock.toml:4: stock.max_mm[3] = 0 mm; must be above");
  expect("kind = \"cylinder\"\nradius_mm = 4\nbottom_mm = -3\ntop_mm = 1\nmin_mm = [0, 0, 0]\n",
         "stock.min_mm: is no part of this kind of stock");
  expect("min_mm = [0, 0, -5]\n", "stock.kind says which it is");
  expect("kind = \"sphere\"\n", "must be one of \"box\"");
  expect("dexel_mm = 0\n", "stock.dexel_mm = 0 mm; must be > 0");
}

}  // namespace cut_schema_test
}  // namespace robomill::cutting
