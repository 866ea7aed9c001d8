// robomill serve as a user runs it: what becomes of its jobs, and of the processes that they run in.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/types.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "robomill/io/sample_source.hpp"
#include "robomill/io/system/sandbox.hpp"
#include "robomill/io/system/sanitized.hpp"
#include "test_program.hpp"
#include "testing/processes.hpp"
#include "testing/serve/http_client.hpp"
#include "testing/serve/slot.hpp"

namespace robomill::app {
namespace serve_jobs_test {

namespace fs = std::filesystem;
using nlohmann::json;
using test::slurp;
using test::wait_for;

/// A server of a folder with a lobes.toml that takes a moment and one that takes minutes.
class ServeJobs : public ProgramTest {
 protected:
  /// @param before  of the command
  void start(const std::vector<std::string>& more = {}, const std::vector<std::string>& before = {}) {
    fs::create_directories(folder_.at("served"));
    write("outside.toml", "[forty_two]\nforty_two = \"forty_two\"\n");
    write("served/lobes.toml", test::slot_lobes);
    std::string slow = test::slot_lobes;
    slow.replace(slow.find("[40, 30]"), 8, "[4000, 4000]");
    write("served/slow.toml", slow + "method = \"semi-discretization\"\noutput = \"map\"\n");
    std::vector<std::string> words = before;
    for (const char* word : {ROBOMILL_PROGRAM, "serve"}) words.emplace_back(word);
    for (const std::string& word : {folder_.at("served").string(), std::string("--port"), std::string("0")})
      words.push_back(word);
    words.insert(words.end(), more.begin(), more.end());
    server_ = std::make_unique<test::Process>(words, folder_.at("out.txt"), folder_.at("err.txt"));
    ASSERT_TRUE(wait_for([this] { return port() > 0; })) << slurp(folder_.at("err.txt"));
    const std::string page = test::http_ask(port(), "GET", "/").body;
    const std::size_t token = page.find("\"token\":\"") + 9;
    token_ = page.substr(token, page.find('"', token) - token);
  }
  [[nodiscard]] int port() const {
    const std::string said = slurp(folder_.at("out.txt"));
    const std::size_t at = said.find("http://127.0.0.1:");
    return at == std::string::npos || said.find("/\n", at) == std::string::npos ? 0 : std::stoi(said.substr(at + 17));
  }
  [[nodiscard]] test::HttpAnswer ask(const char* method, const std::string& path, const json& body = nullptr) const {
    return test::http_ask(port(), method, path, {{"X-Robomill-Token", token_}}, body.is_null() ? "" : body.dump());
  }
  [[nodiscard]] int run(const std::string& input, const std::string& output = {}) const {
    const test::HttpAnswer answer = ask("POST", "/api/jobs", {{"verb", "lobes"}, {"input", input}, {"output", output}});
    EXPECT_EQ(answer.status, 200) << answer.body;
    return json::parse(answer.body).value("id", 0);
  }
  [[nodiscard]] json job(int id) const { return json::parse(ask("GET", "/api/jobs/" + std::to_string(id)).body); }
  [[nodiscard]] bool works_on(int id) const { return job(id)["state"] == "running" && workers().size() == 1; }
  [[nodiscard]] json end_of(int id) const {
    json last;
    EXPECT_TRUE(wait_for([&] {
      last = job(id);
      return last["state"] != "queued" && last["state"] != "running";
    })) << last;
    return last;
  }
  /// Processes that work for the server.
  [[nodiscard]] std::vector<pid_t> workers() const {
    std::vector<pid_t> out;
    for (const pid_t process : processes()) {
      if (command_of(process).find("serve-worker") == std::string::npos) continue;
      if (command_of(parent_of(process)).find(folder_.path().string()) != std::string::npos) out.push_back(process);
    }
    return out;
  }
  static std::vector<pid_t> processes() {
    std::vector<pid_t> out;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator("/proc", ignored)) {
      const std::string name = entry.path().filename().string();
      pid_t process = 0;
      const auto read = std::from_chars(name.data(), name.data() + name.size(), process);
      if (read.ec == std::errc() && process > 0) out.push_back(process);
    }
    return out;
  }
  static std::string of_process(pid_t process, const char* what) {
    return slurp("/proc/" + std::to_string(process) + "/" + what);
  }
  static std::string command_of(pid_t process) {
    std::string words = of_process(process, "cmdline");
    std::ranges::replace(words, '\0', ' ');
    return words;
  }
  static pid_t parent_of(pid_t process) {
    const std::string status = of_process(process, "status");
    const std::size_t at = status.find("PPid:");
    return at == std::string::npos ? 0 : std::atoi(status.c_str() + at + 5);
  }

