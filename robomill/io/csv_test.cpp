#include "robomill/io/csv.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "robomill/io/table.hpp"

namespace robomill::io {
namespace csv_test {

// What is written comes back through the reader of tables.
TEST(Csv, RowsComeBackAsTheyWere) {
  const std::string evil = "a \"b\",\nc";
  std::string table = "number,none,text\n";
  add_csv_row(table, {csv_number(0.0123, 1e-3), csv_number(std::nan("")), csv_text(evil)});
  add_csv_row(table, {csv_number(1.0 / 3.0), csv_number(std::numeric_limits<double>::infinity()), csv_text("")});
  EXPECT_EQ(table, "number,none,text\n12.3,,\"a \"\"b\"\", c\"\n0.333333333,,\"\"\n");
  std::vector<std::string> warnings;
  const TextTable read = parse_text_table(table, "t.csv", warnings);
  ASSERT_EQ(read.rows.size(), 2U);
  EXPECT_EQ(read.text(read.rows[0], "text"), "a \"b\", c");
  EXPECT_EQ(read.text(read.rows[0], "none"), "");
}

}  // namespace csv_test
}  // namespace robomill::io
