#include "robomill/jobs/sweep/slurm.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "robomill/io/file.hpp"
#include "robomill/io/system/program.hpp"
#include "robomill/jobs/files/slurm_jobs.hpp"
#include "robomill/jobs/sweep.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace slurm_test {

using test::Folder;
using test::rejection;

constexpr const char* awkward = "a 'b' \"c\" $HOME `d` \\ * # %a;";

TEST(SlurmScripts, QuoteWordsForAShell) {
  for (const std::string text : {awkward, "", "'", "plain"}) {
    EXPECT_EQ(io::run_program({"sh", "-c", "printf %s " + shell_word(text)}).said, text);
  }
}

TEST(SlurmScripts, AskForWhatTheStudySays) {
  const SlurmScripts scripts = slurm_scripts(
      {.shards = 16, .time_s = 7200, .memory_mb = 2000, .cpus = 4, .partition = "short", .account = "mill"},
      {.program = "robomill", .study = "/data/study.toml", .folder = "/data/our \"study\" %"}, 12);
  for (const char* line :
       {"#SBATCH --array=1-12\n", "#SBATCH --cpus-per-task=4\n", "#SBATCH --requeue\n", "#SBATCH --time=120\n",
        "#SBATCH --mem=2000M\n", "#SBATCH --partition=short\n", "#SBATCH --account=mill\n",
        "#SBATCH --output=\"/data/our \\\"study\\\" %%/slurm/%a.out\"\n", "\nshards=12\n"}) {
    EXPECT_NE(scripts.array.find(line), std::string::npos) << line << scripts.array;
  }
  EXPECT_EQ(scripts.merge.find("--array"), std::string::npos);
  EXPECT_EQ(slurm_scripts({.shards = 1}, {.folder = "/data"}, 1).array.find("--time"), std::string::npos)
      << "the cluster's own";
  EXPECT_NE(
      rejection([] { static_cast<void>(slurm_scripts({.shards = 1}, {.folder = "/data/a\\b"}, 1)); }).find("backslash"),
      std::string::npos);
}

TEST(SlurmScripts, TakeNoWordThatIsAnotherOption) {
  EXPECT_NE(rejection([] { SlurmSettings{.shards = 1, .partition = "a --wrap=b"}.validate(); }).find("letters, digits"),
            std::string::npos);
  EXPECT_NE(rejection([] { SlurmSettings{.shards = 1, .time_s = 60}.validate(); }).find("must be >= 300 s"),
            std::string::npos);
}

TEST(SlurmStatesOf, AreReadFromWhatItsProgramsPrint) {
  const SlurmStates queued =
      states_of_squeue("1|RUNNING\n2|PENDING\n12|OUT_OF_MEMORY\nN/A|PENDING\nslurm_load_jobs error\n");
  EXPECT_EQ(queued, (SlurmStates{{1, "RUNNING"}, {2, "PENDING"}, {12, "OUT_OF_MEMORY"}}));
  const SlurmStates accounted = states_of_sacct(
      "7_1|COMPLETED\n7_1.batch|FAILED\n7_2|CANCELLED by 1000\n7_[3-5,9%2]|PENDING\n8|FAILED\n7_6|TIMEOUT");
  EXPECT_EQ(accounted, (SlurmStates{{1, "COMPLETED"},
                                    {2, "CANCELLED"},
                                    {3, "PENDING"},
                                    {4, "PENDING"},
                                    {5, "PENDING"},
                                    {6, "TIMEOUT"},
                                    {9, "PENDING"}}));
  EXPECT_TRUE(states_of_sacct("7_[1-").size() <= 1);
  EXPECT_EQ(task_state("CONFIGURING"), TaskState::waiting);
  EXPECT_EQ(task_state("COMPLETING"), TaskState::running);
  EXPECT_EQ(task_state("NODE_FAIL"), TaskState::failed);
  EXPECT_EQ(task_state("COMPLETED"), TaskState::failed) << "it ended, and its chunks are not there";
}

/// Programs of a cluster, each a script, that are found before others.
class Cluster : public ::testing::Test {
 protected:
  Cluster() : path_(std::getenv("PATH")) {
    std::filesystem::create_directories(bin_);
    set("PATH", bin_ + ":" + path_);
    set("TOLD", folder_.at("told"));
  }
  ~Cluster() override { set("PATH", path_); }
  static void set(const char* name, const std::string& value) { ::setenv(name, value.c_str(), 1); }
  void program(const std::string& name, const std::string& body) {
    const std::string path = bin_ + "/" + name;
    io::write_file(path, "#!/bin/bash\n" + body + "\n");
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  }
  [[nodiscard]] std::string told() const {
    return std::filesystem::exists(folder_.at("told")) ? io::read_file(folder_.at("told")) : "";
  }
  /// A task of an array, with a program in robomill's place.
  io::ProgramEnd task(const std::string& body, const std::string& restarts_before) {
    const std::string folder = folder_.at(std::string(awkward).substr(0, 12)).string();
    program("robo mill's", "printf '<%s>' \"$@\" >>\"$TOLD\"\n" + body);
    program("scontrol", "printf '<scontrol %s %s>' \"$@\" >>\"$TOLD\"; kill $PPID");
    const SlurmScripts scripts =
        slurm_scripts({.shards = 3, .restarts = 2},
                      {.program = bin_ + "/robo mill's", .study = "/a 'study'.toml", .folder = folder}, 3);
    folder_.file("array.sh", scripts.array);
    set("SLURM_ARRAY_TASK_ID", "2");
    set("SLURM_JOB_ID", "77");
    set("SLURM_CPUS_PER_TASK", "4");
    set("SLURM_RESTART_COUNT", restarts_before);
    return io::run_program({"bash", folder_.at("array.sh")});
  }

