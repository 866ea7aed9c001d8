#include "robomill/serve/serve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "testing/serve/http_client.hpp"
#include "testing/serve/slot.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace serve_test {

namespace fs = std::filesystem;
using nlohmann::json;
using test::HttpAnswer;
using test::HttpConnection;
using test::HttpHeaders;
using test::rejection;

/// A server of a folder with the first example, and a page of it.
class Serve : public ::testing::Test {
 protected:
  Serve() {
    fs::create_directories(place_.at("served"));
    place_.file("outside.toml", "[tool]\nteeth = 42\n");
    place_.file("served/lobes.toml", lobes);
    // A job brings its own structure.
    std::string cut = lobes;
    cut.erase(cut.find("[dynamics]"), cut.find("[lobes]") - cut.find("[dynamics]"));
    place_.file("served/cut.toml", cut);
    place_.file("served/modes.json", modes);
    place_.file("served/job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"cut.toml\"\n");
    server_ = std::make_unique<Server>(ServeOptions{.folder = place_.at("served"), .port = 0});
    const std::string page = ask("GET", "/").body;
    const std::string mark = "id=\"serve-config\">";
    const std::size_t begin = page.find(mark) + mark.size();
    token_ = json::parse(page.substr(begin, page.find("</script>", begin) - begin)).at("token");
  }
  [[nodiscard]] HttpAnswer ask(std::string_view method, std::string_view target, std::string_view body = {},
                               HttpHeaders headers = {}) const {
    if (method != "GET") headers.emplace_back("X-Robomill-Token", token_);
    return test::http_ask(server_->port(), method, target, headers, body);
  }
  [[nodiscard]] json get(std::string_view target) const {
    const HttpAnswer answer = ask("GET", target);
    EXPECT_EQ(answer.status, 200) << answer.body;
    return json::parse(answer.body);
  }
  json post(std::string_view target, const json& body, int status = 200) const {
    const HttpAnswer answer = ask("POST", target, body.dump());
    EXPECT_EQ(answer.status, status) << answer.body;
    return json::parse(answer.body);
  }
  /// Minutes, unless it is stopped.
  void write_slow_job() const {
    std::string slow = lobes;
    slow.erase(slow.find("[dynamics]"), slow.find("[lobes]") - slow.find("[dynamics]"));
    slow.replace(slow.find("[40, 30]"), 8, "[4000, 4000]");
    place_.file("served/slow.toml", slow + "method = \"semi-discretization\"\noutput = \"map\"\n");
    place_.file("served/slow-job.toml", "[job]\nmodes = \"modes.json\"\nlobes = \"slow.toml\"\n");
  }
  /// A job once it has one of these states; as it is after minutes.
  [[nodiscard]] json wait_for_state(int id, const std::vector<std::string>& states) const {
    json job;
    for (int tries = 0; tries < 30'000; ++tries) {
      job = get("/api/jobs/" + std::to_string(id));
      if (std::ranges::find(states, job["state"].get<std::string>()) != states.end()) return job;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    ADD_FAILURE() << job;
    return job;
  }
  [[nodiscard]] json wait_for_end(int id) const { return wait_for_state(id, {"done", "failed", "cancelled"}); }

  static constexpr const char* lobes = test::slot_lobes;
  /// 900 and 950 Hz, 2 %, 0.1 kg, in x and in y.
  static constexpr const char* modes = R"({"modes":[
{"frequency_hz":900,"damping_ratio":0.02,"left":{"x":[1,0],"y":[0,0]},"right":{"x":[0,-8.8437e-4],"y":[0,0]}},
{"frequency_hz":950,"damping_ratio":0.02,"left":{"x":[0,0],"y":[1,0]},"right":{"x":[0,0],"y":[0,-8.3782e-4]}}]})";
  test::Folder place_;
  std::unique_ptr<Server> server_;
  std::string token_;
};

