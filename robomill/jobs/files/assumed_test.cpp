#include "robomill/jobs/files/assumed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "testing/support.hpp"

namespace robomill::jobs {
namespace assumed_test {

using test::Folder;

const std::string mode = "[{ frequency_hz = 500, damping_ratio = 0.02, modal_mass_kg = 1 }]\n";
const std::string tool = "[tool]\nteeth = 3\ndiameter_mm = 12\n";
const std::string cut = "[cut]\ndirection = \"up\"\nradial_depth_mm = 1.8\nfeed_per_tooth_mm = 0.01\n";
const std::string rest =
    "[coefficients]\ntangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n[lobes]\n"
    "spindle_speed_rpm = [6000, 9000]\naxial_depth_mm = [0, 3]\n[dynamics]\nx = " +
    mode + "y = " + mode;

std::vector<std::string> keys(const std::vector<Assumption>& assumed) {
  std::vector<std::string> out;
  for (const Assumption& one : assumed) out.push_back(one.key);
  return out;
}

TEST(AssumedOfACut, NamesWhatItsFileLeavesOut) {
  const Folder folder;
  const LobesFile bare = read_lobes(folder.file("bare.toml", tool + cut + rest));
  EXPECT_EQ(keys(assumed_of(bare, CutUse::stability)),
            (std::vector<std::string>{"tool.kind", "tool.helix_deg", "cut.feed_direction_deg", "workpiece_dynamics"}));
  const auto motion = keys(assumed_of(bare, CutUse::motion));
  for (const char* key : {"tool.runout_um", "coefficients.tangential_edge_n_per_mm"}) {
    EXPECT_EQ(std::ranges::count(motion, key), 1) << key;
  }
  for (const Assumption& one : assumed_of(bare, CutUse::motion)) {
    EXPECT_EQ(one.file, "bare.toml");
    EXPECT_FALSE(one.what.empty());
    EXPECT_FALSE(one.taken.empty());
  }
}

TEST(AssumedOfACut, IsEmptyWhereAllIsSaid) {
  const Folder folder;
  const LobesFile whole = read_lobes(folder.file(
      "whole.toml", tool + "kind = \"flat-end\"\nhelix_deg = 30\nrunout_um = 2\n" + cut + "feed_direction_deg = 0\n" +
                        rest + "[workpiece_dynamics]\nx = " + mode + "y = " + mode));
  EXPECT_EQ(keys(assumed_of(whole, CutUse::stability)), std::vector<std::string>{});
  EXPECT_EQ(keys(assumed_of(whole, CutUse::motion)), std::vector<std::string>{"coefficients.tangential_edge_n_per_mm"});
}

TEST(AssumedOfACut, IsEmptyOfWhatNoFileSays) {
  EXPECT_TRUE(assumed_of(LobesFile{}, CutUse::motion).empty());
}

}  // namespace assumed_test
}  // namespace robomill::jobs
