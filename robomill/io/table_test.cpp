#include "robomill/io/table.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace table_test {

using test::rejection;
using Columns = std::vector<std::vector<double>>;
using Names = std::vector<std::string>;

Table parse(const std::string& content) {
  std::vector<std::string> warnings;
  return parse_table(content, "t.csv", warnings);
}

TEST(Table, ReadsEverySeparator) {
  const Columns expected = {{0.0, 1.0}, {-2.5, 3e-20}, {4.0, 5.0}};
  for (const std::string content :
       {"0,-2.5,4\n1,3e-020,5\n", "0;-2.5;4\n1;3e-020;5", "0\t-2.5\t4\r\n1\t3e-020\t5\r\n",
        "  0  -2.5 4\n\n 1 3e-020   5  \n\n", "0, -2.5, 4\r1, 3e-020, 5\r", "0;-2,5;4\n1;3e-020;5,0\n",
        "0\t-2,5\t4,0\n1\t3e-020\t5\n", "0 ; -2.5 ; 4 ;\n1 ; 3e-020 ; 5 ;\n", "0,-2.5,4,\n1,3e-020,5,\n",
        "\"0\",\"-2.5\",\"4\"\n\"1\",\"3e-020\",\"5\"\n", "+0,-2.5D+00,+4.\n1,3D-20,.5e1\n",
        "# a comment\n\n0,-2.5,4\n% another\n// a third\n1,3e-020,5\n",
        "\xEF\xBB\xBF"
        "0,-2.5,4\n1,3e-020,5\n",
        "0\t-2.5\t\t4\n1 3e-020 5\n"}) {
    const Table table = parse(content);
    EXPECT_EQ(table.columns, expected) << content;
    EXPECT_TRUE(table.names.empty());
  }
}

TEST(Table, ReadsNames) {
  const Names expected = {"time", "force x", "a"};
  for (const std::string content :
       {"time,force x,a\n1,2,3\n", "\"time\",\"force x\",\"a\"\n1,2,3\n", "time\tforce x\ta\n1\t2\t3\n",
        "time;force x;a\n1;2;3\n", "time \"force x\" a\n1 2 3\n", "time,force x,a\ns,N,m/s2\n1,2,3\n",
        "Recorder 7\n2024-01-01\nrate,51200\ntime,force x,a\ns,N,g\n1,2,3\n", "time, force x, a,\n1,2,3,\n",
        "time,force x,a\n1 2 3\n"}) {
    const Table table = parse(content);
    EXPECT_EQ(table.names, expected) << content;
    EXPECT_EQ(table.columns, (Columns{{1.0}, {2.0}, {3.0}})) << content;
  }
  EXPECT_TRUE(parse("some words above\n1,2,3\n").names.empty());
}

TEST(Table, RejectsWhatIsNoTable) {
  const auto says = [](const std::string& content) { return rejection([&] { (void)parse(content); }); };
  EXPECT_EQ(says("t,x\n1,2\n\n3,4,5\n"), "t.csv:4: has 3 values where the lines before it have 2");
  EXPECT_EQ(says("t,x\n1,2\n3\n"), "t.csv:3: has 1 values where the lines before it have 2");
  EXPECT_EQ(says("t,x\n1,2\n3,abc\n"), "t.csv:3: x = \"abc\"; is no number");
  EXPECT_EQ(says("1,2\n3,nan\n"), "t.csv:2: column 2 = \"nan\"; must be a finite number");
  EXPECT_EQ(says("1,2\n3,1e999\n"), "t.csv:2: column 2 = \"1e999\"; must be a finite number");
  EXPECT_EQ(says("t,x\nNaN,2\n"), "t.csv:2: t = \"NaN\"; must be a finite number");
  EXPECT_EQ(says("1,2,3\n4,,6\n"), "t.csv:2: column 2: is empty");
  EXPECT_EQ(says("1,2\n3,\n"), "t.csv:2: has 1 values where the lines before it have 2");
  EXPECT_EQ(says("0.0, abc, 1\n"), "t.csv:1: column 2 = \"abc\"; is no number");
  EXPECT_EQ(says("just\nwords\n"), "t.csv: holds no line of numbers");
  EXPECT_EQ(says("\n\n"), "t.csv: holds no line of numbers");
  EXPECT_EQ(says(std::string("\xFF\xFE"
                             "1\0,\0",
                             6)),
            "t.csv: is no plain text. It is UTF-16: save it as UTF-8");
  EXPECT_EQ(says(std::string("a\0b", 3)), "t.csv: is no plain text. Is it a binary file?");
  std::string prose;
  for (int i = 0; i < 1000; ++i) prose += "words\n";
  EXPECT_EQ(says(prose), "t.csv:201: \"words\"; is no number");
}

