// robomill smooth --stream as a user runs it. Delays are reported, not tested: the machine is shared.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "test_program.hpp"

namespace robomill::app {
namespace stream_test {

using json = nlohmann::json;

class StreamVerb : public ProgramTest {
 protected:
  void SetUp() override {
    std::filesystem::copy_file(ROBOMILL_SOURCE_DIR "/examples/smooth-impeller-like/cell.toml", folder_.at("cell.toml"));
    folder_.file("part.ngc", "G21 G90 G94\nG0 X0 Y0 Z40 A-20 C0\nG1 X4 F1800\nG1 X4 Y3 A-22\nG1 X0 Y3\nM30\n");
    folder_.file("long.ngc", "G21 G90 G94\nG0 X0 Y0 Z40 A-20 C0\nG1 X10 F60\nG1 X0\nM30\n");
  }
  /// A stream in the background.
  test::Process start(const std::string& arguments) const {
    return {{"sh", "-c", "cd '" + folder_.path().string() + "' && exec '" ROBOMILL_PROGRAM "' " + arguments},
            folder_.at("out.txt"),
            folder_.at("err.txt")};
  }
  static std::vector<json> lines_of(const std::string& text) {
    std::vector<json> out;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) out.push_back(json::parse(line));
    return out;
  }
  /// Velocity, acceleration and jerk of the joints, by differences, against the limits of the cell.
  static void expect_within_limits(const std::vector<json>& lines) {
    const std::vector<double> velocity = {2.1, 2.0, 1.9, 3.1, 3.0, 3.8}, acceleration = {3, 3, 3, 8, 8, 10},
                              jerk = {60, 60, 60, 200, 200, 250};
    for (std::size_t i = 3; i < lines.size(); ++i) {
      for (std::size_t j = 0; j < 6; ++j) {
        const auto q = [&](std::size_t back) { return lines[i - back]["joints"][j].get<double>(); };
        ASSERT_LE(std::abs(q(0) - q(1)) * 1e3, velocity[j] * (1 + 1e-6));
        ASSERT_LE(std::abs(q(0) - 2 * q(1) + q(2)) * 1e6, acceleration[j] * (1 + 1e-6));
        ASSERT_LE(std::abs(q(0) - 3 * q(1) + 3 * q(2) - q(3)) * 1e9, jerk[j] * (1 + 1e-6));
      }
    }
  }
};

TEST_F(StreamVerb, WritesASetpointAPeriod) {
  const Ended run = robomill("smooth part.ngc --cell cell.toml --stream --report stream.json < /dev/null");
  ASSERT_EQ(run.exit, 0) << run.err;
  const std::vector<json> lines = lines_of(run.out);
  const json report = json::parse(slurp(folder_.at("stream.json")));
  EXPECT_EQ(report["document"], "stream/1");
  EXPECT_EQ(report["end"], "finished");
  EXPECT_EQ(report["periods"], lines.size());
  EXPECT_EQ(report["lines"], lines.size());
  EXPECT_EQ(report["overruns"], 0);
  ASSERT_GT(lines.size(), 100U);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    ASSERT_NEAR(lines[i]["time_s"].get<double>(), 1e-3 * static_cast<double>(i), 1e-9);
  }
  EXPECT_EQ(lines.back()["state"], "finished");
  EXPECT_EQ(lines[lines.size() / 2]["state"], "running");
  const std::vector<double> at_end_mm = {0.0, 3.0, 40.0};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(lines.back()["tip_mm"][k].get<double>(), at_end_mm[k], 1e-9);
  EXPECT_EQ(lines.back()["block"], 3);
  expect_within_limits(lines);
  EXPECT_NE(run.err.find("were handed over after the end of their period"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("Collisions: none"), std::string::npos) << run.err;
  // The trajectory that is smoothed ahead begins and ends in the same positions.
  ASSERT_EQ(robomill("smooth part.ngc --cell cell.toml -o t.csv").exit, 0);
  const std::string rows = slurp(folder_.at("t.csv"));
  const std::string last = rows.substr(rows.rfind('\n', rows.size() - 2) + 1);
  std::istringstream cells(last.substr(last.find(',') + 1));
  for (std::size_t j = 0; j < 6; ++j) {
    double q = 0.0;
    char comma = 0;
    cells >> q >> comma;
    EXPECT_NEAR(lines.back()["joints"][j].get<double>(), q, 1e-12);
  }
}

TEST_F(StreamVerb, WritesAFileThatAppearsWhole) {
  const Ended run = robomill("smooth part.ngc --cell cell.toml --stream -o s.csv --quiet < /dev/null");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(run.out, "");
  const std::string rows = slurp(folder_.at("s.csv"));
  EXPECT_TRUE(rows.starts_with("time_s,q1,q2,q3,q4,q5,q6,x_mm,y_mm,z_mm,i,j,k,block,override,state\n0,"));
  EXPECT_NE(rows.find(",finished\n"), std::string::npos);
}

TEST_F(StreamVerb, TakesCommandsFromAPipe) {
  // Each command waits for the state that the one before leads to.
  write(
      "commands.sh",
      "is_in() { i=0; until tail -n 2 s.jsonl 2>/dev/null | grep -q \"\\\"$1\\\"\" || [ $i -ge 1500 ]; do sleep 0.02; "
      "i=$((i + 1)); done; }\n"
      "echo override 0.5; is_in running; echo hold; is_in holding; echo nonsense\n"
      "head -c 5000 /dev/urandom | tr '\\n' x; echo; echo resume; is_in running; echo stop\n");
  const Ended run = shell("sh commands.sh | '" ROBOMILL_PROGRAM
                          "' smooth long.ngc --cell cell.toml --stream --report r.json > s.jsonl");
  EXPECT_EQ(run.exit, 0) << run.err;
  const std::vector<json> lines = lines_of(slurp(folder_.at("s.jsonl")));
  const json report = json::parse(slurp(folder_.at("r.json")));
  EXPECT_EQ(report["end"], "stopped");
  EXPECT_EQ(report["commands"], 4);
  EXPECT_EQ(report["rejected_commands"], 2);
  EXPECT_EQ(lines.back()["state"], "stopped");
  const auto in_state = [&](const char* state) {
    return std::count_if(lines.begin(), lines.end(), [&](const json& line) { return line["state"] == state; });
  };
  EXPECT_GT(in_state("holding"), 0);
  EXPECT_GT(in_state("running"), 0);
  for (const json& line : lines) EXPECT_LE(line["override"].get<double>(), 1.0);
  expect_within_limits(lines);
  EXPECT_NE(run.err.find("error: \"nonsense\" is no command"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("error: a command has at most 200 bytes"), std::string::npos) << run.err;
}

TEST_F(StreamVerb, BeginsHeldAndTakesCommandsFromASocket) {
  const test::Process stream = start("smooth part.ngc --cell cell.toml --stream --held --listen ./c.sock -o s.jsonl");
  ASSERT_TRUE(test::wait_for([&] { return std::filesystem::exists(folder_.at("c.sock")); }));
  const std::string tell =
      "import socket, sys\ns = socket.socket(socket.AF_UNIX)\ns.connect('c.sock')\nf = s.makefile('rw')\n"
      "for line in sys.argv[1:]:\n  f.write(line + '\\n')\n  f.flush()\n  print(f.readline(), end='')\n";
  write("tell.py", tell);
  const Ended told = shell("python3 tell.py status bad 'override 1' resume");
  EXPECT_EQ(told.exit, 0) << told.err;
  EXPECT_TRUE(told.out.starts_with("ok holding, ") || told.out.starts_with("ok waiting, ")) << told.out;
  EXPECT_NE(told.out.find("\nerror: \"bad\" is no command"), std::string::npos) << told.out;
  EXPECT_NE(told.out.find("\nok override 1\nok resume\n"), std::string::npos) << told.out;
  ASSERT_TRUE(test::wait_for([&] { return !stream.running(); }));
  EXPECT_FALSE(std::filesystem::exists(folder_.at("c.sock")));
  const std::vector<json> lines = lines_of(slurp(folder_.at("s.jsonl")));
  EXPECT_EQ(lines.front()["state"], "holding");
  EXPECT_EQ(lines.back()["state"], "finished");
}

// Ctrl-C stops within the limits, and all is reported.
TEST_F(StreamVerb, ASignalStopsIt) {
  ASSERT_EQ(::mkfifo(folder_.at("pipe").c_str(), 0600), 0);
  const test::Process reader({"sh", "-c", "cat '" + folder_.at("pipe").string() + "'"}, folder_.at("read.txt"),
                             folder_.at("reader-err.txt"));
  const test::Process stream = start("smooth long.ngc --cell cell.toml --stream -o pipe --report stream.json");
  ASSERT_TRUE(test::wait_for([&] { return slurp(folder_.at("read.txt")).find("running") != std::string::npos; }));
  stream.signal(SIGINT);
  ASSERT_TRUE(test::wait_for([&] { return !stream.running() && !reader.running(); }));
  const json report = json::parse(slurp(folder_.at("stream.json")));
  EXPECT_EQ(report["end"], "interrupted");
  const std::vector<json> lines = lines_of(slurp(folder_.at("read.txt")));
  EXPECT_EQ(lines.size(), report["periods"]);
  EXPECT_EQ(lines.back()["state"], "stopped");
  expect_within_limits(lines);
}

// The rest of the program is not run in silence.
TEST_F(StreamVerb, AReaderThatLeavesEndsItWithAnError) {
  const Ended run =
      shell("{ '" ROBOMILL_PROGRAM
            "' smooth long.ngc --cell cell.toml --stream </dev/null; echo \"exit $?\" >&2; } | head -n 3");
  EXPECT_NE(run.err.find("exit 1\n"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("robomill: standard output cannot be written: its reader has closed it"), std::string::npos)
      << run.err;
  EXPECT_EQ(robomill("smooth part.ngc --cell cell.toml --stream < /dev/null > /dev/full").exit, 1);
}

TEST_F(StreamVerb, RejectsWhatItCannotRun) {
  EXPECT_EQ(robomill("smooth part.ngc --stream").exit, 2);
  EXPECT_EQ(robomill("smooth part.ngc --cell cell.toml --listen 5005").exit, 2);
  EXPECT_EQ(robomill("smooth part.ngc --cell cell.toml --stream --compare").exit, 2);
  const Ended place = robomill("smooth part.ngc --cell cell.toml --stream --listen nowhere:x");
  EXPECT_EQ(place.exit, 1);
  EXPECT_NE(place.err.find("--listen"), std::string::npos) << place.err;
  write("far.ngc", "G21 G90 G94\nG0 X0 Y0 Z40 A-20 C0\nG1 X9000 F1800\nM30\n");
  const Ended far = robomill("smooth far.ngc --cell cell.toml --stream < /dev/null");
  EXPECT_EQ(far.exit, 1);
  EXPECT_EQ(far.out, "");
  EXPECT_NE(far.err.find("line 3"), std::string::npos) << far.err;
  // A program whose mistake comes late is found before anything moves: the posture takes a look at all of it.
  write("bad.ngc", "G21 G90 G94\nG0 X0 Y0 Z40 A-20 C0\nG1 X4 F1800\nG1 Xfour\nM30\n");
  EXPECT_EQ(robomill("smooth bad.ngc --cell cell.toml --stream < /dev/null").exit, 1);
}

}  // namespace stream_test
}  // namespace robomill::app