TEST_F(Serve, StateListsTheFolder) {
  const json state = get("/api/state");
  EXPECT_EQ(state["folder"], "served");
  bool found = false;
  for (const json& file : state["files"]) {
    if (file["path"] == "job.toml") found = file["kind"] == "job" && file["bytes"] > 0;
  }
  EXPECT_TRUE(found);
  const HttpAnswer page = ask("GET", "/");
  EXPECT_NE(page.headers.at("content-security-policy").find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page.headers.at("x-content-type-options"), "nosniff");
  EXPECT_EQ(ask("GET", "/page.css").status, 200);
  EXPECT_EQ(ask("GET", "/nothing").status, 404);
  EXPECT_EQ(ask("POST", "/api/state", "{}").status, 405);
  EXPECT_EQ(ask("DELETE", "/", "{}").status, 405);
}

TEST_F(Serve, GivesTheOverviewOfAJobBeforeAndAfterItsRun) {
  const auto stage = [&](const char* name) {
    const json overview = get("/api/overview?file=job.toml");
    for (const json& one : overview["stages"]) {
      if (one["stage"] == name) return one;
    }
    return json();
  };
  EXPECT_EQ(stage("modes")["says"], "2 modes");
  EXPECT_EQ(stage("decision")["state"], "ready");
  EXPECT_EQ(stage("decision")["next"]["does"], "run");
  const int id = post("/api/jobs", {{"verb", "plan"}, {"input", "job.toml"}, {"output", "far/away"}})["id"];
  EXPECT_EQ(wait_for_end(id)["state"], "done");
  EXPECT_EQ(get("/api/overview?file=job.toml")["results"], "far/away");
  EXPECT_NE(stage("decision")["state"], "ready");
  EXPECT_EQ(ask("GET", "/api/overview").status, 400);
  EXPECT_EQ(ask("GET", "/api/overview?file=none.toml").status, 404);
  EXPECT_EQ(ask("GET", "/api/overview?file=../outside.toml").status, 400);
}

TEST_F(Serve, ReadsAndWritesFiles) {
  const HttpAnswer read = ask("GET", "/api/file?path=lobes.toml");
  EXPECT_EQ(read.body, lobes);
  const std::string tag = read.headers.at("etag");
  EXPECT_EQ(ask("PUT", "/api/file?path=lobes.toml", "new").status, 400);  // of which version?
  EXPECT_EQ(ask("PUT", "/api/file?path=lobes.toml", "new", {{"If-Match", "\"other\""}}).status, 409);
  EXPECT_EQ(ask("PUT", "/api/file?path=lobes.toml", "new", {{"If-None-Match", "*"}}).status, 409);
  EXPECT_EQ(ask("GET", "/api/file?path=lobes.toml").body, lobes);
  EXPECT_EQ(ask("PUT", "/api/file?path=lobes.toml", "new", {{"If-Match", tag}}).status, 200);
  EXPECT_EQ(ask("GET", "/api/file?path=lobes.toml").body, "new");
  EXPECT_EQ(ask("PUT", "/api/file?path=in/a.csv", "1,2", {{"If-None-Match", "*"}}).status, 200);
  EXPECT_EQ(ask("GET", "/api/file?path=in%2Fa.csv").body, "1,2");
  EXPECT_EQ(ask("GET", "/api/file").status, 400);
}

TEST_F(Serve, FilesAreMissingOrTooLongToShow) {
  EXPECT_EQ(ask("GET", "/api/file?path=none.toml").status, 404);
  EXPECT_EQ(ask("GET", "/api/file?path=" + std::string(300, 'a')).status, 400);
  const std::string rows(std::size_t{5} << 20, '1');
  const HttpAnswer made = ask("PUT", "/api/file?path=long.csv", rows, {{"If-None-Match", "*"}});
  EXPECT_EQ(made.status, 200);
  const HttpAnswer read = ask("GET", "/api/file?path=long.csv");
  EXPECT_EQ(read.status, 413);
  EXPECT_EQ(json(read.headers.at("etag")), json::parse(made.body)["etag"]);
  EXPECT_EQ(ask("PUT", "/api/file?path=long.csv", "1,2", {{"If-Match", "\"other\""}}).status, 409);
  EXPECT_EQ(ask("PUT", "/api/file?path=long.csv", "1,2", {{"If-Match", read.headers.at("etag")}}).status, 200);
  EXPECT_EQ(ask("GET", "/api/file?path=long.csv").body, "1,2");
}