  Folder folder_;
  std::string bin_ = folder_.at("bin"), path_;
};

TEST_F(Cluster, RunsAShardOfTheStudy) {
  EXPECT_EQ(task("exit 0", "0").code, 0);
  EXPECT_EQ(told(), "<sweep></a 'study'.toml><-o><" + folder_.at(std::string(awkward).substr(0, 12)).string() +
                        "><--shard><2/3><--threads><4>");
  EXPECT_EQ(task("exit 3", "0").code, 0) << "no point could be done is an answer";
  EXPECT_EQ(told().find("scontrol"), std::string::npos);
}

TEST_F(Cluster, TakesATaskThatDiedAgainButNotForEver) {
  EXPECT_EQ(task("exit 137", "1").code, 128 + 15) << "the requeue ends it";
  EXPECT_NE(told().find("<scontrol requeue 77>"), std::string::npos) << told();
  const io::ProgramEnd last = task("exit 1", "2");
  EXPECT_EQ(last.code, 1);
  EXPECT_EQ(last.said, "task 2 of 3: ended with 1 after 2 restarts: it is not tried again\n");
}

// The program sends itself what Slurm sends to the script, until it is ended.
TEST_F(Cluster, EndsATaskWhoseTimeIsUpAndQueuesItAgain) {
  const io::ProgramEnd end =
      task("trap 'echo \"<ended>\" >>\"$TOLD\"; exit 143' TERM\nwhile :; do kill -USR1 $PPID; sleep 0.05; done", "0");
  EXPECT_EQ(end.code, 128 + 15) << "the requeue ends it";
  EXPECT_NE(told().find("<ended>\n<scontrol requeue 77>"), std::string::npos) << told();
  EXPECT_EQ(end.said, "task 2 of 3: ended with 124: it goes into the queue again\n");
}

TEST_F(Cluster, TakesTheScriptsAndTheTablesAfterTheTasks) {
  program(
      "sbatch",
      "printf '<%s>' \"$@\" >>\"$TOLD\"; n=$(cat \"$TOLD\" | grep -o parsable | wc -l); echo $((40 + n))\";cluster\"");
  program("squeue", "case \"$*\" in *K*) printf '1|RUNNING\\n2|FAILED\\n3|PENDING\\n';; *) echo PENDING;; esac");
  program("sacct", "echo 'Slurm accounting storage is disabled' >&2; exit 1");
  const SlurmFolder slurm(folder_.at("out"));
  EXPECT_FALSE(slurm.jobs());
  const SlurmJobs jobs = slurm.submit({.array = "a", .merge = "b"}, 3);
  EXPECT_EQ(jobs.array, "41");
  EXPECT_EQ(jobs.merge, "42");
  EXPECT_EQ(told(), "<--parsable><" + slurm.at("array.sh").string() + "><--parsable><--dependency=afterany:41><" +
                        slurm.at("merge.sh").string() + ">");
  ASSERT_TRUE(slurm.jobs());
  EXPECT_EQ(slurm.jobs()->merge, "42");
  EXPECT_EQ(SlurmFolder::states("41"), (SlurmStates{{1, "RUNNING"}, {2, "FAILED"}, {3, "PENDING"}}));
  EXPECT_EQ(SlurmFolder::state("42"), "PENDING");
}

TEST_F(Cluster, ThatRejectsAJobIsQuoted) {
  program("sbatch", "case \"$*\" in *merge*) echo 'sbatch: error: Dependency problem' >&2; exit 1;; *) echo 41;; esac");
  const SlurmFolder slurm(folder_.at("out"));
  const std::string merge = rejection([&] { static_cast<void>(slurm.submit({}, 3)); });
  EXPECT_NE(merge.find("merge.sh: sbatch: error: Dependency problem"), std::string::npos) << merge;
  EXPECT_NE(merge.find("By hand: sbatch --dependency=afterany:41"), std::string::npos) << merge;
  EXPECT_EQ(slurm.jobs()->array, "41") << "it runs, and is known";
  program("sbatch", "echo 'sbatch: error: Batch job submission failed: Invalid account' >&2; exit 1");
  const std::string array = rejection([&] { static_cast<void>(slurm.submit({}, 3)); });
  EXPECT_NE(array.find("array.sh: sbatch: error: Batch job submission failed: Invalid account. Change [slurm]"),
            std::string::npos)
      << array;
  EXPECT_EQ(array.find('\n'), std::string::npos);
  set("PATH", folder_.at("nothing"));
  EXPECT_NE(rejection([&] {
              static_cast<void>(slurm.submit({}, 3));
            }).find("sbatch: cannot be started: No such file or directory"),
            std::string::npos);
}

}  // namespace slurm_test
}  // namespace robomill::jobs
