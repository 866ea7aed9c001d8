#include "robomill/base/names.hpp"

#include <gtest/gtest.h>

namespace robomill {
namespace names_test {

enum class Tooth { straight, helical, none };
constexpr Name<Tooth> tooth_names[] = {{"straight", Tooth::straight}, {"helical", Tooth::helical}};

TEST(Names, AreReadAndWrittenByOneTable) {
  for (const auto& [name, tooth] : tooth_names) {
    EXPECT_EQ(name_in(tooth_names, tooth), name);
    EXPECT_EQ(value_in(tooth_names, name), tooth);
  }
  EXPECT_TRUE(name_in(tooth_names, Tooth::none).empty());
  EXPECT_FALSE(value_in(tooth_names, "helica"));
  EXPECT_EQ(one_of(tooth_names), "must be one of \"straight\", \"helical\"");
}

}  // namespace names_test
}  // namespace robomill