TEST_F(Serve, ChecksAndEditsTexts) {
  json answer = post("/api/check", {{"path", "lobes.toml"}, {"text", lobes}});
  EXPECT_EQ(answer["kind"], "lobes");
  EXPECT_TRUE(answer["error"].is_null()) << answer;
  bool found = false;
  for (const json& field : answer["fields"]) {
    if (field["key"] == "tool.teeth") found = field["value"] == 2 && field["line"] == 3 && field["comment"] == "edges";
  }
  EXPECT_TRUE(found);
  const std::string text = post("/api/edit", {{"text", lobes}, {"key", "tool.teeth"}, {"value", 0}})["text"];
  answer = post("/api/check", {{"path", "lobes.toml"}, {"text", text}});
  EXPECT_EQ(answer["error"]["field"], "tool.teeth");
  EXPECT_EQ(answer["error"]["line"], 3);
  EXPECT_EQ(answer["error"]["file"], "lobes.toml");
  answer = post("/api/check", {{"path", "lobes.toml"}, {"text", "a = "}});
  EXPECT_EQ(answer["error"]["line"], 1);
  post("/api/check", json::object(), 400);
  EXPECT_EQ(ask("POST", "/api/check", "{").status, 400);
  // Nothing of it was saved.
  EXPECT_EQ(ask("GET", "/api/file?path=lobes.toml").body, lobes);
}

TEST_F(Serve, SaysThatItsFolderIsGone) {
  fs::remove_all(place_.at("served"));
  const HttpAnswer state = ask("GET", "/api/state");
  EXPECT_EQ(state.status, 400);
  EXPECT_NE(state.body.find("the folder that is served is gone"), std::string::npos) << state.body;
  // Nothing is made in its place.
  EXPECT_EQ(ask("PUT", "/api/file?path=new.csv", "1,2", {{"If-None-Match", "*"}}).status, 400);
  post("/api/jobs", {{"input", "job.toml"}, {"output", "out"}}, 400);
  for (const char* path : {"/api/check", "/api/inspect", "/api/lobes", "/api/tap", "/api/tap/save", "/api/monitors"}) {
    const HttpAnswer answer = ask("POST", path, "{}");
    EXPECT_EQ(answer.status, 400) << path;
    EXPECT_NE(answer.body.find("the folder that is served is gone"), std::string::npos) << path << answer.body;
  }
  EXPECT_NE(ask("GET", "/api/file?path=job.toml").body.find("is gone"), std::string::npos);
  EXPECT_EQ(ask("GET", "/api/jobs").status, 200);
  EXPECT_FALSE(fs::exists(place_.at("served")));
}

TEST_F(Serve, SaysNoAbsolutePaths) {
  const json job = wait_for_end(post("/api/jobs", {{"verb", "plan"}, {"input", "job.toml"}, {"output", "out"}})["id"]);
  ASSERT_EQ(job["state"], "done") << job;
  const std::string folder = fs::canonical(place_.path()).string();
  EXPECT_EQ(job.dump().find(folder), std::string::npos) << job;
  EXPECT_NE(job["summary"].get<std::string>().find('\n'), std::string::npos) << job;
  EXPECT_EQ(ask("GET", "/api/jobs/" + job["id"].dump() + "/report").body.find(folder + "/"), std::string::npos);
}

