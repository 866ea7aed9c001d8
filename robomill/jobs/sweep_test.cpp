#include "robomill/jobs/sweep.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/system/output_places.hpp"
#include "robomill/io/table.hpp"
#include "robomill/jobs/files/study_toml.hpp"
#include "robomill/jobs/files/sweep_folder.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/sweep/chunks.hpp"
#include "testing/jobs/study_cut.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace sweep_test {

using test::Folder;
using test::rejection;
using test_support::study_cut;

constexpr const char* study = R"(
[study]
job = "lobes"
base = "lobes.toml"
collect = ["limit@8000", "abs_mu@8000,1.0", "chatter_frequency@8000"]
chunk_points = 4
[[vary]]
key = "cut.radial_depth_mm"
range = [2, 8]
count = 3
[[vary]]
key = "tool.teeth"
values = [2, 3, 4]
)";

class Sweeps : public ::testing::Test {
 protected:
  Sweeps() {
    folder_.file("lobes.toml", study_cut());
    folder_.file("study.toml", study);
  }
  SweepResult run(const std::string& into, int shard = 1, int shards = 1) {
    return run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at(into), .shard = shard, .shards = shards});
  }
  /// A study in which a run is more than its beginning.
  void many_points() {
    std::string text = study;
    folder_.file("study.toml", text.replace(text.find("count = 3"), 9, "count = 60"));
  }
  /// A run in a process of its own, which is killed. @return whether it was not over before
  bool run_and_kill(const std::string& into, std::chrono::microseconds after) {
    const pid_t child = ::fork();
    if (child == 0) {
      set_thread_count(1);  // the threads of this process are not in its copy
      run(into);
      ::_exit(0);
    }
    std::this_thread::sleep_for(after);
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFSIGNALED(status);
  }
  [[nodiscard]] std::string bytes(const std::string& name) const { return io::read_file(folder_.at(name)); }

  Folder folder_;
};

// Each point is what the verb gives for a document with these values.
TEST_F(Sweeps, GiveWhatTheVerbGives) {
  const SweepResult result = run("out");
  EXPECT_TRUE(result.complete());
  EXPECT_EQ(result.points, 9U);
  EXPECT_EQ(result.chunks, 3U);
  EXPECT_EQ(result.done, 9U);
  EXPECT_TRUE(result.absent.empty());
  std::vector<std::string> warnings;
  const io::TextTable table = io::parse_text_table(bytes("out/results.csv"), "results.csv", warnings);
  ASSERT_EQ(table.rows.size(), 9U);
  EXPECT_EQ(table.names.front(), "cut.radial_depth_mm");
  for (const io::TextTable::Row& row : table.rows) {
    const io::TomlSource changed(folder_.at("lobes.toml"), {},
                                 {{"cut.radial_depth_mm", row.fields[0]}, {"tool.teeth", row.fields[1]}});
    const LobesJobResult alone =
        run_lobes({.lobes = changed,
                   .points = {{.spindle_speed_rad_per_s = 8000 * 2 * std::acos(-1.0) / 60, .axial_depth_m = 1e-3}}});
    ASSERT_EQ(alone.lobes.points.size(), 1U);
    EXPECT_NEAR(*io::parse_cell(row.fields[3]), alone.lobes.points[0].spectral_radius, 1e-9);
    const double limit_mm = alone.lobes.points[0].limit_depth_m * 1e3, swept_mm = *io::parse_cell(row.fields[2]);
    if (std::isinf(limit_mm)) {
      EXPECT_EQ(swept_mm, limit_mm) << "no limit in the range";
    } else {
      EXPECT_NEAR(swept_mm, limit_mm, 1e-4);
    }
    EXPECT_EQ(row.fields[5], "done");
  }
}

TEST_F(Sweeps, HaveTheSameBytesByThreadsShardsAndAfterAnInterruption) {
  set_thread_count(1);
  run("one");
  set_thread_count(0);
  run("threads");
  for (const int shard : {2, 3, 1}) run("shards", shard, 3);
  EXPECT_FALSE(std::filesystem::exists(folder_.at("shards/results.csv"))) << "a shard is not the study";
  run("shards");
  std::atomic<bool> stop = false;
  Progress stops([&](const std::string&, double done) { stop = done > 0.5; }, &stop);
  EXPECT_THROW(
      static_cast<void>(run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at("stopped")}, stops)),
      Interrupted);
  EXPECT_FALSE(std::filesystem::exists(folder_.at("stopped/results.csv")));
  const SweepResult rest = run("stopped");
  EXPECT_LT(rest.ran_chunks, 3U);
  for (const char* other : {"threads", "shards", "stopped"}) {
    for (const char* file : {"results.csv", "results.h5", "chunks/0000000.chunk", "chunks/0000002.chunk"}) {
      EXPECT_EQ(bytes(std::string("one/") + file), bytes(std::string(other) + "/" + file)) << other << ": " << file;
    }
  }
}

