// What a verb writes, as a user meets it: no input is replaced, nothing that cannot be written passes in silence.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>

#include "test_program.hpp"
#include "testing/jobs/lobes_file.hpp"

namespace robomill::app {
namespace outputs_test {

namespace fs = std::filesystem;

class Outputs : public ProgramTest {
 protected:
  /// Small inputs of every verb.
  void SetUp() override {
    for (const char* kind : {"lobes", "job", "forces", "assembly", "monitor"}) {
      ASSERT_EQ(robomill(std::string("init ") + kind + " --example").exit, 0) << kind;
    }
    ASSERT_EQ(robomill("init cell --robot ur-10e --example").exit, 0);
    ASSERT_EQ(robomill("frf hits.toml -o tip.csv").exit, 0);
    ASSERT_EQ(robomill("modes tip.csv --band 100,2000 --accept-fit -o modes.json").exit, 0);
    write_lobes_of_modes();
    write("part.csv", "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n0,0,5,0,0,1,600\n10,0,0,0,0,1,600\n20,0,0,0,0,1,600\n");
    write("slots.csv", "feed_per_tooth_mm,fx_n,fy_n,fz_n\n0.05,1,2,1\n0.1,2,3,1\n");
    write("loads.csv", "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n");
    write("recordings.toml", "[signal]\n");
    write("cut.csv", "time_s,ax_m_per_s2\n0,1\n0.001,2\n");
    fs::create_symlink(".", folder_.at("here"));
    fs::create_symlink("example_hit_x.csv", folder_.at("soft.csv"));
    fs::create_hard_link(folder_.at("example_hit_x.csv"), folder_.at("hard.csv"));
  }
  void write_lobes_of_modes() {
    write("of_modes.toml", test_support::lobes_file("spindle_speed_rpm = [6000, 9000]\naxial_depth_mm = [0, 3]\n"
                                                    "grid = [20, 10]\n[dynamics]\nmodes = \"modes.json\"\n"));
  }
};

TEST_F(Outputs, ReplaceNoInput) {
  const struct {
    const char *command, *input;
  } tries[] = {{"frf hits.toml -o example_hit_x.csv", "example_hit_x.csv"},
               {"frf hits.toml -o soft.csv", "example_hit_x.csv"},
               {"frf hits.toml -o hard.csv", "example_hit_x.csv"},
               {"modes tip.csv -o tip.csv", "tip.csv"},
               {"joint assembly.toml --measured tip.csv -o tip.csv", "tip.csv"},
               {"couple assembly.toml --tools part.csv -o part.csv", "part.csv"},
               {"lobes of_modes.toml -o modes.json", "modes.json"},
               {"lobes of_modes.toml -o lobes.csv --report modes.json", "modes.json"},
               {"simulate of_modes.toml --at 6000,1 -o modes.json", "modes.json"},
               {"explain --peaks 100 --rpm 6000 --teeth 3 --modes modes.json -o modes.json", "modes.json"},
               {"forces forces.toml --program part.csv --cell cell.toml -o part.csv", "part.csv"},
               {"coefficients slots.csv -o slots.csv", "slots.csv"},
               {"stiffness loads.csv --cell cell.toml -o loads.csv", "loads.csv"},
               {"stiffness loads.csv --cell cell.toml -o cell.toml", "cell.toml"},
               {"smooth part.csv --cell cell.toml -o part.csv", "part.csv"},
               {"monitor monitor.toml --input cut.csv -o cut.csv", "cut.csv"},
               {"calibrate recordings.toml -o recordings.toml", "recordings.toml"},
               {"couple assembly.toml -o tip2.uff --holder-out assembly.toml", "assembly.toml"},
               {"couple assembly.toml --tools part.csv --frfs . -o tools.csv", "part.csv"},
               {"monitor monitor.toml --input cut.csv --record .", "cut.csv"},
               {"plan job.toml -o .", "job.toml"},
               {"plan job.toml -o here", "job.toml"}};
  for (const auto& one : tries) {
    const std::string before = slurp(folder_.at(one.input));
    ASSERT_FALSE(before.empty()) << one.input;
    const Ended run = robomill(one.command);
    EXPECT_EQ(run.exit, 1) << one.command << ": " << run.out;
    EXPECT_NE(run.err.find("is read by this job and "), std::string::npos) << one.command << ": " << run.err;
    EXPECT_EQ(slurp(folder_.at(one.input)), before) << one.command;
  }
  fs::create_directory(folder_.at("plan"));
  for (const char* name : {"job.toml", "hits.toml", "lobes.toml"}) {
    fs::copy_file(folder_.at(name), folder_.at("plan") / name);
  }
  const Ended run = robomill("plan plan/job.toml -o plan");
  EXPECT_EQ(run.exit, 1);
  EXPECT_NE(run.err.find("stands in the folder that it writes"), std::string::npos) << run.err;
  EXPECT_FALSE(fs::exists(folder_.at("plan/plan.json")));
}

TEST_F(Outputs, DifferFromEachOther) {
  const Ended run = robomill("lobes lobes.toml -o a.json --report a.json");
  EXPECT_EQ(run.exit, 1);
  EXPECT_NE(run.err.find("a.json: is where two outputs would be written"), std::string::npos) << run.err;
}

TEST_F(Outputs, ToADeviceThatTakesNothingEndWithAnError) {
  for (const char* command : {"lobes lobes.toml -o -", "lobes lobes.toml", "--help", "init lobes -o -"}) {
    const Ended run = robomill(std::string(command) + " >/dev/full");
    EXPECT_EQ(run.exit, 1) << command;
    EXPECT_EQ(run.err, "robomill: standard output cannot be written: No space left on device\n") << command;
  }
  EXPECT_EQ(robomill("lobes lobes.toml --quiet >/dev/full").exit, 0) << "nothing was to be written";
}

// What is no file that could appear whole.
TEST_F(Outputs, KeepPipesLinksAndOpenFiles) {
  ASSERT_EQ(::mkfifo(folder_.at("pipe.mat").c_str(), 0600), 0);
  const Ended into_pipe = robomill("frf hits.toml -o pipe.mat");
  EXPECT_EQ(into_pipe.exit, 1);
  EXPECT_NE(into_pipe.err.find("pipe.mat: is a device or a pipe"), std::string::npos) << into_pipe.err;
  EXPECT_TRUE(fs::is_fifo(folder_.at("pipe.mat")));
  // A link to what is to be made stays one.
  fs::create_symlink("made.json", folder_.at("link.json"));
  EXPECT_EQ(robomill("lobes lobes.toml -o link.json").exit, 0);
  EXPECT_TRUE(fs::is_symlink(folder_.at("link.json")));
  EXPECT_TRUE(fs::is_regular_file(folder_.at("made.json")));
  fs::create_symlink("two.json", folder_.at("one.json"));
  EXPECT_NE(robomill("lobes lobes.toml -o one.json --report two.json").err.find("two outputs"), std::string::npos);
  // What a shell has opened is not replaced below it.
  write("all.json", "kept\n");
  const Ended open = robomill("monitor monitor.toml --input cut.csv --quiet -o /dev/stdout >>all.json");
  EXPECT_EQ(open.exit, 1);
  EXPECT_NE(open.err.find("/dev/stdout: is a file that is open already"), std::string::npos) << open.err;
  EXPECT_EQ(slurp(folder_.at("all.json")), "kept\n");
}

// A disk that is full for one verb after another.
TEST_F(Outputs, ToAFullDiskLeaveTheOldFile) {
  const struct {
    std::string command, output;
  } tries[] = {{"frf hits.toml", "old.mat"},
               {"frf hits.toml", "old.uff"},
               {"simulate lobes.toml --at 9000,0.2 --seconds 0.2", "old.wav"},
               {"smooth part.csv --cell cell.toml", "old.h5"},
               {"lobes lobes.toml", "old.json"}};
  for (const auto& one : tries) {
    write(one.output, "old");
    const Ended run = shell("ulimit -f 1; '" ROBOMILL_PROGRAM "' " + one.command + " --quiet -o " + one.output);
    EXPECT_EQ(run.exit, 1) << one.command << ": " << run.err;
    EXPECT_NE(run.err.find(one.output + ": cannot be written"), std::string::npos) << one.command << ": " << run.err;
    EXPECT_EQ(slurp(folder_.at(one.output)), "old") << one.command;
  }
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
  }
}

// A run that was killed while it replaced its documents.
TEST_F(Outputs, OfAPlanThatWasKilledAreReported) {
  ASSERT_EQ(robomill("plan job.toml -o out").exit, 0);
  write("out/.robomill-unfinished", "modes.json\t.modes.1-1.json\n");
  const Ended read = robomill("explain --peaks 100 --rpm 6000 --teeth 3 --modes out/modes.json");
  EXPECT_EQ(read.exit, 1);
  EXPECT_NE(read.err.find("belongs to files that were being replaced"), std::string::npos) << read.err;
  ASSERT_EQ(robomill("plan job.toml -o out").exit, 0);
  EXPECT_EQ(robomill("explain --peaks 100 --rpm 6000 --teeth 3 --modes out/modes.json").exit, 0);
}

}  // namespace outputs_test
}  // namespace robomill::app
