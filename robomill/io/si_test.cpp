#include "robomill/io/si.hpp"

#include <gtest/gtest.h>

namespace robomill::io {
namespace si_test {

TEST(Si, KnowsUnitsInEverySpelling) {
  for (const char* text : {"m/s^2", "m/s2", "m/s\xC2\xB2", "m/s\xB2", "(m/s^2)", "M/S**2", "m / s2", "m/s/s"}) {
    EXPECT_EQ(parse_unit(text).quantity, Quantity::acceleration) << text;
    EXPECT_EQ(parse_unit(text).factor, 1.0) << text;
  }
  EXPECT_EQ(parse_unit("g").factor, 9.80665);
  EXPECT_EQ(parse_unit("mm/s^2").factor, 1e-3);
  EXPECT_EQ(parse_unit("\xC2\xB5m").factor, 1e-6);
  EXPECT_EQ(parse_unit("\xCE\xBCm").factor, 1e-6);
  EXPECT_EQ(parse_unit("kN").factor, 1e3);
  EXPECT_EQ(parse_unit("kN").quantity, Quantity::force);
  for (const char* text : {"(1/N)*(m/s\xB2)", "(m/s^2)/N", "m/s2/N", "1/N m/s2"}) {
    EXPECT_EQ(parse_unit(text).quantity, Quantity::acceleration) << text;
    EXPECT_EQ(parse_unit(text).factor, 1.0) << text;
  }
  EXPECT_EQ(parse_unit("mm/kN").quantity, Quantity::displacement);
  EXPECT_DOUBLE_EQ(parse_unit("mm/kN").factor, 1e-6);
  for (const char* text : {"", "NONE", "V", "Pa", "/N", "1/N", "furlong/N"}) {
    EXPECT_EQ(parse_unit(text).quantity, Quantity::unknown) << text;
  }
}

TEST(Si, TakesTheUnitBeforeTheFactorsOfTheFile) {
  const SiFactor g = si_factor({.type = 12, .unit = "g"}, 1000.0, 1.0);
  EXPECT_EQ(g.factor, 9.80665);
  EXPECT_FALSE(g.note.empty());
  const SiFactor mm = si_factor({.type = 12}, 1000.0, 1.0);
  EXPECT_EQ(mm.quantity, Quantity::acceleration);
  EXPECT_EQ(mm.factor, 1e-3);
  EXPECT_FALSE(mm.note.empty());
  EXPECT_EQ(si_factor({.type = 13, .length_exponent = 0, .force_exponent = 1}, 1.0, 1000.0).factor, 1e-3);
  EXPECT_EQ(si_factor({.type = 13}, 1.0, 1000.0).factor, 1e-3);
  const SiFactor volts = si_factor({.type = 12, .unit = "V"}, 1.0, 1.0);
  EXPECT_EQ(volts.factor, 1.0);
  EXPECT_NE(volts.note.find("not known here"), std::string::npos);
  EXPECT_TRUE(si_factor({.type = 8}, 1.0, 1.0).note.empty());
  EXPECT_EQ(si_factor({.type = 1, .unit = "m/s^2"}, 1.0, 1.0).quantity, Quantity::acceleration);
  EXPECT_EQ(si_factor({.type = 0}, 1.0, 1.0).quantity, Quantity::unknown);
}

TEST(Si, APlaceInBracketsIsNoUnit) {
  for (const char* name : {"x(:,1)", "x(2,:)", "x[:,0]", "out.signals(2).values", "c{1}"}) {
    EXPECT_EQ(unit_of_column(name), "") << name;
  }
  EXPECT_EQ(unit_of_column("s(2).force_n"), "N");
  EXPECT_EQ(unit_of_column("x(:,1) [g]"), "g");
  EXPECT_EQ(parse_unit("N·mm").factor, 1e-3);
}

}  // namespace si_test
}  // namespace robomill::io
