#include "robomill/base/error.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace robomill {
namespace error_test {

TEST(InvalidInput, SaysFieldValueUnitRuleAndHint) {
  const InvalidInput error("tangential_n_per_m2", 0.0, "N/m^2", "must be > 0", "Aluminium is near 7e8");
  EXPECT_STREQ(error.what(), "tangential_n_per_m2 = 0 N/m^2; must be > 0. Aluminium is near 7e8");
}

TEST(InvalidInput, SaysWhereWhenKnown) {
  InvalidInput::Parts parts = InvalidInput("teeth", 0, "", "must be >= 1").parts();
  parts.where = "lobes.toml:3";
  parts.field = "tool.teeth";
  EXPECT_STREQ(InvalidInput(parts).what(), "lobes.toml:3: tool.teeth = 0; must be >= 1");
}

TEST(InvalidInput, ReadsWellWithoutAValue) {
  EXPECT_STREQ(InvalidInput("hits.csv", "no such file").what(), "hits.csv: no such file");
}

// Lines to copy stand below each other; a line end that a file has is none.
TEST(InvalidInput, KeepsLinesThatAreIndented) {
  const InvalidInput error("a.csv\n  b", "says too little\nor too much",
                           "Write these lines:\n  [hits]\n  force = \"a\x1b\"");
  EXPECT_STREQ(error.what(),
               "a.csv\\n  b: says too little\\nor too much. Write these lines:\n  [hits]\n  force = \"a\\x1b\"");
}

TEST(Require, RejectsNaNAndInfinity) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(require_positive("a", nan, "m"), InvalidInput);
  EXPECT_THROW(require_positive("a", infinity, "m"), InvalidInput);
  EXPECT_THROW(require_positive("a", 0.0, "m"), InvalidInput);
  EXPECT_NO_THROW(require_non_negative("a", 0.0, "m"));
  EXPECT_THROW(require_non_negative("a", -1e-300, "m"), InvalidInput);
  EXPECT_THROW(require_finite("a", -infinity, "m"), InvalidInput);
}

}  // namespace error_test
}  // namespace robomill