TEST_F(Serve, ReadsNothingOutside) {
  for (const char* path : {"../outside.toml", "%2e%2e%2foutside.toml", "/etc/passwd", "a/../../outside.toml"}) {
    const HttpAnswer answer = ask("GET", std::string("/api/file?path=") + path);
    EXPECT_EQ(answer.status, 400) << path;
    EXPECT_EQ(answer.body.find("42"), std::string::npos);
  }
  // Nor what a document inside names.
  const std::string job = "[job]\nmodes = \"../outside.toml\"\nlobes = \"cut.toml\"\n";
  EXPECT_EQ(ask("PUT", "/api/file?path=away.toml", job, {{"If-None-Match", "*"}}).status, 200);
  const json ended = wait_for_end(post("/api/jobs", {{"verb", "plan"}, {"input", "away.toml"}})["id"]);
  EXPECT_EQ(ended["state"], "failed");
  EXPECT_NE(ended["error"]["text"].get<std::string>().find("outside the folder"), std::string::npos) << ended;
  // No way leads into a message.
  EXPECT_EQ(ended.dump().find(place_.path().string()), std::string::npos) << ended;
}

TEST_F(Serve, RunsAJobAndKeepsItsReport) {
  HttpConnection events(server_->port());
  events.send(test::http_text(server_->port(), "GET", "/api/events"));
  ASSERT_TRUE(events.wait_for("text/event-stream"));
  const int id = post("/api/jobs", {{"verb", "plan"}, {"input", "job.toml"}, {"output", "out"}})["id"];
  const json job = wait_for_end(id);
  EXPECT_EQ(job["state"], "done") << job;
  EXPECT_EQ(job["exit"], 0);
  EXPECT_TRUE(job["report"]);
  EXPECT_TRUE(events.wait_for("\"state\":\"done\""));
  EXPECT_TRUE(events.wait_for("event: files"));
  EXPECT_FALSE(get("/api/jobs/" + std::to_string(id) + "/report")["lobes"].is_null());
  EXPECT_TRUE(fs::exists(place_.at("served/out/report.html")));
  EXPECT_EQ(ask("GET", "/api/jobs/99").status, 404);
  EXPECT_EQ(ask("GET", "/api/jobs/x").status, 404);
  post("/api/jobs", {{"verb", "rm"}, {"input", "job.toml"}}, 400);
  post("/api/jobs", {{"verb", "plan"}, {"input", "../job.toml"}}, 400);
  post("/api/jobs", {{"verb", "plan"}, {"input", "job.toml"}, {"output", "../out"}}, 400);
  const json failed = wait_for_end(post("/api/jobs", {{"input", "none.toml"}})["id"]);
  EXPECT_EQ(failed["exit"], 1);
  EXPECT_NE(failed["error"]["text"].get<std::string>().find("no such file"), std::string::npos);
}

