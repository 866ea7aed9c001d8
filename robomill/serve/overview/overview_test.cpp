#include "robomill/serve/overview/overview.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "robomill/io/system/confinement.hpp"
#include "robomill/jobs/init.hpp"
#include "robomill/jobs/plan.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace overview_test {

namespace fs = std::filesystem;

constexpr const char* cut_tables = R"([tool]
teeth = 2
diameter_mm = 12
[cut]
direction = "up"
radial_depth_mm = 1.8
[coefficients]
tangential_n_per_mm2 = 712
radial_n_per_mm2 = 287
[lobes]
spindle_speed_rpm = [4000, 16000]
axial_depth_mm = [0, 3]
grid = [20, 10]
)";

/// 900 and 950 Hz, 2 %, 0.1 kg, in x and in y.
constexpr const char* modes = R"({"modes":[
{"frequency_hz":900,"damping_ratio":0.02,"left":{"x":[1,0],"y":[0,0]},"right":{"x":[0,-8.8437e-4],"y":[0,0]}},
{"frequency_hz":950,"damping_ratio":0.02,"left":{"x":[0,0],"y":[1,0]},"right":{"x":[0,0],"y":[0,-8.3782e-4]}}]})";

Overview look(const test::Folder& place, const std::string& job = "job.toml",
              const std::vector<fs::path>& written = {}) {
  PlanReader plans;
  return overview_of(place.at(job), written, plans);
}

const Stage& stage(const Overview& overview, StageName name) {
  return overview.stages.at(static_cast<std::size_t>(name));
}

/// "hits=given frfs=ready …", without stages that are not used.
std::string states(const Overview& overview) {
  std::string out;
  for (const Stage& one : overview.stages) {
    if (one.state == StageState::unused) continue;
    out += (out.empty() ? "" : " ") + std::string(name_in(stage_names, one.name)) + "=" +
           std::string(name_in(stage_states, one.state));
  }
  return out;
}

void set_age(const fs::path& file, std::chrono::seconds age) {
  fs::last_write_time(file, fs::file_time_type::clock::now() - age);
}

void write_init(const fs::path& job, bool example) {
  jobs::write_init(jobs::init_files({.kind = jobs::Template::job, .file = job, .example = example}));
}

/// Everything below a folder is of a time long ago.
void set_old(const test::Folder& place) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(place.path())) {
    if (entry.is_regular_file()) set_age(entry.path(), std::chrono::hours(1));
  }
}

TEST(Overview, OfAnExampleBeforeAndAfterItsPlan) {
  const test::Folder place;
  write_init(place.at("job.toml"), true);
  set_old(place);
  const Overview before = look(place);
  ASSERT_FALSE(before.error) << before.error->what();
  ASSERT_EQ(before.stages.size(), std::size(stage_names));
  EXPECT_EQ(states(before), "hits=guessed frfs=ready modes=ready cut=guessed lobes=ready decision=ready");
  EXPECT_EQ(stage(before, StageName::hits).says, "1 hit");
  EXPECT_GT(stage(before, StageName::cut).guesses, 3u);
  EXPECT_GT(stage(before, StageName::cut).line, 0);
  EXPECT_EQ(before.next, static_cast<std::size_t>(StageName::frfs));

  jobs::write_plan(place.at("out"), jobs::run_job(place.at("job.toml"), jobs::default_seed));
  const Overview after = look(place);
  EXPECT_EQ(after.results, place.at("out"));
  EXPECT_EQ(states(after), "hits=guessed frfs=done modes=done cut=guessed lobes=done decision=guessed");
  EXPECT_EQ(stage(after, StageName::hits).says, "1 of 1 hit good");
  EXPECT_EQ(stage(after, StageName::frfs).says, "xx usable");
  EXPECT_TRUE(stage(after, StageName::modes).says.ends_with("% off")) << stage(after, StageName::modes).says;
  EXPECT_TRUE(stage(after, StageName::lobes).says.find(" mm at ") != std::string::npos)
      << stage(after, StageName::lobes).says;
  EXPECT_TRUE(stage(after, StageName::decision).says.ends_with(" rpm")) << stage(after, StageName::decision).says;
  EXPECT_EQ(after.next, static_cast<std::size_t>(StageName::hits));

  // A record that changed makes all that follows from it outdated.
  set_age(place.at("example_hit_x.csv"), -std::chrono::minutes(1));
  const Overview later = look(place);
  EXPECT_EQ(states(later), "hits=outdated frfs=outdated modes=outdated cut=guessed lobes=outdated decision=outdated");
  EXPECT_EQ(stage(later, StageName::lobes).newer->file.filename(), "example_hit_x.csv");
  EXPECT_EQ(stage(later, StageName::lobes).next, StageStep::run);
  EXPECT_EQ(stage(later, StageName::lobes).says, stage(after, StageName::lobes).says);
}

