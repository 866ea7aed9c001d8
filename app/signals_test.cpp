// Ctrl-C, SIGTERM and SIGHUP end every verb, wherever it is, and no half-written file stays behind.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <chrono>
#include <complex>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "test_program.hpp"

namespace robomill::app {
namespace signals_test {

constexpr std::array<int, 3> signals = {SIGINT, SIGTERM, SIGHUP};

/// 4,000 lines of a receptance with five modes.
std::string five_modes() {
  std::string text = "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n";
  for (int line = 1; line <= 4000; ++line) {
    std::complex<double> h = 0.0;
    for (const double mode_hz : {400.0, 900.0, 1500.0, 2300.0, 3200.0}) {
      const double ratio = static_cast<double>(line) / mode_hz;
      h += 1e-7 / std::complex<double>(1.0 - ratio * ratio, 0.04 * ratio);
    }
    text += fmt::format("{},{},{}\n", line, h.real(), h.imag());
  }
  return text;
}

class Signals : public ProgramTest {
 protected:
  test::Process start(const std::string& arguments) const {
    return {{"sh", "-c", "cd '" + folder_.path().string() + "' && exec '" ROBOMILL_PROGRAM "' " + arguments},
            folder_.at("out.txt"),
            folder_.at("err.txt")};
  }
  /// Named pipes that nobody writes to: a verb waits in the system for as long as the test likes.
  void make_pipes() const {
    for (const char* name : {"pipe.toml", "pipe.csv", "pipe.json", "pipe.uff"}) {
      ASSERT_EQ(::mkfifo(folder_.at(name).c_str(), 0600), 0);
    }
  }
  [[nodiscard]] std::vector<std::string> names(const std::string& prefix) const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      if (name.starts_with(prefix)) found.push_back(name);
    }
    return found;
  }
  void expect_ended(const test::Process& process, int number, const std::string& what) {
    process.signal(number);
    EXPECT_TRUE(test::wait_for([&] { return !process.running(); })) << what << " did not end";
    EXPECT_EQ(names("."), std::vector<std::string>()) << what;
    EXPECT_EQ(names("result"), std::vector<std::string>()) << what;
  }
  void write_slow_smoothing() {
    std::filesystem::copy_file(ROBOMILL_SOURCE_DIR "/examples/smooth-impeller-like/cell.toml", folder_.at("cell.toml"));
    folder_.file("slow.ngc", "G21 G90 G94\nG0 X0 Y0 Z40 A-20 C0\nG1 X4 F0.005\nM30\n");
  }
};

// Waiting for a file, as from a share that does not answer: no step polls there.
TEST_F(Signals, EndEveryVerbWhereItReads) {
  make_pipes();
  write("part.ngc", "G1 X1 F100\n");
  const std::vector<std::string> verbs = {
      "frf pipe.toml -o result.uff",
      "modes pipe.uff -o result.json",
      "couple pipe.toml -o result.uff",
      "joint pipe.toml --measured tip.uff -o result.json",
      "lobes pipe.toml -o result.json",
      "explain --peaks 100 --rpm 6000 --teeth 3 --modes pipe.json -o result.json",
      "simulate pipe.toml --at 6000,1 -o result.csv",
      "forces pipe.toml -o result.csv",
      "coefficients pipe.csv -o result.toml",
      "stiffness pipe.csv --cell pipe.toml -o result.toml",
      "smooth part.ngc --cell pipe.toml -o result.csv",
      "monitor pipe.toml --input x.wav -o result.jsonl",
      "calibrate pipe.toml -o result.toml",
      "plan pipe.toml -o result",
  };
  std::size_t next = 0;
  for (const std::string& verb : verbs) {
    for (int turn = 0; turn < test::seeds(30); turn += 10) {
      const int number = signals.at(next++ % signals.size());
      test::Process process = start(verb);
      std::this_thread::sleep_for(std::chrono::milliseconds(100 * (turn + 2)));
      expect_ended(process, number, verb);
      EXPECT_EQ(process.wait(), 128 + number) << verb << ": " << slurp(folder_.at("err.txt"));
    }
  }
}

