#include "robomill/io/toml/synonyms.hpp"

#include <gtest/gtest.h>

#include "robomill/io/toml/file.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace toml_synonyms_test {

const std::set<std::string, std::less<>> of_lobes = {
    "tool.teeth",    "cut.radial_depth_mm",  "cut.axial_depth_mm",     "cut.feed_per_tooth_mm",
    "cut.direction", "lobes.axial_depth_mm", "lobes.spindle_speed_rpm"};

TEST(TomlSynonyms, NameTheKeyThatIsMeant) {
  EXPECT_EQ(synonym_hint("tool.flutes", of_lobes), "Here it is teeth");
  EXPECT_EQ(synonym_hint("cut.flutes", of_lobes), "Here it is tool.teeth");
  EXPECT_EQ(synonym_hint("cut.ae", of_lobes), "Here it is radial_depth_mm");
  EXPECT_EQ(synonym_hint("cut.AE_mm", of_lobes), "Here it is radial_depth_mm");
  EXPECT_EQ(synonym_hint("cut.ap_mm", of_lobes), "Here it is axial_depth_mm");
  EXPECT_EQ(synonym_hint("lobes.ap", of_lobes), "Here it is axial_depth_mm");
  EXPECT_EQ(synonym_hint("cut.fz", of_lobes), "Here it is feed_per_tooth_mm");
  EXPECT_EQ(synonym_hint("cut.climb", of_lobes), "Here it is direction = \"down\"");
  const std::string speed = synonym_hint("cut.vc_m_per_min", of_lobes);
  EXPECT_EQ(speed.rfind("Here it is lobes.spindle_speed_rpm = 1000 vc / (pi diameter_mm)", 0), 0U) << speed;
  EXPECT_EQ(synonym_hint("decide.vc", {"decide.cutting_speed_m_per_min"}), "Here it is cutting_speed_m_per_min");
  const std::string power = synonym_hint("spindle.max_power_kw", {"spindle.curve", "spindle.max_speed_rpm"});
  EXPECT_EQ(power.rfind("Here it is curve = [{ speed_rpm", 0), 0U) << power;
}

TEST(TomlSynonyms, SayNothingWhereTheFileHasNoSuchKey) {
  EXPECT_EQ(synonym_hint("signal.flutes", {"signal.scale"}), "");
  EXPECT_EQ(synonym_hint("tool.apex", of_lobes), "");
  EXPECT_EQ(synonym_hint("tool.zebra", of_lobes), "");
  EXPECT_EQ(synonym_hint("flutes", {"cuts[0].teeth"}), "");
}

// A key that is missing because it was written under another name is reported under that one.
TEST(TomlSynonyms, AreReportedInPlaceOfTheMissingKey) {
  const test::Folder folder;
  const std::filesystem::path path = folder.file("lobes.toml", "[tool]\ndiameter_mm = 12\nflutes = 3\n");
  TomlFile file(path);
  int teeth = 0;
  file.integer("tool.teeth", "teeth", teeth);
  const std::string said = path.string() + ":3: tool.flutes: is not known here. Here it is teeth";
  EXPECT_EQ(test::rejection([&] { file.require("tool.teeth"); }), said);
  EXPECT_EQ(test::rejection([&] { file.locate([] { throw InvalidInput("teeth", 0.0, "", "must be >= 1"); }); }), said);
  double diameter_m = 0.0;
  file.number("tool.diameter_mm", "diameter_m", 1e-3, diameter_m);
  EXPECT_EQ(test::rejection([&] { static_cast<void>(file.done()); }), said);
}

}  // namespace toml_synonyms_test
}  // namespace robomill::io