TEST(Overview, OfABlankJobNamesWhatIsMissing) {
  const test::Folder place;
  write_init(place.at("job.toml"), false);
  const Overview found = look(place);
  ASSERT_FALSE(found.error) << found.error->what();
  const Stage& hits = stage(found, StageName::hits);
  const Stage& cut = stage(found, StageName::cut);
  EXPECT_EQ(hits.state, StageState::missing);
  EXPECT_EQ(cut.state, StageState::missing);
  EXPECT_EQ(cut.next, StageStep::edit);
  const io::Json json = overview_object(found, place.path());
  const io::Json& step = json["stages"][static_cast<std::size_t>(StageName::cut)]["next"];
  EXPECT_EQ(step["file"], "job.toml");
  EXPECT_GT(step["line"], 0);
  EXPECT_TRUE(cut.error->parts().rule.starts_with("is missing")) << cut.error->what();
  EXPECT_EQ(stage(found, StageName::lobes).state, StageState::waiting);
  EXPECT_EQ(stage(found, StageName::lobes).says, "needs hits, cut");
  EXPECT_EQ(found.next, static_cast<std::size_t>(StageName::hits));
}

class OverviewOfModes : public ::testing::Test {
 protected:
  OverviewOfModes() {
    place_.file("modes.json", modes);
    place_.file("job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\n");
    place_.file("lobes.toml", cut_tables);
  }
  test::Folder place_;
};

TEST_F(OverviewOfModes, NeedsNoHits) {
  const Overview found = look(place_);
  EXPECT_EQ(states(found), "modes=given cut=given lobes=ready decision=ready");
  EXPECT_EQ(stage(found, StageName::modes).says, "2 modes");
  EXPECT_EQ(stage(found, StageName::cut).says, "2 teeth, 12 mm, radial depth 1.8 mm");
  EXPECT_EQ(stage(found, StageName::cut).file, place_.at("lobes.toml"));
}

TEST_F(OverviewOfModes, ABrokenDocumentIsTheStateOfItsStage) {
  const struct {
    const char *name, *content;
    StageName stage;
    StageState state;
  } cases[] = {
      {"lobes.toml", "[tool\n", StageName::cut, StageState::wrong},
      {"lobes.toml", "[tool]\nteeth = 0\n[lobes]\n", StageName::cut, StageState::wrong},
      {"modes.json", "{", StageName::modes, StageState::wrong},
      {"job.toml", "[job]\n", StageName::hits, StageState::missing},
      {"job.toml", "[job]\nlobes = \"lobes.toml\"\n", StageName::hits, StageState::missing},
      {"job.toml", "[job]\nmodes = \"none.json\"\nlobes = \"lobes.toml\"\n", StageName::modes, StageState::missing},
      {"job.toml", "[job]\nmodes = \"modes.json\"\n", StageName::cut, StageState::missing},
      {"job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"none.toml\"\n", StageName::cut, StageState::missing},
      {"job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\nprogram = \"part.ngc\"\n",
       StageName::program, StageState::missing},
      {"job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\n[safety]\ndepth_margin = 2\n",
       StageName::decision, StageState::wrong}};
  for (const auto& one : cases) {
    const std::string before = [&] {
      std::ifstream in(place_.at(one.name));
      return std::string(std::istreambuf_iterator<char>(in), {});
    }();
    place_.file(one.name, one.content);
    const Overview found = look(place_);
    EXPECT_FALSE(found.error) << one.content << ": " << found.error->what();
    EXPECT_EQ(stage(found, one.stage).state, one.state) << one.content << ": " << states(found);
    EXPECT_TRUE(stage(found, one.stage).error) << one.content;
    EXPECT_EQ(found.next, static_cast<std::size_t>(one.stage)) << one.content << ": " << states(found);
    place_.file(one.name, before);
  }
}

