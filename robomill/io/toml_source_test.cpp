#include "robomill/io/toml_source.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/toml/file.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace toml_source_test {

using test::Folder;
using test::rejection;

constexpr const char* example = R"([tool]
teeth = 3
pitch_deg = [100, 120, 140]
[[hits]]
file = "a.csv"
[[hits]]
file = "b.csv"
)";

/// The same document with these keys set.
TomlSource with(std::vector<TomlSetting> settings) {
  return {"folder/lobes.toml", example, std::move(settings)};
}

int teeth_of(const TomlSource& source) {
  TomlFile file(source);
  int teeth = 0;
  file.integer("tool.teeth", "teeth", teeth);
  return teeth;
}

TEST(TomlSource, ReadsATextInPlaceOfTheFile) {
  const Folder folder;
  const auto path = folder.file("lobes.toml", "[tool]\nteeth = 5\n");
  EXPECT_EQ(teeth_of(path), 5);
  EXPECT_EQ(teeth_of(path.string()), 5);
  EXPECT_EQ(teeth_of({path, "[tool]\nteeth = 4\n"}), 4);
  // Errors and paths are those of the file, which need not exist.
  TomlFile file(with({}));
  std::filesystem::path hit;
  EXPECT_TRUE(file.path("hits[1].file", hit));
  EXPECT_EQ(hit, std::filesystem::path("folder") / "b.csv");
  EXPECT_STREQ(file.reject("tool.teeth", "must be even").what(), "folder/lobes.toml:2: tool.teeth = 3; must be even");
  EXPECT_NE(rejection([] { TomlFile broken(TomlSource("x.toml", "a = 1\nb =\n")); }).find("x.toml:2: is no TOML"),
            std::string::npos);
}

TEST(TomlSource, SetsKeysBeforeTheyAreRead) {
  TomlFile file(with({{"tool.teeth", "4"},
                      {"tool.pitch_deg[1]", "110.5"},
                      {"hits[1].file", "\"c.csv\""},
                      {"cut.direction", "\"up\""},
                      {"cut.axial_depth_mm", "[0.5, 2]"},
                      {"tool.teeth", "6"}}));
  int teeth = 0;
  std::vector<double> pitch_deg, depth_m;
  std::string hit, first, direction;
  file.integer("tool.teeth", "teeth", teeth);
  file.numbers("tool.pitch_deg", "pitch_rad", 1.0, pitch_deg);
  file.numbers("cut.axial_depth_mm", "axial_depth_m", units::mm, depth_m);
  file.text("hits[0].file", first);
  file.text("hits[1].file", hit);
  file.text("cut.direction", direction);
  static_cast<void>(file.done());
  EXPECT_EQ(teeth, 6);  // the last one counts
  EXPECT_EQ(pitch_deg, (std::vector<double>{100.0, 110.5, 140.0}));
  EXPECT_EQ(depth_m, (std::vector<double>{0.5 * units::mm, 2.0 * units::mm}));
  EXPECT_EQ(first, "a.csv");
  EXPECT_EQ(hit, "c.csv");
  EXPECT_EQ(direction, "up");
}

TEST(TomlSource, ErrorsOfASetKeyNameTheKeyWithoutALine) {
  TomlFile file(with({{"tool.teeth", "0"}, {"tool.flute", "2"}}));
  int teeth = 1;
  file.integer("tool.teeth", "teeth", teeth);
  std::vector<double> pitch;
  file.numbers("tool.pitch_deg", "pitch_rad", 1.0, pitch);
  file.skip("hits");
  EXPECT_STREQ(file.located(InvalidInput("teeth", 0, "", "must be >= 1")).what(),
               "folder/lobes.toml: tool.teeth = 0; must be >= 1");
  const std::string said = rejection([&] { static_cast<void>(file.done()); });
  EXPECT_TRUE(said.starts_with("folder/lobes.toml: tool.flute is not known here") ||
              said.starts_with("folder/lobes.toml: tool.flute: is not known here"))
      << said;
}

TEST(TomlSource, RejectsWhatCannotBeSet) {
  const auto said = [](const std::string& key, const std::string& value) {
    return rejection([&] { TomlFile file(with({{key, value}})); });
  };
  for (const char* key : {"", ".", "tool.", ".teeth", "tool..teeth", "tool.teeth.x", "tool[0]", "hits.file",
                          "hits[2].file", "hits[x].file", "hits[0]file.", "new[0].file", "tool.pitch_deg[3]"}) {
    EXPECT_NE(said(key, "1").find("is no key of this document that can be set"), std::string::npos) << key;
  }
  for (const char* value : {"", "up", "1\n[cut]", "1\ntwo = 2", "[1", "{\"a\": 1}", "null"}) {
    EXPECT_NE(said("tool.teeth", value).find("is no value of TOML"), std::string::npos) << value;
  }
  std::string deep = "a";
  for (int i = 0; i < 100000; ++i) deep += ".a";
  EXPECT_NE(said(deep, "1").find("more than 32 parts"), std::string::npos);
  EXPECT_NE(said("tool.teeth", "{" + deep + " = 1}").find("more than 32 parts"), std::string::npos);
}

}  // namespace toml_source_test
}  // namespace robomill::io
