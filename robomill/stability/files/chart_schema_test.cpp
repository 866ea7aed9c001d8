#include "robomill/stability/files/chart_schema.hpp"

#include <gtest/gtest.h>

#include "robomill/base/units.hpp"
#include "robomill/cutting/files/cutter_schema.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace chart_schema_test {

TEST(ChartSchema, ReadsTheTablesOfACut) {
  io::TomlFile file(io::TomlSource("lobes.toml", R"([tool]
teeth = 3
diameter_mm = 12
helix_deg = [30, 32, 34]
[lobes]
spindle_speed_rpm = [4000, 16000]
axial_depth_mm = [0, 6]
grid = [120, 40]
method = "zeroth-order"
[uncertainty]
frequency_std_ratio = 0.01
)"));
  cutting::Cutter cutter;
  ChartTable chart;
  Uncertainty uncertainty;
  cutting::cutter_table().read(file, "tool", cutter);
  chart_options_table().read(file, "lobes", chart);
  uncertainty_options_table().read(file, "uncertainty", uncertainty);
  EXPECT_TRUE(file.done().empty());
  EXPECT_EQ(cutter.mill.teeth, 3);
  EXPECT_EQ(cutter.mill.tooth_helix_rad[2], 34.0 * units::deg);
  const LobesOptions& options = chart.options;
  EXPECT_EQ(options.spindle_speed_rad_per_s[0], 4000.0 * units::rpm);
  EXPECT_EQ(options.grid, (std::array<int, 2>{120, 40}));
  EXPECT_EQ(options.method, Method::zeroth_order);
  EXPECT_EQ(options.tolerance, LobesOptions{}.tolerance);
  EXPECT_EQ(uncertainty.frequency_std_ratio, 0.01);
  const io::Json written = cutting::cutter_table().write(cutter);
  EXPECT_EQ(written["helix_deg"], io::Json({30.0, 32.0, 34.0}));
  EXPECT_EQ(cutting::cutter_table().write(cutting::Cutter{})["helix_deg"], 0.0);
}

TEST(ChartSchema, RejectsARangeOfTheWrongLength) {
  io::TomlFile file(io::TomlSource("lobes.toml", "[lobes]\nspindle_speed_rpm = 4000\naxial_depth_mm = [0, 6]\n"));
  ChartTable chart;
  EXPECT_EQ(test::rejection([&] { chart_options_table().read(file, "lobes", chart); }),
            "lobes.toml:2: lobes.spindle_speed_rpm = 4000 rpm; must hold 2 entries; it holds 1");
}

}  // namespace chart_schema_test
}  // namespace robomill::stability