TEST_F(OverviewOfModes, SaysNothingOfFilesOutsideTheFolder) {
  fs::create_directories(place_.at("served"));
  place_.file("served/lobes.toml", cut_tables);
  place_.file("served/job.toml", "[job]\nmodes = \"../modes.json\"\nlobes = \"lobes.toml\"\n");
  const io::Confinement confinement(place_.at("served"));
  const Overview there = look(place_, "served/job.toml");
  fs::remove(place_.at("modes.json"));
  const Overview gone = look(place_, "served/job.toml");
  EXPECT_EQ(stage(there, StageName::modes).state, StageState::wrong);
  EXPECT_EQ(overview_object(there, place_.at("served")), overview_object(gone, place_.at("served")));
}

TEST_F(OverviewOfModes, AJobThatCannotBeReadSaysSo) {
  place_.file("job.toml", "[job\n");
  const Overview found = look(place_);
  ASSERT_TRUE(found.error);
  EXPECT_EQ(found.stages.size(), std::size(stage_names));
  EXPECT_EQ(stage(found, StageName::decision).state, StageState::waiting);
  EXPECT_EQ(overview_object(found, place_.path())["error"]["line"], 1);
  place_.file("job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"lobes.toml\"\nmode = 3\n");
  const Overview unknown = look(place_);
  ASSERT_TRUE(unknown.error);
  EXPECT_EQ(stage(unknown, StageName::lobes).state, StageState::waiting);
}

TEST_F(OverviewOfModes, ResultsOfADamagedPlanAreAState) {
  fs::create_directories(place_.at("out"));
  place_.file("out/plan.json", "{\"lobes\": [");
  const Overview damaged = look(place_);
  EXPECT_EQ(stage(damaged, StageName::decision).state, StageState::wrong);
  EXPECT_EQ(stage(damaged, StageName::decision).next, StageStep::run);
  EXPECT_EQ(stage(damaged, StageName::lobes).state, StageState::ready);
  // Members of any other type are no results.
  place_.file(
      "out/plan.json",
      R"({"frf": 3, "modes": {"modes": 2}, "lobes": {"limit": [1, {"axial_depth_mm": "x"}]}, "recommended": [], "decision": "no", "blocks": null})");
  const Overview odd = look(place_);
  EXPECT_EQ(stage(odd, StageName::lobes).says, "no limit in the chart");
  EXPECT_EQ(stage(odd, StageName::decision).state, StageState::ready);
}

TEST_F(OverviewOfModes, APlanWithoutAnAnswerSaysWhy) {
  fs::create_directories(place_.at("out"));
  place_.file(
      "out/plan.json",
      R"({"recommended": null, "reason": "no safe depth", "lobes": {"limit": [{"spindle_speed_rpm": 9000, "axial_depth_mm": 1.134}, {"spindle_speed_rpm": 5000, "axial_depth_mm": null}]}})");
  const Overview found = look(place_);
  EXPECT_EQ(stage(found, StageName::lobes).says, "lowest limit 1.13 mm at 9000 rpm");
  EXPECT_EQ(stage(found, StageName::decision).state, StageState::unreached);
  EXPECT_EQ(stage(found, StageName::decision).says, "no safe depth");
}

