#include "robomill/jobs/explain.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::jobs {
namespace explain_test {

using test::rejection;
using test_support::replaced;

const std::filesystem::path modes = ROBOMILL_SOURCE_DIR "/data/robot-modes.toml";
const std::filesystem::path example = ROBOMILL_SOURCE_DIR "/examples/first-lobes/lobes.toml";

ExplainJob job_of(std::vector<double> peaks_hz) {
  return {.peaks = {std::move(peaks_hz), 6500 * units::rpm, 2},
          .modes = modes,
          .point = {6500 * units::rpm, 0.6 * units::mm}};
}

TEST(RunExplain, ReadsPeaksAndJudgesTheCutAsTheStageDoes) {
  ExplainJob job = job_of({324.99, 666.98, 991.98, 1966.95});
  std::vector<std::string> notes;
  const stability::PeakClassification peaks = stability::explain(job.peaks, modal::read_modes(modes, notes));
  const ExplainResult alone = run_explain(job);
  EXPECT_FALSE(alone.cut || alone.mechanism);
  job.lobes = example;
  const ExplainResult judged = run_explain(job);
  for (const ExplainResult* result : {&alone, &judged}) {
    EXPECT_EQ(result->peaks.state, peaks.state);
    ASSERT_EQ(result->peaks.peaks.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(result->peaks.peaks[i].best.kind, peaks.peaks[i].best.kind);
      EXPECT_EQ(result->peaks.peaks[i].best.harmonic, peaks.peaks[i].best.harmonic);
    }
  }
  const stability::ChatterMechanism mechanism = stability::chatter_mechanism(read_milling(example).problem, job.point);
  ASSERT_TRUE(judged.mechanism);
  EXPECT_EQ(judged.mechanism->kind, mechanism.kind);
  EXPECT_EQ(judged.mechanism->spectral_radius, mechanism.spectral_radius);
}

TEST(RunExplain, KnowsTheWorkpieceOfTheCut) {
  const test::Folder folder;
  ExplainJob job = job_of({446.5});
  EXPECT_NE(run_explain(job).peaks.peaks[0].best.mode.of, modal::ModeOwner::workpiece);
  job.lobes =
      folder.file("lobes.toml",
                  replaced(io::read_file(example), "../../data/robot-modes.toml", modes.string()) +
                      "[workpiece_dynamics]\ny = [{ frequency_hz = 446, damping_ratio = 0.005, modal_mass_kg = 2 }]\n");
  const stability::Explanation best = run_explain(job).peaks.peaks[0].best;
  EXPECT_EQ(best.mode.number, 1);
  EXPECT_EQ(best.mode.of, modal::ModeOwner::workpiece);
}

TEST(RunExplain, RejectsWhatIsMissingAndACutWithoutModes) {
  const test::Folder folder;
  ExplainJob job = job_of({300.0});
  const auto rejects = [&] { return rejection([&] { static_cast<void>(run_explain(job)); }); };
  job.lobes = folder.at("missing.toml");
  EXPECT_NE(rejects().find("missing.toml"), std::string::npos);
  folder.file("tip.csv", "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n100,1e-6,-1e-8\n200,2e-6,-3e-8\n");
  job.lobes = folder.file("lobes.toml", replaced(io::read_file(example), "modes = \"../../data/robot-modes.toml\"",
                                                 "frf = \"tip.csv\"\nequal_directions = true"));
  EXPECT_NE(rejects().find("lobes.toml: must name modes"), std::string::npos) << rejects();
  job.lobes = folder.file("drill.toml",
                          replaced(replaced(io::read_file(example), "../../data/robot-modes.toml", modes.string()),
                                   "direction = \"up\"\nradial_depth_mm = 1.8\nfeed_per_tooth_mm = 0.01\n",
                                   "kind = \"drilling\"\nfeed_per_revolution_mm = 0.1\n"));
  EXPECT_NE(rejects().find("drill.toml: must be a milling cut of an upright flat end"), std::string::npos) << rejects();
  job.modes = folder.at("missing.json");
  EXPECT_NE(rejects().find("missing.json"), std::string::npos);
}

}  // namespace explain_test
}  // namespace robomill::jobs
