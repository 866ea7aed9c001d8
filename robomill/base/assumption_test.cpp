#include "robomill/base/assumption.hpp"

#include <gtest/gtest.h>

namespace robomill {
namespace assumption_test {

TEST(Assumptions, StandOnceInALine) {
  std::vector<Assumption> assumed = {{.what = "Helix", .taken = "0°", .key = "tool.helix_deg", .file = "lobes.toml"}};
  add_assumed(assumed, {assumed.front(),
                        {.what = "Helix", .taken = "0°", .key = "tool.helix_deg", .file = "forces.toml"},
                        {.what = "Teeth", .taken = "4", .key = "--teeth"},
                        {.what = "Unit", .taken = "\x1b[31m"}});
  ASSERT_EQ(assumed.size(), 4U);
  EXPECT_EQ(assumed_text(assumed),
            "Assumed, because not given:\n"
            "  Helix: 0° (tool.helix_deg of lobes.toml)\n"
            "  Helix: 0° (tool.helix_deg of forces.toml)\n"
            "  Teeth: 4 (--teeth)\n"
            "  Unit: \\x1b[31m\n");
  EXPECT_EQ(assumed_text({}), "");
}

}  // namespace assumption_test
}  // namespace robomill