TEST_F(Serve, RunsOtherVerbsWithTheirOptions) {
  bool listed = false;
  for (const json& verb : get("/api/verbs"))
    listed = listed || (verb["verb"] == "simulate" && verb["output"] == "vibration.csv");
  EXPECT_TRUE(listed);
  const json body = {{"verb", "simulate"},
                     {"input", {"lobes.toml"}},
                     {"output", "out/vibration.csv"},
                     {"options", {{"at", {9000, 0.1}}, {"seconds", 0.2}}}};
  const json job = wait_for_end(post("/api/jobs", body)["id"]);
  EXPECT_EQ(job["state"], "done") << job;
  EXPECT_EQ(job["verb"], "simulate");
  EXPECT_EQ(job["input"], "lobes.toml");
  EXPECT_EQ(job["inputs"], json({"lobes.toml"}));
  EXPECT_EQ(job["options"]["at"], json({9000, 0.1}));
  EXPECT_FALSE(get("/api/jobs/" + std::to_string(job["id"].get<int>()) + "/report")["simulation"].is_null());
  const json state = get("/api/state");
  for (const json& file : state["files"]) {
    const bool vibration = file["path"] == "out/vibration.csv";
    EXPECT_EQ(file["document"], vibration ? json("vibration") : json(nullptr)) << file;
  }
  json wrong = body;
  wrong["options"]["seconds"] = 0;
  EXPECT_EQ(post("/api/jobs", wrong, 400)["error"]["field"], "options.seconds");
  wrong = body;
  wrong["input"] = 3;
  EXPECT_EQ(post("/api/jobs", wrong, 400)["error"]["field"], "input");
  wrong = body;
  wrong["output"] = "lobes.toml";
  EXPECT_NE(
      post("/api/jobs", wrong, 400)["error"]["text"].get<std::string>().find("lobes.toml: a simulation is written"),
      std::string::npos);
  // Done, but without its answer: a list of tools of which one has none.
  place_.file(
      "served/assembly.toml",
      "[frequency]\nrange_hz = [200, 3000]\nstep_hz = 20\n[[tool]]\nlength_mm = 60\ndiameter_mm = 12\n"
      "youngs_modulus_gpa = 580\ndensity_kg_per_m3 = 14400\nloss_factor = 0.02\n[holder]\nsegments = [{ length_mm "
      "= 40, diameter_mm = 28, youngs_modulus_gpa = 205, density_kg_per_m3 = 7850 }]\n");
  place_.file("served/tools.csv", "tool,length_mm,diameter_mm,teeth\nthick,50,12,2\nthin,50,6,2\n");
  std::string cut = lobes;
  cut.replace(cut.find("direction = \"slot\""), 18, "direction = \"up\"\nradial_depth_mm = 8");
  place_.file("served/wide.toml", cut);
  const json tools =
      wait_for_end(post("/api/jobs", {{"verb", "couple --tools"},
                                      {"input", "assembly.toml"},
                                      {"options", {{"tools", "tools.csv"}, {"lobes", "wide.toml"}}}})["id"]);
  EXPECT_EQ(tools["exit"], 3) << tools;
  EXPECT_EQ(tools["shortfall"], "not every tool has a result; its row says why");
  EXPECT_TRUE(tools["report"]);
}

TEST_F(Serve, CancelsJobsAndBoundsTheirQueue) {
  write_slow_job();
  std::vector<int> ids;
  int rejected = 0;
  for (int i = 0; i < 12; ++i) {
    const HttpAnswer answer = ask("POST", "/api/jobs", R"({"input":"slow-job.toml"})");
    if (answer.status == 200) {
      ids.push_back(json::parse(answer.body)["id"]);
    } else {
      EXPECT_EQ(answer.status, 429);
      ++rejected;
    }
  }
  EXPECT_EQ(ids.size(), 5U);  // one runs, four wait
  EXPECT_EQ(rejected, 7);
  EXPECT_EQ(wait_for_state(ids.front(), {"running"})["state"], "running");
  // One that is cancelled while it waits never runs, and gives its place to another.
  HttpConnection events(server_->port());
  events.send(test::http_text(server_->port(), "GET", "/api/events"));
  ASSERT_TRUE(events.wait_for("text/event-stream"));
  EXPECT_EQ(json::parse(ask("DELETE", "/api/jobs/" + std::to_string(ids[1])).body)["state"], "cancelled");
  ids.push_back(post("/api/jobs", {{"input", "slow-job.toml"}})["id"]);
  EXPECT_EQ(ask("POST", "/api/jobs", R"({"input":"slow-job.toml"})").status, 429);
  // An address of the report's is not the job's.
  const std::string first = "/api/jobs/" + std::to_string(ids.front());
  EXPECT_EQ(ask("DELETE", first + "/report").status, 404);
  EXPECT_EQ(ask("DELETE", first + "/").status, 404);
  EXPECT_EQ(ask("GET", first + "/report/report").status, 404);
  EXPECT_EQ(get(first)["state"], "running");
  for (const int id : ids) EXPECT_EQ(ask("DELETE", "/api/jobs/" + std::to_string(id)).status, 200);
  for (const int id : ids) EXPECT_EQ(wait_for_end(id)["state"], "cancelled");
  EXPECT_TRUE(get("/api/jobs/" + std::to_string(ids[1]))["seconds"].is_null());
  ASSERT_TRUE(events.wait_for("\"id\":" + std::to_string(ids.back())));
  int told = 0;
  std::istringstream lines(events.got());
  for (std::string line; std::getline(lines, line);) {
    const json job = line.starts_with("data: {\"id\"") ? json::parse(line.substr(6), nullptr, false) : json();
    if (!job.is_object() || job["id"] != ids[1]) continue;
    ++told;
    EXPECT_EQ(job["state"], "cancelled") << job;
  }
  EXPECT_GT(told, 0);
}