TEST_F(OverviewOfModes, HasTheNumbersOfAProgram) {
  fs::create_directories(place_.at("out"));
  place_.file("part.ngc", "G0\n");
  place_.file(
      "cell.toml",
      "[robot]\nmodel = \"kuka-kr210-r2700\"\n[workpiece]\norigin_mm = [1500, 0, 800]\n[tool]\nlength_mm = 100\n");
  place_.file("forces.toml", cut_tables);
  place_.file(
      "job.toml",
      "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n[decide]\nfree = [\"feed\"]\n");
  set_old(place_);
  place_.file(
      "out/plan.json",
      R"({"recommended": null, "reason": "", "blocks": {"cutting": 325, "unstable": 2}, "path": {"duration_s": 29.18, "violations": 0},
 "decision": {"status": "found", "decided": {"total_time_s": 29.2, "least_stability_margin": 0.21}, "as_programmed": {"total_time_s": 41}}})");
  const Overview found = look(place_);
  EXPECT_EQ(stage(found, StageName::robot).says, "kuka-kr210-r2700");
  EXPECT_EQ(stage(found, StageName::program).says, "2 of 325 blocks chatter; path of 29.2 s");
  EXPECT_EQ(stage(found, StageName::program).next, StageStep::program);
  EXPECT_EQ(stage(found, StageName::decision).says, "29.2 s, as programmed 41 s; least margin 21 %");
  EXPECT_EQ(stage(found, StageName::modes).state, StageState::unused);
}

TEST_F(OverviewOfModes, TakesTheMonitorOfTheJobOrOfItsPlan) {
  constexpr const char* monitor =
      "[signal]\nsample_rate_hz = 10240\nchannels = [\"ax_m_per_s2\"]\n[process]\nteeth = 2\n[detector]\nkind = "
      "\"comb-cusum\"\n";
  fs::create_directories(place_.at("out"));
  place_.file("out/plan.json", R"({"recommended": null})");
  place_.file("out/monitor.toml", monitor);
  EXPECT_EQ(stage(look(place_), StageName::monitor).file, place_.at("out/monitor.toml"));
  place_.file("monitor.toml", monitor);
  const Overview beside = look(place_);
  EXPECT_EQ(stage(beside, StageName::monitor).file, place_.at("monitor.toml"));
  EXPECT_EQ(stage(beside, StageName::monitor).state, StageState::given);
  EXPECT_EQ(stage(beside, StageName::monitor).says, "1 channel");
}

TEST(FindPlan, TakesTheNewestThatIsTheJobs) {
  const test::Folder place;
  const auto plan = [&](const std::string& folder, std::chrono::seconds age) {
    fs::create_directories(place.at(folder));
    set_age(place.file(folder + "/plan.json", "{}"), age);
  };
  place.file("steel.toml", "[job]\n");
  EXPECT_EQ(find_plan(place.at("steel.toml"), {}), fs::path());
  plan("anything", std::chrono::hours(2));
  EXPECT_EQ(find_plan(place.at("steel.toml"), {}), place.at("anything"));
  // Among several jobs by the name.
  place.file("steel-2.toml", "[job]\n");
  EXPECT_EQ(find_plan(place.at("steel.toml"), {}), fs::path());
  plan("steel-out", std::chrono::hours(2));
  plan("steel-2-out", std::chrono::hours(1));
  EXPECT_EQ(find_plan(place.at("steel.toml"), {}), place.at("steel-out"));
  EXPECT_EQ(find_plan(place.at("steel-2.toml"), {}), place.at("steel-2-out"));
  // A run of this server knows where it wrote.
  plan("a/b", std::chrono::minutes(1));
  EXPECT_EQ(find_plan(place.at("steel.toml"), {place.at("a/b"), place.at("gone")}), place.at("a/b"));
}

TEST(PlanReader, ReadsAnewWhatChanged) {
  const test::Folder place;
  PlanReader plans;
  set_age(place.file("plan.json", R"({"modes": {"modes": [1]}})"), std::chrono::hours(1));
  EXPECT_EQ(plans.read(place.path()).modes, "1 mode");
  place.file("plan.json", R"({"modes": {"modes": [1, 2], "fit": {"relative_error": 0.021, "usable": false}}})");
  EXPECT_EQ(plans.read(place.path()).modes, "2 modes, 2.1 % off");
  EXPECT_FALSE(plans.read(place.path()).modes_usable);
}

}  // namespace overview_test
}  // namespace robomill::serve
