#include "robomill/jobs/monitor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace monitor_test {

live::AdviceBasis basis_of(const std::string& lobes, const test::Folder& folder, double highest_rpm = 9000.0,
                           int teeth = 0) {
  monitor::MonitorFile file;
  file.options.sample_rate_hz = 10'240.0;
  file.lobes = folder.file("lobes.toml", lobes);
  file.act.lowest_rad_per_s = 3000.0 * units::rpm;
  file.act.highest_rad_per_s = highest_rpm * units::rpm;
  file.options.teeth = teeth;
  return read_advice_basis(file, Progress::none());
}

bool couples(const live::AdviceBasis& basis, bool wanted) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < basis.mode_coupling.size(); ++i) {
    if (basis.lobes->limit[i].status != stability::Limit::Status::found) continue;
    ++found;
    if (basis.mode_coupling[i] != wanted) return false;
  }
  return found > 0 && basis.mode_coupling.size() == basis.lobes->limit.size();
}

// Source: stability/peak_classification_test.cpp. One direction has nothing to couple with; two equal modes in a slot
// without radial force couple, at any speed at which the cut is fast.
TEST(ReadAdviceBasis, KnowsWhereModesCouple) {
  const test::Folder folder;
  const std::string mode = "[{ frequency_hz = 922, damping_ratio = 0.011, modal_mass_kg = 0.03993 }]\n";
  const std::string tool =
      "diameter_mm = 10\n[cut]\ndirection = \"down\"\nradial_depth_mm = 10\nfeed_per_tooth_mm = 0.05\n";
  const std::string lobes = "[lobes]\ngrid = [5, 20]\n";
  const live::AdviceBasis one = basis_of("[tool]\nteeth = 2\n" + tool +
                                             "[coefficients]\ntangential_n_per_mm2 = 600\nradial_n_per_mm2 = 200\n"
                                             "[dynamics]\nx = " +
                                             mode + "rigid_directions = [\"y\"]\n" + lobes +
                                             "spindle_speed_rpm = [4800, 5200]\naxial_depth_mm = [0, 2]\n",
                                         folder);
  EXPECT_TRUE(couples(one, false));
  EXPECT_NEAR(one.lowest_rad_per_s, 3000.0 * units::rpm, 1e-9);
  EXPECT_NEAR(one.highest_rad_per_s, 9000.0 * units::rpm, 1e-9);
  EXPECT_EQ(one.teeth, 2);
  const live::AdviceBasis two =
      basis_of("[tool]\nteeth = 8\n" + tool +
                   "[coefficients]\ntangential_n_per_mm2 = 600\nradial_n_per_mm2 = 0\n"
                   "[dynamics]\nx = " +
                   mode + "y = " + mode + lobes + "spindle_speed_rpm = [50000, 60000]\naxial_depth_mm = [0, 2]\n",
               folder, 60000.0);
  EXPECT_TRUE(couples(two, true));
}

TEST(ReadAdviceBasis, RejectsAMonitorOfAnotherCut) {
  const test::Folder folder;
  const std::string lobes =
      "[tool]\nteeth = 3\ndiameter_mm = 10\n[cut]\ndirection = \"down\"\nradial_depth_mm = 2\nfeed_per_tooth_mm = "
      "0.05\n"
      "[coefficients]\ntangential_n_per_mm2 = 600\nradial_n_per_mm2 = 200\n[dynamics]\n"
      "x = [{ frequency_hz = 922, damping_ratio = 0.011, modal_mass_kg = 0.03993 }]\nrigid_directions = [\"y\"]\n"
      "[lobes]\ngrid = [5, 10]\nspindle_speed_rpm = [8000, 12000]\naxial_depth_mm = [0, 2]\n";
  const auto say = [&](double highest_rpm, int teeth) {
    return test::rejection([&] { static_cast<void>(basis_of(lobes, folder, highest_rpm, teeth)); });
  };
  EXPECT_EQ(basis_of(lobes, folder, 9000.0, 3).teeth, 3);
  std::string said = say(9000.0, 2);
  EXPECT_NE(said.find("process.teeth: is 2, and"), std::string::npos) << said;
  EXPECT_NE(said.find("has a cutter of 3"), std::string::npos) << said;
  said = say(6000.0, 3);
  EXPECT_NE(said.find("act.spindle_speed_rpm: is 3000 to 6000 rpm"), std::string::npos) << said;
  EXPECT_NE(said.find("go from 8000 to 12000 rpm"), std::string::npos) << said;
}

// Where no filter is stated lines may be folded about the sample rate, which then must be known.
TEST(ReadAdviceBasis, KnowsWhetherLinesMayBeFolded) {
  monitor::MonitorFile file;
  EXPECT_NE(test::rejection([&] { (void)read_advice_basis(file, Progress::none()); }).find("signal.sample_rate_hz"),
            std::string::npos);
  file.options.sample_rate_hz = 1650.0;
  EXPECT_EQ(read_advice_basis(file, Progress::none()).unfiltered_sample_rate_hz, 1650.0);
  file.anti_alias_filter = true;
  EXPECT_EQ(read_advice_basis(file, Progress::none()).unfiltered_sample_rate_hz, 0.0);
}

}  // namespace monitor_test
}  // namespace robomill::jobs