TEST_F(Sweeps, DoADamagedChunkAgainAndSaySo) {
  run("out");
  const std::string before = bytes("out/results.csv"), chunk = bytes("out/chunks/0000001.chunk");
  for (const std::string& damaged : {chunk.substr(0, 100), std::string(), std::string("x") + chunk.substr(1)}) {
    folder_.file("out/chunks/0000001.chunk", damaged);
    const SweepResult again = run("out");
    EXPECT_EQ(again.ran_chunks, 1U);
    EXPECT_EQ(again.damaged, std::vector<std::uint64_t>{1});
    EXPECT_EQ(bytes("out/results.csv"), before);
    EXPECT_EQ(bytes("out/chunks/0000001.chunk"), chunk);
  }
  EXPECT_EQ(run("out").ran_chunks, 0U) << "nothing is done twice";
}

/// Everything that a study leaves for its user.
constexpr const char* results[] = {"results.csv", "results.h5"};

// Killed at any time and begun again, by a process that computes the same.
TEST_F(Sweeps, HaveTheSameBytesAfterTwentyKills) {
  many_points();
  run("whole");
  Random random(3);
  int killed = 0;
  for (int turn = 0; turn < 20; ++turn) {
    const std::string into = turn % 5 == 0 ? fmt::format("killed{}", turn) : fmt::format("killed{}", turn / 5 * 5);
    killed += run_and_kill(into, std::chrono::microseconds(random.index(200'000))) ? 1 : 0;
    if (turn % 5 != 4) continue;
    run(into);
    for (const char* name : results) EXPECT_EQ(bytes(into + "/" + name), bytes(std::string("whole/") + name)) << into;
  }
  EXPECT_GE(killed, 5) << "most runs are over before they are killed";
}

// The program reads nothing that stands where a job writes, but for this.
TEST_F(Sweeps, GoOnWhereTheirJobWrites) {
  const io::OutputPlaces places({folder_.at("out")});
  EXPECT_TRUE(run("out").complete());
  const SweepResult again = run("out");
  EXPECT_EQ(again.ran_chunks, 0U);
  EXPECT_TRUE(again.damaged.empty());
}

TEST_F(Sweeps, OfShardsAreMerged) {
  run("whole");
  for (const int shard : {3, 1}) run("shards", shard, 3);
  SweepJob job = {.study = folder_.at("study.toml"), .folder = folder_.at("shards"), .shard = 2, .shards = 3};
  EXPECT_NE(rejection([&] {
              SweepJob other = job;
              other.shard = 1;
              other.merge = folder_.at("early.csv");
              static_cast<void>(run_sweep(other));
            }).find("needs all chunks: 2 of 3 are done"),
            std::string::npos);
  static_cast<void>(run_sweep(job));
  for (const std::string ending : {"csv", "h5"}) {
    job = {.study = job.study, .folder = job.folder, .merge = folder_.at("all." + ending)};
    EXPECT_EQ(run_sweep(job).ran_chunks, 0U);
    EXPECT_EQ(bytes("all." + ending), bytes("whole/results." + ending));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.at("early.csv")));
  job.merge = folder_.at("all.txt");
  EXPECT_NE(rejection([&] { static_cast<void>(run_sweep(job)); }).find("must end in .h5, .hdf5 or .csv"),
            std::string::npos);
}

// Chunks that were done elsewhere count: a shard may have a folder of its own.
TEST_F(Sweeps, TakeChunksOfOtherFolders) {
  run("whole");
  run("other", 2, 3);
  run("out", 1, 3);
  std::filesystem::copy(folder_.at("other/chunks"), folder_.at("out/chunks"));
  EXPECT_EQ(run("out").ran_chunks, 1U);
  for (const char* name : results) EXPECT_EQ(bytes(std::string("out/") + name), bytes(std::string("whole/") + name));
}

TEST_F(Sweeps, ExcludeEachOtherOnOneFolder) {
  run("out", 1, 2);
  const SweepFolder folder(folder_.at("out"));
  const auto busy = [&](int shard, int shards) {
    return rejection([&] { run("out", shard, shards); }).find("is being worked on by another run") != std::string::npos;
  };
  {
    const SweepFolder::Locks shard = folder.lock(1, 2);
    EXPECT_TRUE(busy(1, 2));
    EXPECT_TRUE(busy(1, 1));
    run("out", 2, 2);
  }
  const SweepFolder::Locks whole = folder.lock(1, 1);
  EXPECT_TRUE(busy(1, 2));
  EXPECT_TRUE(busy(1, 1));
  const SweepResult status =
      run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at("out"), .status = true});
  EXPECT_TRUE(status.complete()) << "whoever asks how far it is does not wait";
}