TEST(Table, ReadsARowOfUnits) {
  const auto units = [](const std::string& row) { return parse("Time,Force,Acc\n" + row + "\n0,1,2\n1,2,3\n").units; };
  EXPECT_EQ(units("s,N,g"), (Names{"s", "N", "g"}));
  EXPECT_EQ(units("(s),(kN),(m/s^2)"), (Names{"s", "kN", "m/s^2"}));
  EXPECT_EQ(units("[ms],[V],[µε]"), (Names{"ms", "V", "µε"}));
  EXPECT_EQ(units("\"s\",\"N\",\"m/s²\""), (Names{"s", "N", "m/s²"}));
  EXPECT_EQ(units("s,,-"), (Names{"s", "", "-"}));
  EXPECT_EQ(units("one,two,three"), Names{}) << "words are none";
  EXPECT_EQ(parse("Time,Force,Acc\n0,1,2\n").units, Names{});
  EXPECT_EQ(parse("Time;Force;Acc\ns;N;g\n0,5;1;2\n").units, (Names{"s", "N", "g"}));
  const auto wrong = [&](const std::string& row) { return rejection([&] { static_cast<void>(units(row)); }); };
  EXPECT_EQ(
      wrong("s,N,furlong"),
      "t.csv:2: Acc = \"furlong\"; is no unit known here, in a row of units. Known are N, kN, m/s^2, g, mm, um, V, "
      "mV, s, ms and the like");
  EXPECT_NE(wrong("(s),(foo),(bar)").find("t.csv:2: Force = \"foo\""), std::string::npos) << wrong("(s),(foo),(bar)");
}

TEST(TextTable, FindsColumnsAndReportsTheirFields) {
  std::vector<std::string> warnings;
  const TextTable table = parse_text_table("# tools\nname,length_mm\nmill,12.5\nball,x\nslim\n", "t.csv", warnings);
  EXPECT_EQ(table.column("length_mm"), 1u);
  EXPECT_FALSE(table.column("length"));
  EXPECT_EQ(table.text(table.rows[0], "length_mm"), "12.5");
  EXPECT_EQ(table.text(table.rows[0], "teeth"), "");
  EXPECT_STREQ(table.reject(table.rows[0], "length_mm", "is long").what(), "t.csv:3: length_mm = 12.5 mm; is long");
  EXPECT_STREQ(table.reject(table.rows[1], "length_mm", "is no number").what(),
               "t.csv:4: length_mm = \"x\"; is no number");
  EXPECT_STREQ(table.reject(table.rows[2], "length_mm", "is empty").what(), "t.csv:5: length_mm: is empty");
  EXPECT_NO_THROW(table.require_known({"length_mm", "name", "teeth"}));
  EXPECT_EQ(rejection([&] {
              table.require_known({"name", "length_m"});
            }),
            "t.csv: has a column length_mm that is not known here. Did you mean length_m?");
}

// The shortest digits that determine a double are read back as that double.
TEST(Table, GivesBackEveryBit) {
  Random random(3);
  std::string content = "a b c\n";
  Columns expected(3);
  for (int i = 0; i < 1000; ++i) {
    for (std::size_t column = 0; column < 3; ++column) {
      const double value = random.normal() * std::pow(10.0, random.uniform(-300.0, 300.0));
      expected[column].push_back(value);
      content += fmt::format("{}{}", value, column == 2 ? "\n" : " ");
    }
  }
  EXPECT_EQ(parse(content).columns, expected);
}

TEST(Table, SurvivesMutations) {
  const std::string original = "time,\"force\",a\n0.0,1.5e-020,+3\n1.0;2,5;3\n\"4\",-5D3,6\n";
  for (int seed = 0; seed < test::seeds(20000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = original;
    for (std::uint64_t i = random.index(6); i > 0; --i) {
      const char* const likely = ",;\t \"\n\r#.e-+D0\0";
      content[random.index(content.size())] =
          random.index(2) == 0 ? static_cast<char>(random.index(256)) : likely[random.index(15)];
    }
    content.resize(random.index(content.size()) + 1);
    try {
      const Table table = parse(content);
      for (const auto& column : table.columns) ASSERT_EQ(column.size(), table.columns.front().size());
    } catch (const InvalidInput& error) {
      EXPECT_EQ(std::string(error.what()).find("t.csv"), 0u) << error.what();
    }
  }
}

}  // namespace table_test
}  // namespace robomill::io
