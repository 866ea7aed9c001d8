// An output that is an input of its own run, by its name, a symbolic link or a hard link: rejected, and nothing
// changes.
#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>
#include <stdexcept>
#include <string>

#include "testing/faults/cases.hpp"
#include "testing/faults/run.hpp"
#include "testing/support.hpp"

namespace robomill::faults {
namespace inputs_test {

namespace fs = std::filesystem;

struct OverInput {
  const char* name;       ///< of the test
  const char* arguments;  ///< with OUT for the output
  const char* input;      ///< that it is
};
std::ostream& operator<<(std::ostream& out, const OverInput& which) {
  return out << which.arguments << " over " << which.input;
}

constexpr OverInput all[] = {
    {"FrfOverAHit", "frf hits.toml -o OUT", "example_hit_x.csv"},
    {"ModesOverItsFrfs", "modes tip.csv -o OUT", "tip.csv"},
    {"ModesOverItsFrfsByTheReport", "modes tip.json --report OUT", "tip.json"},
    {"CoupleOverItsHolder", "couple held.toml -o OUT", "holder.uff"},
    {"CoupleKeepsItsHolderOverItself", "couple held.toml -o tip.uff --holder-out OUT", "holder.uff"},
    {"CoupleOverItsTools", "couple assembly.toml --tools tools.csv -o OUT", "tools.csv"},
    {"JointOverItsMeasurement", "joint assembly.toml --measured tip.csv -o OUT", "tip.csv"},
    {"LobesOverItsModes", "lobes moded.toml -o OUT", "modes.json"},
    {"LobesOverItsModesByTheReport", "lobes moded.toml --report OUT", "modes.json"},
    {"SimulateOverItsModes", "simulate moded.toml --at 7000,0.5 --seconds 0.1 -o OUT", "modes.json"},
    {"ExplainOverItsModes", "explain --peaks 325 --rpm 6500 --teeth 3 --modes modes.json -o OUT", "modes.json"},
    {"ForcesOverItsProgram", "forces slot.toml --program path.csv --cell cell.toml -o OUT", "path.csv"},
    {"CoefficientsOverItsSlots", "coefficients slots.csv -o OUT", "slots.csv"},
    {"StiffnessOverItsLoads", "stiffness loads.csv --cell planar.toml -o OUT", "loads.csv"},
    {"StiffnessOverItsCell", "stiffness loads.csv --cell planar.toml -o OUT", "planar.toml"},
    {"SmoothOverItsProgram", "smooth path.csv --cell cell.toml -o OUT", "path.csv"},
    {"MonitorOverItsRecording", "monitor monitor.toml --input cut.csv -o OUT", "cut.csv"},
    {"MonitorOverItsSettings", "monitor monitor.toml --input cut.csv -o OUT", "monitor.toml"},
    {"CalibrateOverItsRecordings", "calibrate recordings.toml -o OUT", "recordings.toml"},
    {"PlanOverItsModesByTheReport", "plan job.toml --report OUT", "modes.json"},
};

Files inputs() {
  Files files;
  for (const char* verb : {"frf", "modes", "couple --tools", "lobes", "forces --program", "coefficients", "monitor",
                           "calibrate", "plan", "stiffness", "smooth"}) {
    Files of_verb = inputs_of({.verb = verb});
    if (const auto planar = of_verb.find("cell.toml"); planar != of_verb.end() && of_verb.contains("loads.csv")) {
      files["planar.toml"] = planar->second;
      of_verb.erase(planar);
    }
    for (auto& [name, content] : of_verb) files[name] = content;
  }
  files["path.csv"] = "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n-8,0,5,0,0,1,0\n-8,0,-1,0,0,1,600\n8,0,-1,0,0,1,600\n";
  files["slot.toml"] += "[cut]\nspindle_speed_rpm = 9000\n";  // which path.csv has not
  std::string moded = files["lobes.toml"];
  const std::size_t begin = moded.find("x = ["), end = moded.find("[lobes]");
  files["moded.toml"] = moded.replace(begin, end - begin, "modes = \"modes.json\"\nequal_directions = true\n");
  files["held.toml"] = files["assembly.toml"];
  files["held.toml"].replace(files["held.toml"].find("[holder]"), std::string::npos,
                             "[holder]\nreceptances = \"holder.uff\"\n");
  files["held.toml"].erase(0, files["held.toml"].find("[[tool]]"));  // the holder gives the frequencies
  files["bare.toml"] = files["assembly.toml"].substr(0, files["assembly.toml"].find("[joint]"));
  files["job.toml"].replace(files["job.toml"].find("modes.toml\""), 11, "modes.json\"\nequal_directions = true");
  return files;
}

class Inputs : public testing::TestWithParam<OverInput> {
 protected:
  Inputs() : place_({.robomill = ROBOMILL_PROGRAM, .shim = ROBOMILL_FAULT_SHIM}, folder_.path()) {
    restore(place_.folder(), inputs());
    for (const char* make :
         {"init hits --example --quiet", "frf hits.toml -o hit.json --quiet", "modes tip.csv -o modes.json --quiet",
          "couple bare.toml --rotations -o holder.uff --quiet"}) {
      const Outcome made = place_.run(make, {}, false);
      EXPECT_EQ(made.exit, 0) << make << ": " << made.err;
    }
    fs::copy_file(place_.folder() / "hit.json", place_.folder() / "tip.json");
    before_ = files_of(place_.folder());
  }
  [[nodiscard]] Outcome run_to(const std::string& output) {
    std::string arguments = GetParam().arguments;
    arguments.replace(arguments.find("OUT"), 3, output);
    return place_.run(arguments, {}, false);
  }
  void expect_rejected(const std::string& output) {
    const Outcome outcome = run_to(output);
    EXPECT_EQ(outcome.exit, 1) << output;
    EXPECT_TRUE(outcome.err.starts_with("robomill: ") && outcome.err.find('\n') == outcome.err.size() - 1)
        << output << ": " << outcome.err;
    expect_unchanged(output);
  }
  void expect_unchanged(const std::string& output) {
    const Files now = files_of(place_.folder());
    for (const auto& [name, content] : before_) {
      const auto there = now.find(name);
      ASSERT_NE(there, now.end()) << output << ": " << name << " is gone";
      EXPECT_TRUE(there->second == content) << output << ": " << name << " is not what it was";
    }
    restore(place_.folder(), before_);
  }