// Whoever hands chunks out to processes of his own gets the same bytes.
TEST_F(Sweeps, AreDoneChunkByChunkElsewhere) {
  run("whole");
  const StudyChunks chunks(folder_.at("study.toml"));
  {
    StudyFolder kept(folder_.at("study.toml"), folder_.at("out"));
    EXPECT_EQ(kept.fingerprint(), chunks.fingerprint());
    EXPECT_EQ(kept.todo(), (std::vector<std::uint64_t>{0, 1, 2}));
    EXPECT_NE(rejection([&] { run("out"); }).find("is being worked on by another run"), std::string::npos);
    for (const std::uint64_t chunk : {2U, 0U}) {
      const std::string done = chunks.bytes_of(chunk, kept.chunk_points(), Progress::none());
      EXPECT_EQ(done, bytes(fmt::format("whole/chunks/{:07}.chunk", chunk)));
      kept.save(chunk, done);
      EXPECT_NE(rejection([&] { kept.save(1, done); }).find("are not those of it"), std::string::npos);
      EXPECT_NE(rejection([&] { kept.save(3, done); }).find("is none of the study"), std::string::npos);
    }
  }
  const StudyFolder again(folder_.at("study.toml"), folder_.at("out"));
  EXPECT_EQ(again.todo(), std::vector<std::uint64_t>{1});
}

// What a study asks of a cluster changes no result.
TEST_F(Sweeps, GoOnWithOtherSettingsOfACluster) {
  run("out");
  const std::string before = bytes("study.toml");
  folder_.file("study.toml", before + "[slurm]\nshards = 2\ntime_min = 60\npartition = \"short\"\n");
  EXPECT_EQ(run("out").ran_chunks, 0U);
  folder_.file("study.toml", before + "[slurm]\nshards = 2\ntime_min = 2\n");
  EXPECT_NE(rejection([&] { run("out"); }).find("slurm.time_min = 2 min; must be >= 5"), std::string::npos);
}

// A folder says who works there and how long points took.
TEST_F(Sweeps, SayWhatIsLeft) {
  for (const int shard : {1, 2}) run("out", shard, 3);
  const SweepFolder::Locks other = SweepFolder(folder_.at("out")).lock(3, 3);
  const SweepResult status =
      run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at("out"), .status = true});
  EXPECT_EQ(status.running, std::vector<std::string>{"3/3"});
  EXPECT_GT(status.point_s, 0.0);
  EXPECT_DOUBLE_EQ(status.left_thread_s, status.point_s * static_cast<double>(status.points - status.done));
  EXPECT_DOUBLE_EQ(status.left_s, status.left_thread_s) << "of the one thread of the other run";
}

// A disk that is full anywhere between the first file and the last.
TEST_F(Sweeps, LeaveNoHalfFileOnAFullDisk) {
  many_points();
  run("whole");
  int failed = 0;
  for (const std::size_t bytes_left : {0U, 100U, 500U, 2000U, 8000U, 20'000U}) {
    const std::string into = fmt::format("full{}", bytes_left);
    {
      const test::FileSizeLimit limit(bytes_left);
      const std::string said = rejection([&] { run(into); });
      EXPECT_NE(said.find(into), std::string::npos) << "names the place: " << said;
      ++failed;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.at(into))) {
      if (!entry.is_regular_file() || entry.path().extension() == ".lock") continue;
      const std::string name = std::filesystem::relative(entry.path(), folder_.at(into)).string();
      EXPECT_EQ(io::read_file(entry.path()), bytes("whole/" + name)) << into << ": " << name;
    }
    run(into);
    for (const char* name : results) EXPECT_EQ(bytes(into + "/" + name), bytes(std::string("whole/") + name)) << into;
  }
  EXPECT_EQ(failed, 6);
}

