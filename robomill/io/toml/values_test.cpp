#include "robomill/io/toml/values.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "testing/support.hpp"

namespace robomill::io {
namespace toml_values_test {

using test::rejection;

constexpr const char* text = R"(# The cutter of the job.
name = "ä # b"   # not a comment inside

[tool]
# how many
# edges
teeth = 3
pitch_deg = [100, 120, 140]  # a list
kind = 'ball-end'

[[hits]]
file = "x_1.csv"
responses = { x = "ax", y = "ay" }

[[hits]]
file = "x_2.csv" # the second
)";

const TomlValue& of(const std::vector<TomlValue>& values, const std::string& key) {
  for (const TomlValue& value : values) {
    if (value.key == key) return value;
  }
  ADD_FAILURE() << key << " is not there";
  return values.front();
}

TEST(TomlValues, ListsValuesWithLineAndComment) {
  const std::vector<TomlValue> values = toml_values(text, "a.toml");
  EXPECT_EQ(values.size(), 8u);
  EXPECT_EQ(of(values, "name").value, "ä # b");
  EXPECT_EQ(of(values, "name").comment, "not a comment inside");
  EXPECT_EQ(of(values, "tool.teeth").value, 3);
  EXPECT_EQ(of(values, "tool.teeth").line, 7);
  EXPECT_EQ(of(values, "tool.teeth").comment, "how many edges");
  EXPECT_EQ(of(values, "tool.pitch_deg").value, Json({100, 120, 140}));
  EXPECT_EQ(of(values, "tool.pitch_deg").comment, "a list");
  EXPECT_EQ(of(values, "hits[0].responses.y").value, "ay");
  EXPECT_EQ(of(values, "hits[1].file").line, 16);
  EXPECT_EQ(of(values, "hits[1].file").comment, "the second");
}

TEST(TomlValues, OfManyLinesAndLongOnes) {
  std::string many =
      "\xEF\xBB\xBF"
      "first = 1 # ä\n";
  for (int i = 0; i < 200'000; ++i) many += "\n";
  many += "# above\nlast = 'ä' # behind\n";
  std::vector<TomlValue> values = toml_values(many, "a.toml");
  EXPECT_EQ(of(values, "first").comment, "ä");
  EXPECT_EQ(of(values, "last").line, 200'003);
  EXPECT_EQ(of(values, "last").comment, "behind");
  std::string line = "# above\nt = { a0 = 0";
  for (int i = 1; i < 50'000; ++i) line += ", a" + std::to_string(i) + " = 0";
  values = toml_values(line + " }\n", "a.toml", 5000);
  EXPECT_EQ(values.size(), 5000U);
  EXPECT_EQ(of(values, "t.a0").comment, "above");
}

TEST(TomlValues, NamesTheLineOfAnError) {
  EXPECT_EQ(rejection([] { (void)toml_values("a = 1\nb = ", "a.toml"); }).substr(0, 8), "a.toml:2");
}

}  // namespace toml_values_test
}  // namespace robomill::io
