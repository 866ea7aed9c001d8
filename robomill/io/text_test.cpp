#include "robomill/io/text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"

namespace robomill::io {
namespace text_test {

TEST(Text, ReadsNumbersInEverySpelling) {
  EXPECT_EQ(parse_number("1.5"), 1.5);
  EXPECT_EQ(parse_number("+1.5"), 1.5);
  EXPECT_EQ(parse_number("3.100538e-020"), 3.100538e-20);
  EXPECT_EQ(parse_number("1.25D-03"), 1.25e-3);
  EXPECT_EQ(parse_number("-1.25d+003"), -1250.0);
  EXPECT_EQ(parse_number(".5"), 0.5);
  EXPECT_EQ(parse_number("5."), 5.0);
  EXPECT_EQ(parse_number("1e400"), std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_number("-1e400"), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(parse_number("1e-400"), 0.0);
  EXPECT_EQ(parse_number("1D-400"), 0.0);
  EXPECT_TRUE(std::isnan(parse_number("nan").value()));
  EXPECT_TRUE(std::isinf(parse_number("-inf").value()));
  for (const char* text :
       {"", "+", "+-1", "++1", "1.5x", "1 5", "x", "1D", "D3", "0x10", "1,5", "--1", "1e", "1d5d5"}) {
    EXPECT_FALSE(parse_number(text).has_value()) << text;
  }
}

TEST(Text, RoundsAwayWhatAConversionAdds) {
  EXPECT_EQ(round_15(4000.0 * units::rpm / units::rpm), 4000.0);
  EXPECT_EQ(round_15(4000.0000000000005), 4000.0);
  EXPECT_EQ(round_15(0.0), 0.0);
  EXPECT_TRUE(std::isnan(round_15(std::numeric_limits<double>::quiet_NaN())));
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double shop = std::round(random.uniform(-1e6, 1e6)) / 1000.0;
    for (const double factor : {units::mm, units::deg, units::rpm, units::n_per_mm2, units::um}) {
      EXPECT_EQ(round_15(shop * factor / factor), shop);
    }
  }
}

TEST(Text, FindsTheNearestWord) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("teeth", "teteh"), 1u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  const std::vector<std::string> known = {"diameter_mm", "teeth", "helix_deg"};
  EXPECT_EQ(nearest_word("Diameter_mm", known), "diameter_mm");
  EXPECT_EQ(nearest_word("tooth", known), "teeth");
  EXPECT_EQ(nearest_word("runout_um", known), "");
}

}  // namespace text_test
}  // namespace robomill::io
