// The server's end, before programs that are no workers. The worker itself is tested with the program (app/).
#include "robomill/serve/process/worker_process.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "robomill/io/file.hpp"
#include "robomill/io/system/sandbox.hpp"
#include "robomill/serve/process/work.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace worker_process_test {

/// What becomes of a question.
std::string asked(WorkerProcess& process, const WorkerProcess::Question& question) {
  try {
    return process.ask(question).body;
  } catch (const WorkerEnded& error) {
    return error.what();
  } catch (const Interrupted&) {
    return "interrupted";
  }
}

/// A shell's commands in the place of a worker; its socket is descriptor 3.
WorkerOptions shell(const std::string& commands) {
  return {.command = {"/bin/sh", "-c", commands}, .root = "/"};
}

TEST(WorkerProcess, SaysWhatItsProcessDiedOf) {
  for (const auto& [commands, text] : {std::pair{"kill -KILL $$", "was killed"},
                                       {"kill -SEGV $$", "crashed (signal 11"},
                                       {"exit 7", "exit code 7"},
                                       {"exec 3>&-; trap '' TERM; exec sleep 20", "did not end and was killed"},
                                       {"echo hello, server >&3; exec sleep 20", "cannot be understood"}}) {
    WorkerProcess process(shell(commands));
    const std::string said = asked(process, {.kind = Frame::job});
    EXPECT_NE(said.find(text), std::string::npos) << commands << ": " << said;
  }
  WorkerProcess none(WorkerOptions{.command = {"/no/such/program"}, .root = "/"});
  EXPECT_NE(asked(none, {.kind = Frame::job}).find("cannot be started"), std::string::npos);
}

TEST(WorkerProcess, DoesNotGuessWhatNobodyKnows) {
  // As a launcher may have it: then the kernel keeps no word of how a process ended.
  std::signal(SIGCHLD, SIG_IGN);
  WorkerProcess process(shell("exit 7"));
  const std::string said = asked(process, {.kind = Frame::job});
  std::signal(SIGCHLD, SIG_DFL);
  EXPECT_NE(said.find("nobody knows of what"), std::string::npos) << said;
}

TEST(WorkerProcess, ReadsAnAnswer) {
  // Five bytes before it: 'a', and 6 as four bytes.
  WorkerProcess process(shell("printf 'a\\006\\000\\000\\000200 {}' >&3; cat <&3 >/dev/null"));
  EXPECT_EQ(asked(process, {.kind = Frame::job}), "{}");
}

TEST(WorkerProcess, IsStartedAgainUnlessItRemembers) {
  WorkerProcess process(shell("exit 7"));
  EXPECT_NE(asked(process, {.kind = Frame::lobes}).find("exit code 7"), std::string::npos);
  EXPECT_NE(asked(process, {.kind = Frame::lobes}).find("exit code 7"), std::string::npos);
  WorkerProcess remembers(shell("exit 7"), true);
  EXPECT_NE(asked(remembers, {.kind = Frame::lobes}).find("exit code 7"), std::string::npos);
  EXPECT_NE(asked(remembers, {.kind = Frame::lobes}).find("run it again"), std::string::npos);
}

TEST(WorkerProcess, IsKilledWhereItDoesNotStop) {
  const WorkerProcess::Question stopped = {
      .kind = Frame::job, .stopped = [] { return true; }, .patience = std::chrono::milliseconds(20)};
  WorkerProcess deaf(shell("trap '' TERM; while :; do sleep 1; done"));
  EXPECT_EQ(asked(deaf, stopped), "interrupted");
  const WorkerProcess::Question long_one = {.kind = Frame::job,
                                            .look = std::chrono::milliseconds(1),
                                            .most = std::chrono::milliseconds(20),
                                            .patience = std::chrono::milliseconds(20)};
  EXPECT_NE(asked(deaf, long_one).find("took longer"), std::string::npos);  // another process
}

TEST(WorkerProcess, GivesNoQuestionTheAnswerOfAnother) {
  const test::Folder place;
  // Each process says how far it is, and answers with its number.
  WorkerProcess process(shell("cd '" + place.path().string() +
                              "'; echo >> count; printf 'f\\034\\000\\000\\000{\"task\":\"a\",\"fraction\":0.25}' >&3; "
                              "printf 'a\\005\\000\\000\\000200 %d' $(wc -l < count) >&3; exec cat <&3 >/dev/null"));
  const auto report = [](const std::string&, double) { throw std::runtime_error("an error"); };
  EXPECT_THROW(static_cast<void>(process.ask({.kind = Frame::lobes, .report = report})), std::runtime_error);
  EXPECT_EQ(asked(process, {.kind = Frame::lobes}), "2");
}

TEST(WorkerProcess, EndsFromAnotherThread) {
  WorkerProcess process(shell("exec sleep 20"));
  std::thread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    process.end();
  });
  EXPECT_EQ(asked(process, {.kind = Frame::job}), "interrupted");
  later.join();
  EXPECT_EQ(asked(process, {.kind = Frame::job}), "interrupted");
}

TEST(WorkerProcess, GivesItNoSecretOfTheEnvironment) {
  const test::Folder place;
  ::setenv("SSH_AUTH_SOCK", "/run/agent", 1);
  ::setenv("LC_ROBOMILL_TEST", "C", 1);
  WorkerProcess process(shell("env > '" + place.at("seen.txt").string() + "'; exit 7"));
  EXPECT_NE(asked(process, {.kind = Frame::job}).find("exit code 7"), std::string::npos);
  ::unsetenv("SSH_AUTH_SOCK");
  ::unsetenv("LC_ROBOMILL_TEST");
  const std::string seen = io::read_file(place.at("seen.txt"));
  EXPECT_EQ(seen.find("/run/agent"), std::string::npos) << seen;
  EXPECT_NE(seen.find("LC_ROBOMILL_TEST=C"), std::string::npos) << seen;
}

TEST(WorkerRights, OpenNothingBesideTheFolder) {
  const test::Folder place;
  std::filesystem::create_directories(place.at("served"));
  const std::filesystem::path own = place.file("served/own.toml", "a = 1\n"),
                              beside = place.file("beside.toml", "b = 2\n");
  const auto opens = [](const std::filesystem::path& path) { return std::ifstream(path).good(); };
  ASSERT_TRUE(opens(beside) && opens("/etc/passwd"));
  for (const bool connects : {false, true}) {
    bool known = false;
    std::thread([&] {  // it alone is restricted
      known = io::restrict_files(file_rights_of_worker(place.at("served"), connects));
      if (!known) return;
      EXPECT_TRUE(opens(own));
      EXPECT_FALSE(opens(beside));
      EXPECT_EQ(opens("/etc/passwd"), connects);  // which is no secret; the system's settings are with it
      EXPECT_FALSE(opens("/proc/1/environ"));
    })
        .join();
    if (!known) GTEST_SKIP() << "this kernel has no Landlock";
  }
}

TEST(WorkerProcess, GivesItNoDescriptorBeside) {
  const test::Folder place;
  const std::ifstream open(place.file("held.txt", "x"));  // without O_CLOEXEC
  WorkerProcess process(shell("ls /proc/self/fd > '" + place.at("seen.txt").string() + "'; exit 7"));
  EXPECT_NE(asked(process, {.kind = Frame::job}).find("exit code 7"), std::string::npos);
  std::ifstream seen(place.at("seen.txt"));
  for (std::string descriptor; seen >> descriptor;) EXPECT_LE(std::stoi(descriptor), 4) << descriptor;
}

}  // namespace worker_process_test
}  // namespace robomill::serve