  std::string token_;
  std::unique_ptr<test::Process> server_;
};

TEST_F(ServeJobs, AProcessThatIsKilledIsAMessageOfItsJob) {
  start();
  for (const int number : {SIGKILL, SIGSEGV}) {
    if (number == SIGSEGV && io::sanitized) continue;  // which they report themselves, and exit
    const int id = run("slow.toml");
    ASSERT_TRUE(wait_for([&] { return works_on(id); })) << job(id);
    for (const pid_t worker : workers()) ::kill(worker, number);
    const json ended = end_of(id);
    EXPECT_EQ(ended["state"], "failed") << ended;
    EXPECT_EQ(ended["exit"], 1);
    EXPECT_NE(ended["error"]["text"].get<std::string>().find(number == SIGKILL ? "was killed" : "crashed (signal 11"),
              std::string::npos)
        << ended;
  }
  EXPECT_EQ(ask("GET", "/api/state").status, 200);
  const json next = end_of(run("lobes.toml", "out.json"));
  EXPECT_EQ(next["state"], "done") << next;
  EXPECT_TRUE(fs::exists(folder_.at("served/out.json")));
  EXPECT_TRUE(wait_for([&] { return workers().empty(); }));  // a job without a program leaves none
}

// An upgrade replaces the library while a server runs: a new process of the server runs from the one that it began
// with.
TEST_F(ServeJobs, AnUpgradeChangesNothingOfAServerThatRuns) {
  if (io::sanitized) GTEST_SKIP() << "AddressSanitizer insists on being loaded first";
  const fs::path library = folder_.at(fs::path(ROBOMILL_LIBRARY).filename().string());
  fs::copy_file(ROBOMILL_LIBRARY, library);
  start({}, {"/usr/bin/env", "LD_LIBRARY_PATH=" + folder_.path().string()});
  fs::remove(library);
  write(library.filename().string(), "no library\n");
  const json ended = end_of(run("lobes.toml", "out.json"));
  EXPECT_EQ(ended["state"], "done") << ended;
}

TEST_F(ServeJobs, ACancelledJobEndsWithItsProcess) {
  start();
  const int id = run("slow.toml", "out.json");
  ASSERT_TRUE(wait_for([&] { return works_on(id); })) << job(id);
  // One that does not listen is killed.
  for (const pid_t worker : workers()) ::kill(worker, SIGSTOP);
  EXPECT_EQ(ask("DELETE", "/api/jobs/" + std::to_string(id)).status, 200);
  EXPECT_EQ(end_of(id)["state"], "cancelled");
  EXPECT_TRUE(wait_for([&] { return workers().empty(); }));
  EXPECT_FALSE(fs::exists(folder_.at("served/out.json")));
}

TEST_F(ServeJobs, AJobHasItsOwnMemory) {
  if (io::sanitized) GTEST_SKIP() << "sanitized builds know no limit";
  start({"--job-memory-mb", "100", "--threads", "1"});
  const json rejected = end_of(run("slow.toml"));
  const std::string text = rejected["error"]["text"];
  EXPECT_NE(text.find("of memory, more than 100 MB"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("if it is meant, run it on the command line with --allow-large")) << text;
  // What no estimate foresees.
  std::string ones;
  for (int i = 0; i < 5'000'000; ++i) ones += "1,";
  write("served/long.toml", test::slot_lobes + std::string("ones = [") + ones + "]\n");
  const json ended = end_of(run("long.toml"));
  EXPECT_EQ(ended["state"], "failed") << ended;
  EXPECT_NE(ended["error"]["text"].get<std::string>().find("not enough memory"), std::string::npos) << ended;
  EXPECT_EQ(end_of(run("lobes.toml"))["state"], "done");
}

TEST_F(ServeJobs, LiveLobesSurviveTheirProcess) {
  start();
  int sequence = 0;
  const auto lobes = [&] {
    return ask("POST", "/api/lobes",
               {{"file", "lobes.toml"}, {"client", "c"}, {"channel", "l"}, {"sequence", ++sequence}});
  };
  const test::HttpAnswer first = lobes();
  ASSERT_EQ(first.status, 200) << first.body;
  ASSERT_EQ(workers().size(), 1U);
  const pid_t kept = workers().front();
  EXPECT_EQ(lobes().status, 200);
  EXPECT_EQ(workers(), std::vector<pid_t>{kept});  // the same one
  ::kill(kept, SIGKILL);
  ASSERT_TRUE(wait_for([&] { return lobes().status == 200; }));  // by another, once that one is gone
  ASSERT_EQ(workers().size(), 1U);
  EXPECT_NE(workers().front(), kept);
  // What a file says is checked in another.
  const test::HttpAnswer checked = ask("POST", "/api/check", {{"path", "a.toml"}, {"text", test::slot_lobes}});
  EXPECT_EQ(checked.status, 200) << checked.body;
  EXPECT_EQ(json::parse(checked.body)["kind"], "lobes");
  EXPECT_EQ(workers().size(), 2U);
  EXPECT_EQ(ask("POST", "/api/inspect", {{"path", "none.csv"}}).status, 400);
}

TEST_F(ServeJobs, SpindlesAreMonitoredInAProcessOfTheirOwn) {
  start();
  write("served/monitor.toml",
        "[signal]\nsample_rate_hz = 10240\nchannels = [\"ax_m_per_s2\"]\n[process]\nspindle_speed_rpm = 3000\n"
        "teeth = 2\n");
  std::vector<float> samples;
  for (int i = 0; i < 600 * 10'240; ++i) samples.push_back(static_cast<float>(std::sin(0.0307 * i)));
  io::write_wav(folder_.at("served/cut.wav"), samples, 1, 10'240.0);
  EXPECT_EQ(ask("GET", "/api/monitors").body, "[]\n");
  EXPECT_TRUE(workers().empty());  // none is needed for that
  const auto monitor = [&] {
    const test::HttpAnswer answer = ask("POST", "/api/monitors", {{"config", "monitor.toml"}, {"input", "cut.wav"}});
    EXPECT_EQ(answer.status, 200) << answer.body;
    return json::parse(answer.body).value("id", 0);
  };
  const auto spindle = [&](int id) { return json::parse(ask("GET", "/api/monitors/" + std::to_string(id)).body); };
  EXPECT_EQ(ask("POST", "/api/monitors", {{"config", "none.toml"}, {"input", "cut.wav"}}).status, 400);
  ASSERT_EQ(monitor(), 1);
  ASSERT_TRUE(wait_for([&] { return spindle(1)["decision_count"] > 0; })) << spindle(1);
  test::HttpConnection events(port());
  events.send(test::http_text(port(), "GET", "/api/events"));
  ASSERT_TRUE(events.wait_for("event: monitor\n"));  // its news come through
  ASSERT_EQ(workers().size(), 1U);
  ::kill(workers().front(), SIGKILL);
  ASSERT_TRUE(events.wait_for("event: monitors\n"));
  const json lost = spindle(1);
  EXPECT_EQ(lost["status"], "failed") << lost;
  EXPECT_NE(lost["error"]["text"].get<std::string>().find("was killed"), std::string::npos) << lost;
  EXPECT_EQ(lost["frames"], json::array());
  EXPECT_EQ(ask("GET", "/api/state").status, 200);
  // Another one has another process and another number.
  ASSERT_EQ(monitor(), 2);
  EXPECT_EQ(json::parse(ask("GET", "/api/monitors").body).size(), 2U);
  EXPECT_EQ(ask("DELETE", "/api/monitors/1").status, 200);
  const json left = json::parse(ask("GET", "/api/monitors").body);
  ASSERT_EQ(left.size(), 1U) << left;
  EXPECT_EQ(left[0]["id"], 2);
  EXPECT_EQ(json::parse(ask("DELETE", "/api/monitors/2").body), json::array());
  EXPECT_EQ(ask("GET", "/api/monitors/2").status, 404);
}

TEST_F(ServeJobs, AProcessThatHangsHoldsNothingUpThatAsksNone) {
  start();
  write("served/monitor.toml",
        "[signal]\nsample_rate_hz = 10240\nchannels = [\"ax_m_per_s2\"]\n[process]\nspindle_speed_rpm = 3000\n"
        "teeth = 2\n");
  io::write_wav(folder_.at("served/cut.wav"), std::vector<float>(1'024'000, 0.5F), 1, 10'240.0);
  const int id = run("slow.toml");
  ASSERT_TRUE(wait_for([&] { return works_on(id); })) << job(id);
  const pid_t of_job = workers().front();
  ASSERT_EQ(ask("POST", "/api/monitors", {{"config", "monitor.toml"}, {"input", "cut.wav"}}).status, 200);
  ASSERT_EQ(ask("POST", "/api/check", {{"path", "a.toml"}, {"text", test::slot_lobes}}).status, 200);
  std::vector<pid_t> hanging = workers();
  ASSERT_EQ(hanging.size(), 3U);
  std::erase(hanging, of_job);
  for (const pid_t worker : hanging) ::kill(worker, SIGSTOP);
  test::HttpConnection monitors(port()), check(port());
  monitors.send(test::http_text(port(), "GET", "/api/monitors"));
  check.send(test::http_text(port(), "POST", "/api/check", {{"X-Robomill-Token", token_}},
                             json{{"path", "a.toml"}, {"text", test::slot_lobes}}.dump()));
  EXPECT_FALSE(monitors.wait_for("HTTP", 0.2));  // it was asked, and waits
  EXPECT_EQ(ask("GET", "/api/state").status, 200);
  EXPECT_EQ(ask("DELETE", "/api/jobs/" + std::to_string(id)).status, 200);
  EXPECT_EQ(end_of(id)["state"], "cancelled");
  EXPECT_FALSE(monitors.wait_for("HTTP", 0.1));  // nothing waited for it
  for (const pid_t worker : hanging) ::kill(worker, SIGCONT);
  EXPECT_NE(monitors.answer().status, 0);
  EXPECT_NE(check.answer().status, 0);
}

TEST_F(ServeJobs, WorkersEndWithTheServer) {
  start();
  const int id = run("slow.toml");
  ASSERT_TRUE(wait_for([&] { return works_on(id); })) << job(id);
  const std::vector<pid_t> working = workers();
  ASSERT_EQ(working.size(), 1U);
  server_->signal(SIGKILL);
  server_->wait();
  EXPECT_TRUE(wait_for([&] { return command_of(working.front()).find("serve-worker") == std::string::npos; }));
}

TEST_F(ServeJobs, OpenNothingOutside) {
  bool known = false;
  std::thread([&] { known = io::restrict_files({}); }).join();
  if (!known) GTEST_SKIP() << "this kernel has no Landlock";
  start();
  EXPECT_EQ(slurp(folder_.at("out.txt")).find("Landlock"), std::string::npos);
  const int id = run("slow.toml");
  ASSERT_TRUE(wait_for([&] { return works_on(id); })) << job(id);
  const pid_t worker = workers().front();
  EXPECT_TRUE(wait_for([&] {  // what restricts itself says so first
    return of_process(worker, "status").find("NoNewPrivs:\t1") != std::string::npos;
  }));
  EXPECT_NE(of_process(parent_of(worker), "status").find("NoNewPrivs:\t1"), std::string::npos);
  write("served/away.toml", std::string("[job]\nmodes = \"../outside.toml\"\nlobes = \"lobes.toml\"\n"));
  EXPECT_EQ(ask("DELETE", "/api/jobs/" + std::to_string(id)).status, 200);
  const test::HttpAnswer away = ask("POST", "/api/jobs", {{"verb", "plan"}, {"input", "away.toml"}});
  const json ended = end_of(json::parse(away.body).value("id", 0));
  EXPECT_EQ(ended["state"], "failed");
  EXPECT_EQ(ended.dump().find("forty_two"), std::string::npos) << ended;
  EXPECT_EQ(ended.dump().find(folder_.path().string()), std::string::npos) << ended;
}

TEST_F(ServeJobs, TheTokenMayStandInAFile) {
  fs::create_directories(folder_.at("served"));
  write("token.txt", "abcdefghijklmnop\n");
  write("short.txt", "abc\n");
  for (const char* wrong :
       {"--token-file none.txt", "--token-file short.txt", "--token-file token.txt --token abcdefghijklmnop"}) {
    EXPECT_NE(robomill(std::string("serve served --port 0 ") + wrong).exit, 0) << wrong;
  }
  server_ =
      std::make_unique<test::Process>(std::vector<std::string>{ROBOMILL_PROGRAM, "serve", folder_.at("served"),
                                                               "--port", "0", "--token-file", folder_.at("token.txt")},
                                      folder_.at("out.txt"), folder_.at("err.txt"));
  ASSERT_TRUE(wait_for([this] { return slurp(folder_.at("out.txt")).find("\n") != std::string::npos; }));
  const std::string said = slurp(folder_.at("out.txt"));
  const std::string address = "http://127.0.0.1:";
  ASSERT_EQ(said.find(address), 0U) << said;
  EXPECT_NE(said.find("/?token=abcdefghijklmnop\n"), std::string::npos) << said;
  const int at = std::stoi(said.substr(address.size()));
  EXPECT_EQ(test::http_ask(at, "GET", "/api/state").status, 401);
  EXPECT_EQ(test::http_ask(at, "GET", "/api/state", {{"Authorization", "Bearer abcdefghijklmnop"}}).status, 200);
}

TEST_F(ServeJobs, TheWorkerIsNoVerb) {
  EXPECT_EQ(robomill("serve-worker").exit, 2);
  EXPECT_EQ(robomill("--help").out.find("serve-worker"), std::string::npos);
  EXPECT_NE(robomill("serve --job-memory-mb 1").exit, 0);
}

}  // namespace serve_jobs_test
}  // namespace robomill::app