TEST_F(Sweeps, OfAnotherStudyAreRejected) {
  run("out");
  const auto says = [&] { return rejection([&] { run("out"); }); };
  folder_.file("lobes.toml", study_cut() + "# the same cut\n");
  EXPECT_NE(says().find("is of another study"), std::string::npos);
  folder_.file("lobes.toml", study_cut());
  run("out");
  const std::string plan = bytes("out/study.json");
  folder_.file("out/study.json", std::string(plan).replace(plan.find("\"points\": 9"), 11, "\"points\": 8"));
  EXPECT_NE(says().find("study.json: does not fit its study"), std::string::npos) << says();
  folder_.file("out/study.json", "{}");
  EXPECT_NE(says().find("study.json: fingerprint"), std::string::npos) << says();
}

// A chunk whose document was replaced while it ran is not kept.
TEST_F(Sweeps, DropPointsOfFilesThatChangeMeanwhile) {
  bool changed = false;
  Progress changes(
      [&](const std::string&, double done) {
        if (changed || done < 0.5) return;
        folder_.file("lobes.toml", study_cut() + "# the same cut\n");
        changed = true;
      },
      nullptr);
  EXPECT_NE(rejection([&] {
              static_cast<void>(run_sweep({.study = folder_.at("study.toml"), .folder = folder_.at("out")}, changes));
            }).find("or a file that it names has changed while the study ran"),
            std::string::npos);
  folder_.file("lobes.toml", study_cut());
  EXPECT_EQ(run("out").ran_chunks, 2U);
}

// Files that a document or the value of a key names count with what is in them.
TEST_F(Sweeps, OfOtherFilesAreRejected) {
  const std::string text = study_cut();
  folder_.file("lobes.toml", text.substr(0, text.find("[dynamics]")) + "[dynamics]\nmodes = \"a.toml\"\n" +
                                 text.substr(text.find("[lobes]")));
  const std::string mode = "left = {{ x = [0.01, 0.0], y = [0.0, 0.0] }}\nright = {{ x = [0.0, {}], y = [0.0, {}] }}\n";
  const auto modes = [&](const std::string& name, double x) {
    folder_.file(name, "[[modes]]\nfrequency_hz = 600\ndamping_ratio = 0.02\n" + fmt::format(fmt::runtime(mode), x, x));
  };
  modes("a.toml", -0.04);
  modes("b.toml", -0.08);
  folder_.file("study.toml", R"(
[study]
job = "lobes"
base = "lobes.toml"
collect = "limit@8000"
[[vary]]
key = "dynamics.modes"
values = ["a.toml", "b.toml"]
)");
  EXPECT_EQ(run("out").done, 2U) << bytes("out/results.csv");
  std::vector<std::string> warnings;
  const io::TextTable table = io::parse_text_table(bytes("out/results.csv"), "results.csv", warnings);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[1].fields[0], "b.toml");
  EXPECT_NEAR(*io::parse_cell(table.rows[0].fields[1]), 2.0 * *io::parse_cell(table.rows[1].fields[1]), 1e-3)
      << "a mode twice as compliant";
  for (const char* name : {"a.toml", "b.toml"}) {
    const std::string before = bytes(name);
    folder_.file(name, before + "# the same mode\n");
    EXPECT_NE(rejection([&] { run("out"); }).find("is of another study"), std::string::npos) << name;
    folder_.file(name, before);
    EXPECT_EQ(run("out").ran_chunks, 0U);
  }
}

TEST_F(Sweeps, KeepAPointThatIsNoCut) {
  folder_.file("study.toml", R"(
[study]
job = "lobes"
base = "lobes.toml"
collect = "limit@8000"
[[vary]]
key = "cut.radial_depth_mm"
values = [5, 12]
)");
  const SweepResult result = run("out");
  EXPECT_EQ(result.done, 1U);
  EXPECT_EQ(result.rejected, 1U);
  ASSERT_EQ(result.reasons.size(), 1U);
  EXPECT_NE(result.reasons[0].find("cut.radial_depth_mm = 12 mm"), std::string::npos) << result.reasons[0];
  EXPECT_NE(bytes("out/results.csv").find("12,,rejected"), std::string::npos) << bytes("out/results.csv");
}

