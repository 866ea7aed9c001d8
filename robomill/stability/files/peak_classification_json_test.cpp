#include "robomill/stability/files/peak_classification_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "robomill/base/units.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::stability {
namespace peak_classification_json_test {

TEST(PeakClassificationJson, HoldsEveryPeakInShopUnits) {
  const modal::ModalModel modes = data::robot_modes();
  const PeakClassification found = explain({{324.99, 666.98, 250.0}, 6500.0 * units::rpm, 3}, modes);
  const ChatterMechanism verdict = {ChatterMechanism::Kind::regenerative, 1.1, 0.9, 563.5, {8}};
  const auto json = nlohmann::json::parse(peak_classification_json(found, &verdict));
  EXPECT_NEAR(json["spindle_speed_rpm"].get<double>(), 6499.8, 1e-6);
  ASSERT_EQ(json["peaks"].size(), 3U);
  EXPECT_EQ(json["peaks"][0]["kind"], "tooth passing");
  EXPECT_TRUE(json["peaks"][0]["mode"].is_null());
  EXPECT_EQ(json["peaks"][1]["kind"], "chatter");
  EXPECT_EQ(json["peaks"][1]["mode"], 1);
  EXPECT_EQ(json["peaks"][1]["mode_frequency_hz"], 17.40);
  EXPECT_EQ(json["peaks"][1]["rotations"], 6);
  EXPECT_EQ(json["peaks"][2]["kind"], "unexplained");
  EXPECT_EQ(json["mode"], 1);
  EXPECT_EQ(json["chatter"]["kind"], "regenerative");
  EXPECT_EQ(json["chatter"]["spectral_radius_without_delay"], 0.9);
  const auto bare =
      nlohmann::json::parse(peak_classification_json(explain({{324.99}, 6500.0 * units::rpm, 3}, modes), nullptr));
  EXPECT_TRUE(bare["mode"].is_null());
  EXPECT_TRUE(bare["chatter_frequency_hz"].is_null());
  EXPECT_TRUE(bare["chatter"].is_null());
  EXPECT_EQ(bare["state"], "no chatter");
}

// Two modes explain 539.5 Hz about as well: no mode is named, and both are listed.
TEST(PeakClassificationJson, NamesNothingThatCannotBeDetermined) {
  const auto json = nlohmann::json::parse(
      peak_classification_json(explain({{539.5}, 6500.0 * units::rpm, 3}, data::robot_modes()), nullptr));
  EXPECT_EQ(json["state"], "ambiguous");
  EXPECT_TRUE(json["mode"].is_null());
  EXPECT_TRUE(json["mode_of"].is_null());
  const auto& peak = json["peaks"][0];
  EXPECT_EQ(peak["state"], "ambiguous");
  EXPECT_EQ(peak["kind"], "chatter");
  EXPECT_TRUE(peak["mode"].is_null());
  EXPECT_EQ(peak["others"][0]["mode"], 7);
  EXPECT_EQ(peak["others"][1]["mode"], 8);
  EXPECT_EQ(peak["others"][1]["mode_of"], "tool");
  EXPECT_LT(peak["others"][0]["likelihood_per_hz"], 3.0 * peak["others"][1]["likelihood_per_hz"].get<double>());
}

TEST(PeaksCsv, HasARowAPeak) {
  const std::string table = peaks_csv(explain({{324.99, 666.98, 539.5}, 6500.0 * units::rpm, 3}, data::robot_modes()));
  const auto starts = [&](const char* row) { return table.find(std::string("\n") + row) != std::string::npos; };
  EXPECT_TRUE(starts("324.99,named,tooth passing,3,false,true,,,,")) << table;
  EXPECT_TRUE(starts("666.98,named,chatter,6,false,true,1,tool,17.4,")) << table;
  EXPECT_TRUE(starts("539.5,ambiguous,chatter,,,,,,,,,,")) << table;
}

}  // namespace peak_classification_json_test
}  // namespace robomill::stability