// Counting, each at a step that takes minutes at least.
TEST_F(Signals, EndEveryVerbWhereItCounts) {
  write_lobes("tangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n", "[4000, 4000]\noutput = \"map\"");
  write_slow_smoothing();
  std::string cut = slurp(ROBOMILL_SOURCE_DIR "/examples/force-along-program/forces.toml");
  cut.replace(cut.find("dexel_mm = 0.25"), 15, "dexel_mm = 0.015");
  write("forces.toml", cut);
  write("frf.csv", five_modes());
  write("modes.toml", "[fit]\nmethod = \"pso\"\nmodes = 5\npso_particles = 30000\npso_max_iterations = 100000\n");
  const std::vector<std::string> verbs = {
      "lobes lobes.toml -o result.json",
      "simulate lobes.toml --at 7000,1 --seconds 3600 --allow-large -o result.csv",
      "smooth slow.ngc --cell cell.toml -o result.csv",
      "forces forces.toml --program '" ROBOMILL_SOURCE_DIR
      "/examples/force-along-program/hollow.ngc' --cell '" ROBOMILL_SOURCE_DIR
      "/examples/force-along-program/cell.toml' -o result.csv",
      "modes frf.csv --config modes.toml --allow-large -o result.json",
  };
  std::size_t next = 0;
  for (const std::string& verb : verbs) {
    for (int turn = 0; turn < test::seeds(20); ++turn) {
      const int number = signals.at(next++ % signals.size());
      test::Process process = start(verb);
      std::this_thread::sleep_for(std::chrono::milliseconds(300 * (turn % 10 + 1)));
      expect_ended(process, number, verb);
      EXPECT_EQ(process.wait(), 128 + number) << verb << ": " << slurp(folder_.at("err.txt"));
    }
  }
}

// The trajectory is written as it is planned: its temporary file goes, after the first signal and after a second.
TEST_F(Signals, TemporaryFilesGo) {
  write_slow_smoothing();
  for (const char* result : {"result.csv", "result.h5", "result.src"}) {
    for (const int number : signals) {
      for (const bool twice : {false, true}) {
        test::Process process = start(std::string("smooth slow.ngc --cell cell.toml -o ") + result);
        ASSERT_TRUE(test::wait_for([&] { return !names(".result").empty() || !process.running(); }));
        ASSERT_TRUE(process.running()) << slurp(folder_.at("err.txt"));
        if (twice) process.signal(number);
        expect_ended(process, number, result);
        EXPECT_EQ(process.wait(), 128 + number);
        EXPECT_NE(slurp(folder_.at("err.txt")).find("robomill: interrupted"), std::string::npos);
      }
    }
  }
}

// As `| head` does: whoever reads the summary goes.
TEST_F(Signals, ABrokenPipeLeavesNothingBehind) {
  write("monitor.toml", "[signal]\nsample_rate_hz = 1000\nchannels = [1]\n");
  std::string rows;
  for (int i = 0; i < 200'000; ++i) rows += i % 4000 < 2000 ? "0\n" : std::to_string(i * 7919 % 101) + "\n";
  write("rec.csv", rows);  // a signal that comes and goes: an event each time, and a line of it
  const Ended run = shell("{ env --default-signal=PIPE '" ROBOMILL_PROGRAM
                          "' monitor monitor.toml --input rec.csv -o result.jsonl; echo $? >exit.txt; } | true");
  EXPECT_EQ(slurp(folder_.at("exit.txt")), "141\n") << run.err;
  EXPECT_EQ(names(".result"), std::vector<std::string>());
  EXPECT_EQ(names("result"), std::vector<std::string>());
}

// As after nohup, or in the background of a script.
TEST_F(Signals, WhatTheCallerIgnoresIsIgnored) {
  write_slow_smoothing();
  const test::Process process(
      {"sh", "-c",
       "cd '" + folder_.path().string() +
           "' && trap '' HUP INT && exec '" ROBOMILL_PROGRAM "' smooth slow.ngc --cell cell.toml -o result.csv"},
      folder_.at("out.txt"), folder_.at("err.txt"));
  ASSERT_TRUE(test::wait_for([&] { return !names(".result").empty() || !process.running(); }));
  process.signal(SIGHUP);
  process.signal(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_TRUE(process.running());
  expect_ended(process, SIGTERM, "smooth");
}

}  // namespace signals_test
}  // namespace robomill::app
