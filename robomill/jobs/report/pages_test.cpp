#include "robomill/jobs/outputs.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/explain.hpp"
#include "robomill/jobs/files/assumed.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/simulate.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::jobs {
namespace pages_test {

using test_support::replaced;

class Pages : public ::testing::Test {
 protected:
  /// The example's lobes.toml with a grid that is quick.
  std::filesystem::path lobes() {
    const std::string text =
        io::read_file(std::filesystem::path(ROBOMILL_SOURCE_DIR) / "examples/first-lobes/lobes.toml");
    return folder_.file("lobes.toml",
                        replaced(replaced(text, "../../data/", ROBOMILL_SOURCE_DIR "/data/"), "[200, 200]", "[3, 6]"));
  }
  test::Folder folder_;
};

// One result, one document: the page has what the verb writes, and what its file leaves open.
TEST_F(Pages, HoldTheDocumentOfTheResult) {
  const LobesJobResult chart = run_lobes({.lobes = lobes()});
  const page::Report page = page_of(chart);
  EXPECT_EQ(page.lobes, lobes_document(chart));
  EXPECT_TRUE(page.sweep.empty() && page.comparison.empty());
  EXPECT_EQ(page.assumed, assumed_of(chart.cut, CutUse::stability));
  EXPECT_FALSE(page.assumed.empty());
  EXPECT_EQ(page.summary, summary(chart));
  EXPECT_NE(page.created.find("UTC, robomill "), std::string::npos) << page.created;

  const LobesJobResult methods = run_lobes({.lobes = lobes(), .compare = true});
  EXPECT_EQ(page_of(methods).comparison, lobes_document(methods));
  EXPECT_TRUE(page_of(methods).lobes.empty());
}

TEST_F(Pages, HoldWhatIsRecordedOfACutInTime) {
  const SimulateJob job = {
      .lobes = lobes(), .point = {6500.0 * units::rpm, 0.6 * units::mm}, .options = {.seconds = 0.1}};
  const page::Report page = page_of(run_simulate(job));
  EXPECT_EQ(nlohmann::json::parse(page.simulation)["axial_depth_mm"], 0.6);
  const nlohmann::json vibration = nlohmann::json::parse(page.vibration);
  EXPECT_FALSE(vibration["displacement_um"]["x"]["low"].empty());
  EXPECT_EQ(vibration["force_n"]["x"]["low"].size(), vibration["force_n"]["x"]["high"].size());
  EXPECT_EQ(page.assumed, assumed_of(read_lobes(lobes()), CutUse::motion));
}

TEST_F(Pages, OfPeaksAssumeNothingWithoutACut) {
  const ExplainJob job = {.peaks = {{325.0}, 6500.0 * units::rpm, 3},
                          .modes = std::filesystem::path(ROBOMILL_SOURCE_DIR) / "data/robot-modes.toml"};
  const page::Report page = page_of(run_explain(job));
  EXPECT_EQ(nlohmann::json::parse(page.explanation)["peaks"][0]["kind"], "tooth passing");
  EXPECT_TRUE(page.assumed.empty());
}

}  // namespace pages_test
}  // namespace robomill::jobs