TEST_F(Serve, EndsWithAJobRunning) {
  write_slow_job();
  const int id = post("/api/jobs", {{"input", "slow-job.toml"}})["id"];
  EXPECT_EQ(wait_for_state(id, {"running"})["state"], "running");
  const int port = server_->port();
  server_.reset();
  EXPECT_FALSE(HttpConnection(port).is_open());
}

TEST_F(Serve, ASecondServerLeavesTheFirstItsBounds) {
  fs::create_symlink(place_.at("outside.toml"), place_.at("served/link.toml"));
  for (const int port : {0, server_->port()}) {
    EXPECT_NE(rejection([&] { const Server second({.folder = place_.path(), .port = port}); }).find("at a time"),
              std::string::npos);
  }
  EXPECT_EQ(ask("GET", "/api/file?path=link.toml").status, 400);
}

TEST(ServeTest, SaysThatAPortIsTaken) {
  const test::Folder place;
  const int taken = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  ASSERT_EQ(::bind(taken, reinterpret_cast<const sockaddr*>(&address), length), 0);
  ASSERT_EQ(::listen(taken, 1), 0);
  ASSERT_EQ(::getsockname(taken, reinterpret_cast<sockaddr*>(&address), &length), 0);
  const ServeOptions options = {.folder = place.path(), .port = ntohs(address.sin_port)};
  EXPECT_NE(rejection([&] { const Server server(options); }).find("Is the port taken"), std::string::npos);
  ::close(taken);
  const Server server({.folder = place.path(), .port = 0});  // the bounds are free again
}

TEST(ServeTest, LocalhostIsThisMachine) {
  const test::Folder place;
  const Server server({.folder = place.path(), .host = "localhost", .port = 0});
  EXPECT_EQ(server.address(), "http://127.0.0.1:" + std::to_string(server.port()) + "/");
  EXPECT_EQ(test::http_ask(server.port(), "GET", "/").status, 200);
}

TEST(ServeOptionsTest, OtherMachinesNeedAToken) {
  const test::Folder place;
  EXPECT_NE(rejection([&] {
              const Server server({.folder = place.path(), .host = "0.0.0.0", .port = 0});
            }).find("needs a token"),
            std::string::npos);
  EXPECT_NE(
      rejection([&] { const Server server({.folder = place.path(), .port = 0, .token = "short"}); }).find("16 or more"),
      std::string::npos);
  EXPECT_NE(rejection([&] { const Server server({.folder = place.at("none"), .port = 0}); }).find("no such folder"),
            std::string::npos);
  EXPECT_NE(
      rejection([&] {
        const Server server({.folder = place.path(), .host = "mill.local", .port = 0, .token = "abcdefghijklmnop"});
      }).find("host = mill.local; must be an address of this machine, as 127.0.0.1, or localhost"),
      std::string::npos);
  {
    const Server here({.folder = place.path(), .host = "localhost", .port = 0});
    EXPECT_EQ(here.address(), "http://127.0.0.1:" + std::to_string(here.port()) + "/");
    EXPECT_EQ(test::http_ask(here.port(), "GET", "/").status, 200);
  }
  const Server server({.folder = place.path(), .port = 0, .token = "abcdefghijklmnop"});
  EXPECT_EQ(test::http_ask(server.port(), "GET", "/").status, 401);
  const HttpAnswer first = test::http_ask(server.port(), "GET", "/?token=abcdefghijklmnop");
  EXPECT_EQ(first.status, 303);
  const std::string cookie = "robomill-" + std::to_string(server.port()) + "=abcdefghijklmnop";
  EXPECT_EQ(test::http_ask(server.port(), "GET", "/", {{"Cookie", cookie}}).status, 200);
}

}  // namespace serve_test
}  // namespace robomill::serve
