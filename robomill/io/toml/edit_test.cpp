#include "robomill/io/toml/edit.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace toml_edit_test {

constexpr const char* example = R"(# A cut.
force_on = "tool"
[tool]
teeth = 3                   # of the cutter: "flutes"
# helix_deg = 30            # 0 unless given
pitch_deg = [100, 120,
  140.0]
name = "a # b"              # µm are ³ bytes

[lobes]
spindle_speed_rpm = [4000, 16000]   # from, to
grid = [200, 100]
# [finishing]               # a finishing cut
# max_deflection_um = 30    # of the tip
[[hits]]
file = "a.csv"
responses = { x = "ax" }
)";

std::string set(const std::string& key, const std::string& value, const std::string& document = example) {
  return with_setting(document, {.key = key, .value = value});
}

/// The document with one text in place of another.
std::string with(const std::string& from, const std::string& to) {
  std::string text = example;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(TomlEdit, ReplacesAValueAndNothingElse) {
  EXPECT_EQ(set("tool.teeth", "4"), with("teeth = 3 ", "teeth = 4 "));
  EXPECT_EQ(set("tool.pitch_deg", "[120, 240]"), with("[100, 120,\n  140.0]", "[120, 240]"));
  EXPECT_EQ(set("tool.pitch_deg[2]", "141"), with("140.0", "141"));
  EXPECT_EQ(set("tool.name", "\"µ\""), with("\"a # b\"", "\"µ\""));
  EXPECT_EQ(set("lobes.spindle_speed_rpm[1]", "18000"), with("16000", "18000"));
  EXPECT_EQ(set("hits[0].responses.x", "3"), with("x = \"ax\"", "x = 3"));
  EXPECT_EQ(set("force_on", "\"workpiece\""), with("\"tool\"", "\"workpiece\""));
}

TEST(TomlEdit, TakesAKeyOutOfItsComment) {
  EXPECT_EQ(set("tool.helix_deg", "45"), with("# helix_deg = 30 ", "helix_deg = 45 "));
  EXPECT_EQ(set("finishing.max_deflection_um", "20"),
            with("# [finishing]               # a finishing cut\n# max_deflection_um = 30 ",
                 "[finishing]               # a finishing cut\nmax_deflection_um = 20 "));
}

TEST(TomlEdit, AddsWhatIsMissing) {
  EXPECT_EQ(set("tool.diameter_mm", "12"), with("are ³ bytes\n", "are ³ bytes\ndiameter_mm = 12\n"));
  EXPECT_EQ(set("lobes.tolerance", "1e-6"), with("grid = [200, 100]\n", "grid = [200, 100]\ntolerance = 1e-6\n"));
  EXPECT_EQ(set("hits[0].responses.y", "4"), with("{ x = \"ax\" }", "{ x = \"ax\", y = 4 }"));
  EXPECT_EQ(set("hits[1].file", "\"b.csv\""), std::string(example) + "\n[[hits]]\nfile = \"b.csv\"\n");
  EXPECT_EQ(set("cut.direction", "\"up\""), std::string(example) + "\n[cut]\ndirection = \"up\"\n");
  EXPECT_EQ(set("title", "\"t\""), with("force_on = \"tool\"\n", "force_on = \"tool\"\ntitle = \"t\"\n"));
  EXPECT_EQ(set("a.b", "1", "x = 1"), "x = 1\n\n[a]\nb = 1\n");
}

TEST(TomlEdit, RejectsWhatIsNoValueOrNoKey) {
  EXPECT_EQ(test::rejection([] { (void)set("tool.teeth", "three"); }), "tool.teeth: must be set to a value of TOML");
  EXPECT_EQ(test::rejection([] { (void)set("tool.teeth", "3\nx = 4"); }), "tool.teeth: must be set to a value of TOML");
  EXPECT_EQ(test::rejection([] { (void)set("tool", "3"); }), "tool: cannot be set in this document");
  EXPECT_EQ(test::rejection([] { (void)set("tool.pitch_deg[7]", "3"); }),
            "tool.pitch_deg[7]: cannot be set in this document");
  EXPECT_EQ(test::rejection([] { (void)set("tool.teeth.more", "3"); }),
            "tool.teeth.more: cannot be set in this document");
  EXPECT_NE(test::rejection([] { (void)set("a", "3", "[b"); }).find("is no TOML"), std::string::npos);
}

// Whatever a document and a key are, the key holds the value afterwards, or an error says that it cannot.
TEST(TomlEdit, SurvivesMutations) {
  const std::string keys[] = {"tool.teeth", "tool.helix_deg", "lobes.grid[1]", "finishing.max_deflection_um", "a.b.c"};
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string text = example;
    for (std::uint64_t i = random.index(4); i > 0; --i)
      text[random.index(text.size())] = static_cast<char>(random.index(128));
    if (random.index(4) == 0) text.resize(1 + random.index(text.size()));
    const std::string& key = keys[random.index(std::size(keys))];
    try {
      EXPECT_EQ(set(key, "7", set(key, "7", text)), set(key, "7", text));
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
    }
  }
}

TEST(TomlEdit, GivesAValueAsItStandsThere) {
  EXPECT_EQ(setting_of(example, "tool.teeth"), "3");
  EXPECT_EQ(setting_of(example, "tool.pitch_deg"), "[100, 120,\n  140.0]");
  EXPECT_EQ(setting_of(example, "tool.pitch_deg[2]"), "140.0");
  EXPECT_EQ(setting_of(example, "hits[0].responses"), "{ x = \"ax\" }");
  EXPECT_EQ(setting_of(example, "tool.helix_deg"), std::nullopt);
  EXPECT_EQ(setting_of(example, "tool"), std::nullopt);
  EXPECT_EQ(setting_of("a = 1", "a"), "1");
}

TEST(TomlEdit, QuotesAnyText) {
  EXPECT_EQ(toml_quoted("a \"b\" \\ c\n"), "\"a \\\"b\\\" \\\\ c\\u000A\"");
}

}  // namespace toml_edit_test
}  // namespace robomill::io