// Also one that another verb reads in the same document.
TEST_F(Sweeps, RejectAKeyThatTheJobDoesNotRead) {
  folder_.file("study.toml", R"(
[study]
job = "lobes"
base = "lobes.toml"
collect = "limit@8000"
[[vary]]
key = "spindle.max_speed_rpm"
values = [9000]
)");
  const SweepResult result = run("out");
  EXPECT_EQ(result.rejected, 1U);
  ASSERT_EQ(result.reasons.size(), 1U);
  EXPECT_NE(result.reasons[0].find("lobes.toml: lobes does not read spindle.max_speed_rpm in it"), std::string::npos)
      << result.reasons[0];
}

TEST_F(Sweeps, SetKeysToNumbersTextsBooleansAndLists) {
  const auto values = [&](const std::string& text) {
    folder_.file("study.toml",
                 "[study]\njob = \"lobes\"\nbase = \"lobes.toml\"\ncollect = \"limit@8000\"\n[[vary]]\nkey = \"a\"\n" +
                     ("values = " + text + "\n"));
    std::string out;
    const Study study = read_study(folder_.at("study.toml"));
    for (const std::vector<std::string>& row : study.vary[0].values) out += row[0] + ";";
    return out;
  };
  EXPECT_EQ(values("[1, 2.5, 1e-7]"), "1;2.5;1e-07;");
  EXPECT_EQ(values("[true, false]"), "true;false;");
  EXPECT_EQ(values("[\"up\", \"a \\\"b\\\"\"]"), "\"up\";\"a \\\"b\\\"\";");
  EXPECT_EQ(values("7"), "7;");
  const auto says = [&](const std::string& text) { return rejection([&] { static_cast<void>(values(text)); }); };
  EXPECT_EQ(values("[[6000, 12000], 7000, [\"a, b\", true], [[1, 2.5], [3, 4]], []]"),
            "[6000, 12000];7000;[\"a, b\", true];[[1, 2.5], [3, 4]];[];");
  EXPECT_EQ(values("[\n  [6000, 12000],  # from, to\n  [8000,\n   16000],\n]"), "[6000, 12000];[8000, 16000];");
  EXPECT_NE(says("[]").find("study.toml:7: vary[1].values: must not be empty"), std::string::npos) << says("[]");
  const auto rejects = [&](const std::string& text, const std::string& place) {
    EXPECT_NE(says(text).find("study.toml:" + place), std::string::npos) << says(text);
    EXPECT_NE(says(text).find("must be a finite number, a text, true or false, or a list of them"), std::string::npos);
  };
  rejects("{ a = 1 }", "7: vary[1].values: ");
  rejects("[{ a = 1 }]", "7: vary[1].values[1]: ");
  rejects("[[1, 2],\n[3, [{ a = 1 }]]]", "8: vary[1].values[2][2][1]: ");
  rejects("[[1, 2],\n[3, inf]]", "8: vary[1].values[2][2] = inf; ");
  rejects("1979-05-27", "7: vary[1].values: ");
}

TEST_F(Sweeps, TakeAnyNumberOfADocument) {
  folder_.file("study.toml", R"(
[study]
job = "simulate"
base = "lobes.toml"
collect = ["time.seconds", "no.such.key"]
options = { at = [8000, 0.5], seconds = 0.1 }
[[vary]]
key = "cut.radial_depth_mm"
values = [2, 3]
)");
  const SweepResult result = run("out");
  EXPECT_EQ(result.done + result.short_of, 2U);
  EXPECT_EQ(result.absent.back(), "no.such.key") << "said, since it may be a slip";
}

TEST_F(Sweeps, AreCheckedBeforeTheyRun) {
  const auto says = [&](const std::string& text) {
    folder_.file("study.toml", text);
    return rejection([&] { run("out"); });
  };
  const std::string head = "[study]\nbase = \"lobes.toml\"\n";
  const std::string vary = "[[vary]]\nkey = \"tool.teeth\"\nvalues = [2]\n";
  EXPECT_NE(says(head + "job = \"lobs\"\ncollect = \"limit@8000\"\n" + vary).find("is no job that can be varied"),
            std::string::npos);
  EXPECT_NE(says(head + "job = \"lobes\"\ncollect = \"limit@fast\"\n" + vary).find("one speed in rpm behind @"),
            std::string::npos);
  EXPECT_NE(says(head + "job = \"forces\"\ncollect = \"limit@8000\"\n" + vary).find("is of the job lobes alone"),
            std::string::npos);
  EXPECT_NE(says(head + "job = \"lobes\"\ncollect = \"limit@8000\"\n[[vary]]\nkey = \"tool.teeth\"\n")
                .find("must have values, range or table"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_.at("out"))) << "nothing is made";
}

}  // namespace sweep_test
}  // namespace robomill::jobs
