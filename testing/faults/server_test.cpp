// A server whose disk fails, or that is killed, while it replaces a file: the file is whole, and no failure looks like
// success.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "robomill/base/random.hpp"
#include "testing/faults/run.hpp"
#include "testing/processes.hpp"
#include "testing/serve/http_client.hpp"
#include "testing/support.hpp"

namespace robomill::faults {
namespace server_test {

class ServerFaults : public testing::Test {
 protected:
  void start(const Fault& fault) {
    restore(place_.folder(), {{"notes.toml", content('a')}});
    server_ = std::make_unique<test::Process>(place_.words("serve . --port 0", fault, false), folder_.at("out.txt"),
                                              folder_.at("err.txt"));
    ASSERT_TRUE(test::wait_for([this] { return port() > 0; })) << test::slurp(folder_.at("err.txt"));
    port_ = port();
    const std::string page = test::http_ask(port_, "GET", "/").body;
    const std::size_t token = page.find("\"token\":\"") + 9;
    token_ = page.substr(token, page.find('"', token) - token);
  }
  [[nodiscard]] int port() const {
    const std::string said = test::slurp(folder_.at("out.txt"));
    const std::size_t at = said.find("http://127.0.0.1:");
    return at == std::string::npos || said.find("/\n", at) == std::string::npos ? 0 : std::stoi(said.substr(at + 17));
  }
  [[nodiscard]] test::HttpAnswer put(char letter) const {
    test::HttpAnswer seen = test::http_ask(port_, "GET", "/api/file?path=notes.toml");
    return test::http_ask(port_, "PUT", "/api/file?path=notes.toml",
                          {{"X-Robomill-Token", token_}, {"If-Match", seen.headers["etag"]}}, content(letter));
  }
  /// A megabyte of one letter.
  static std::string content(char letter) { return "# " + std::string(900'000, letter) + "\n"; }

  test::Folder folder_;
  Place place_{{.robomill = ROBOMILL_PROGRAM, .shim = ROBOMILL_FAULT_SHIM}, folder_.path()};
  std::unique_ptr<test::Process> server_;
  int port_ = 0;
  std::string token_;
};

TEST_F(ServerFaults, KilledLeavesWholeFiles) {
  Random random(9);
  int replaced = 0;
  for (int turn = 0; turn < test::seeds(100); ++turn) {
    start({});
    if (HasFatalFailure()) return;
    std::atomic<int> taken{0};
    std::jthread client([&](const std::stop_token& stop) {
      while (!stop.stop_requested() && put(static_cast<char>('b' + taken % 25)).status == 200) ++taken;
    });
    std::this_thread::sleep_for(std::chrono::duration<double>(0.02 + 0.1 * random.uniform()));
    server_->signal(SIGKILL);
    (void)server_->wait();
    client.request_stop();
    client.join();
    const std::string now = test::slurp(place_.folder() / "notes.toml");
    ASSERT_EQ(now.size(), content('a').size()) << "after " << taken;
    EXPECT_EQ(now, content(now[2]));
    replaced += taken;
  }
  EXPECT_GT(replaced, 0);
}

// Only faults of writing: the server looks at its folder at times of its own.
TEST_F(ServerFaults, NoFailureLooksLikeSuccess) {
  for (const Kind kind : {Kind::no_space, Kind::disk_full, Kind::short_write}) {
    const std::string name = kind_names.at(static_cast<std::size_t>(kind));
    const std::uint64_t step = test::seeds(10) == 10 ? 1 : 2;
    for (std::uint64_t n = 1; n < 100; n += step) {
      start({kind, n});
      if (HasFatalFailure()) return;
      const test::HttpAnswer answer = put('b');
      const bool reached = place_.counted().reached;
      const bool is_new = test::slurp(place_.folder() / "notes.toml") == content('b');
      EXPECT_TRUE(is_new || test::slurp(place_.folder() / "notes.toml") == content('a')) << name << " at call " << n;
      EXPECT_TRUE(is_new || answer.status != 200) << name << " at call " << n;
      EXPECT_TRUE(answer.status == 200 || answer.body.find("\"error\"") != std::string::npos)
          << name << " at call " << n << ": " << answer.status << " " << answer.body;
      if (kind == Kind::short_write || !reached) {
        EXPECT_EQ(answer.status, 200) << answer.body;
      }
      EXPECT_EQ(files_of(place_.folder()).size(), 1U) << name << " at call " << n;
      if (kind != Kind::disk_full && reached) {
        const test::HttpAnswer next = put('c');
        EXPECT_EQ(next.status, 200) << name << " at call " << n << ", the next one: " << next.body;
      }
      if (!reached) break;
    }
  }
}

}  // namespace server_test
}  // namespace robomill::faults