  test::Folder folder_;
  Place place_;
  Files before_;
};

TEST_P(Inputs, AreNotWrittenOver) {
  const fs::path input = GetParam().input;
  const Outcome elsewhere = run_to("other" + input.extension().string());
  ASSERT_EQ(elsewhere.exit, 0) << elsewhere.err;
  restore(place_.folder(), before_);
  expect_rejected(input);
  expect_rejected("./" + input.string());
  expect_rejected(fs::canonical(place_.folder() / input));
  const std::string link = "link" + input.extension().string();
  fs::create_symlink(input, place_.folder() / link);
  expect_rejected(link);
  fs::remove(place_.folder() / link);
  // Another name of the same file may be given a file of its own.
  fs::create_hard_link(place_.folder() / input, place_.folder() / link);
  (void)run_to(link);
  expect_unchanged(link);
}

INSTANTIATE_TEST_SUITE_P(Each, Inputs, testing::ValuesIn(all),
                         [](const auto& which) { return std::string(which.param.name); });

// Files that a folder of results replaces.
TEST(InputFolders, AreNotWrittenOver) {
  const test::Folder folder;
  Place place({.robomill = ROBOMILL_PROGRAM, .shim = ROBOMILL_FAULT_SHIM}, folder.path());
  Files files;
  for (const auto& [name, content] : inputs()) {
    if (name == "job.toml" || name == "lobes.toml" || name == "tip.csv") files["plan/" + name] = content;
  }
  restore(place.folder(), files);
  ASSERT_EQ(place.run("modes plan/tip.csv -o plan/modes.json --quiet", {}, false).exit, 0);
  files = files_of(place.folder());
  const Outcome elsewhere = place.run("plan plan/job.toml -o other", {}, false);
  ASSERT_EQ(elsewhere.exit, 0) << elsewhere.err;
  restore(place.folder(), files);
  const Outcome outcome = place.run("plan plan/job.toml -o plan", {}, false);
  EXPECT_EQ(outcome.exit, 1) << outcome.out;
  EXPECT_TRUE(outcome.err.starts_with("robomill: ")) << outcome.err;
  EXPECT_TRUE(files_of(place.folder()) == files);
}

}  // namespace inputs_test
}  // namespace robomill::faults
