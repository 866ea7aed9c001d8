#include "robomill/serve/serve.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "testing/serve/http_client.hpp"
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
  [[nodiscard]] json wait_for_end(int id) const {
    for (;;) {
      json job = get("/api/jobs/" + std::to_string(id));
      if (job["state"] != "queued" && job["state"] != "running") return job;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

  static constexpr const char* lobes = R"(# a slot
[tool]
teeth = 2           # edges
diameter_mm = 10
[cut]
direction = "slot"
feed_per_tooth_mm = 0.05
[coefficients]
tangential_n_per_mm2 = 700
radial_n_per_mm2 = 200
[dynamics]
x = [{ frequency_hz = 900, damping_ratio = 0.02, modal_mass_kg = 0.1 }]
y = [{ frequency_hz = 950, damping_ratio = 0.02, modal_mass_kg = 0.1 }]
[lobes]
spindle_speed_rpm = [6000, 18000]
axial_depth_mm = [0, 3]
grid = [40, 30]
)";
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
  EXPECT_GE(rejected, 7);
  for (const int id : ids) EXPECT_EQ(ask("DELETE", "/api/jobs/" + std::to_string(id)).status, 200);
  for (const int id : ids) EXPECT_EQ(wait_for_end(id)["state"], "cancelled");
}

TEST_F(Serve, EndsWithAJobRunning) {
  write_slow_job();
  const int id = post("/api/jobs", {{"input", "slow-job.toml"}})["id"];
  while (get("/api/jobs/" + std::to_string(id))["state"] == "queued") std::this_thread::yield();
  server_.reset();
  EXPECT_FALSE(HttpConnection(1).is_open());
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
        const Server server({.folder = place.path(), .host = "localhost", .port = 0, .token = "abcdefghijklmnop"});
      }).find("must be an address"),
      std::string::npos);
  const Server server({.folder = place.path(), .port = 0, .token = "abcdefghijklmnop"});
  EXPECT_EQ(test::http_ask(server.port(), "GET", "/").status, 401);
  const HttpAnswer first = test::http_ask(server.port(), "GET", "/?token=abcdefghijklmnop");
  EXPECT_EQ(first.status, 303);
  EXPECT_EQ(test::http_ask(server.port(), "GET", "/", {{"Cookie", "robomill=abcdefghijklmnop"}}).status, 200);
  const ServeOptions same = {.folder = place.path(), .port = server.port()};
  EXPECT_NE(rejection([&] { const Server second(same); }).find("Is the port taken"), std::string::npos);
}

}  // namespace serve_test
}  // namespace robomill::serve
