#include "robomill/serve/program/live_program.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "robomill/io/file.hpp"
#include "robomill/serve/jobs/runner.hpp"
#include "robomill/serve/jobs/verbs.hpp"
#include "robomill/serve/serve.hpp"
#include "testing/jobs/program_files.hpp"
#include "testing/serve/http_client.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace live_program_test {

using nlohmann::json;
using test::rejection;

/// A folder with a job that judges three blocks, and one that has no program.
class LiveProgram : public ::testing::Test {
 protected:
  LiveProgram() {
    place_.file("cell.toml", test_support::arm_cell(ROBOMILL_SOURCE_DIR));
    place_.file("forces.toml", test_support::forces_file({.dexel_mm = 0.5}));
    place_.file("part.ngc", "G21 G90 G94\nS12000 M3\nG0 X-12 Y0 Z5\nG0 Z-0.5\nG1 X-8 F600\nG1 X-4\nG1 X0\nG0 Z5\nM2\n");
    place_.file("modes.toml", io::read_file(std::filesystem::path(ROBOMILL_SOURCE_DIR) / "data/robot-modes.toml"));
    place_.file("job.toml",
                "[job]\nforces = \"forces.toml\"\ncell = \"cell.toml\"\nprogram = \"part.ngc\"\n"
                "modes = \"modes.toml\"\n[decide]\nfree = []\n");
    place_.file("lobes.toml",
                "[tool]\nteeth = 2\ndiameter_mm = 10\n[cut]\ndirection = \"slot\"\nfeed_per_tooth_mm = 0.05\n"
                "[coefficients]\ntangential_n_per_mm2 = 700\nradial_n_per_mm2 = 200\n"
                "[lobes]\nspindle_speed_rpm = [6000, 18000]\naxial_depth_mm = [0, 3]\ngrid = [20, 15]\n");
    place_.file("no-program.toml", "[job]\nmodes = \"modes.toml\"\nlobes = \"lobes.toml\"\n");
  }
  test::Folder place_;
};

/// What the job finds.
std::shared_ptr<const jobs::PlanResult> plan_of(const std::filesystem::path& folder) {
  return run_verb({.inputs = {"job.toml"}}, folder, Progress::none()).plan;
}

/// Runs a job to its end.
int run(JobRunner& jobs, const std::string& input) {
  const int id = jobs.submit({.inputs = {input}}).value();
  for (;;) {
    const std::string state = jobs.job(id)["state"];
    if (state == "done") return id;
    if (state == "failed" || state == "cancelled") {
      ADD_FAILURE() << jobs.job(id).dump();
      return id;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST_F(LiveProgram, AnswersAsThePlanDoes) {
  const auto plan = plan_of(place_.path());
  ASSERT_NE(plan, nullptr);
  const LiveProgramRequest asked =
      read_live_program_request(R"({"job": 1, "gamma": [[0, 0]], "client": "c", "channel": "program", "sequence": 7})");
  const json answer = json::parse(live_program(asked, *plan));
  EXPECT_EQ(answer["sequence"], 7);
  const json blocks = json::parse(process::blocks_json(*plan->shown().forces, *plan->shown().blocks));
  EXPECT_EQ(answer["blocks"]["blocks"], blocks["blocks"]);
  EXPECT_EQ(answer["blocks"]["summary"]["worst"], blocks["summary"]["worst"]);
  EXPECT_EQ(answer["unstable"], blocks["summary"]["unstable"]);
  EXPECT_EQ(answer["worst_block"], blocks["summary"]["worst"]["block"]);
  EXPECT_EQ(answer["lost"], json::array());
  ASSERT_EQ(answer["gamma"]["block"].size(), plan->shown().blocks->cutting);
  double least = 1e300;
  for (std::size_t k = 0; k < plan->shown().blocks->cutting; ++k) {
    const std::size_t block = answer["gamma"]["block"][k].get<std::size_t>() - 1;
    EXPECT_EQ(answer["gamma"]["margin"][k], blocks["blocks"]["stability_margin"][block]);
    EXPECT_EQ(answer["gamma"]["gamma_deg"][k], 0.0);
    least = std::min(least, answer["gamma"]["margin"][k].get<double>());
  }
  EXPECT_DOUBLE_EQ(answer["least_margin"].get<double>(), least);
  EXPECT_GT(answer["milliseconds"], 0.0);
  EXPECT_FALSE(answer["notes"].empty());
}

TEST_F(LiveProgram, KeepsTheLastPlansOfPrograms) {
  JobRunner jobs(
      place_.path(), [](const std::string&) {}, run_here(place_.path()));
  const int first = run(jobs, "job.toml");
  const int second = run(jobs, "job.toml");
  const int other = run(jobs, "no-program.toml");
  EXPECT_TRUE(jobs.turn(first));
  EXPECT_FALSE(jobs.turn(other));
  const int third = run(jobs, "job.toml");
  EXPECT_FALSE(jobs.turn(first));
  EXPECT_TRUE(jobs.turn(second));
  EXPECT_TRUE(jobs.turn(third));
  EXPECT_FALSE(jobs.turn(99));
}

TEST_F(LiveProgram, IsAskedOverHttp) {
  const Server server({.folder = place_.path(), .port = 0});
  const std::string page = test::http_ask(server.port(), "GET", "/").body;
  const std::string mark = "id=\"serve-config\">";
  const std::size_t begin = page.find(mark) + mark.size();
  const std::string token = json::parse(page.substr(begin, page.find("</script>", begin) - begin)).at("token");
  const auto ask = [&](std::string_view method, std::string_view target, const std::string& body = {}) {
    return test::http_ask(server.port(), method, target, {{"X-Robomill-Token", token}}, body);
  };
  const auto run_job = [&](const std::string& input) {
    const int id = json::parse(ask("POST", "/api/jobs", json({{"input", input}}).dump()).body)["id"];
    for (;;) {
      const json job = json::parse(ask("GET", "/api/jobs/" + std::to_string(id)).body);
      if (job["state"] != "queued" && job["state"] != "running") return id;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  };
  const int id = run_job("job.toml");
  const auto turn = [&](int job, const json& gamma, int sequence) {
    return ask(
        "POST", "/api/program",
        json({{"job", job}, {"gamma", gamma}, {"client", "c"}, {"channel", "program"}, {"sequence", sequence}}).dump());
  };
  const test::HttpAnswer answer = turn(id, {{0, -10}, {30, 25}}, 5);
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(json::parse(answer.body)["sequence"], 5);
  EXPECT_EQ(json::parse(answer.body)["lost"].size(), 0U);
  EXPECT_EQ(turn(id, {{0, 0}}, 4).status, 409);  // an older one of the channel
  EXPECT_EQ(turn(id, json::array(), 6).status, 400);
  EXPECT_EQ(turn(99, {{0, 0}}, 7).status, 404);
  EXPECT_EQ(turn(run_job("no-program.toml"), {{0, 0}}, 8).status, 404);
  EXPECT_EQ(ask("GET", "/api/program").status, 405);
  EXPECT_EQ(ask("POST", "/api/program", std::string((std::size_t{1} << 20) + 1, ' ')).status, 413);
}

TEST_F(LiveProgram, EndsWhenItIsSuperseded) {
  const auto plan = plan_of(place_.path());
  ASSERT_NE(plan, nullptr);
  const std::atomic<bool> stop = true;
  Progress stopped({}, &stop);
  const LiveProgramRequest asked = {.job = 1, .gamma = {{.path_m = 0.0, .gamma_rad = 0.3}}};
  EXPECT_THROW(static_cast<void>(live_program(asked, *plan, stopped)), Interrupted);
}

TEST(LiveProgramRequestTest, ReadsTheBody) {
  const LiveProgramRequest request = read_live_program_request(
      R"({"job": 3, "gamma": [[-5, 10], [20.5, -90]], "client": "c1", "channel": "program", "sequence": 7})");
  EXPECT_EQ(request.job, 3);
  ASSERT_EQ(request.gamma.size(), 2U);
  EXPECT_DOUBLE_EQ(request.gamma[1].path_m, 20.5e-3);
  EXPECT_DOUBLE_EQ(request.gamma[1].gamma_rad, -1.5707963267948966);
  EXPECT_EQ(request.order.client, "c1");
  EXPECT_EQ(request.order.channel, "program");
  EXPECT_EQ(request.order.sequence, 7U);
}

TEST(LiveProgramRequestTest, RejectsWhatItIsNot) {
  const auto said = [](const std::string& body) {
    return rejection([&] { static_cast<void>(read_live_program_request(body)); });
  };
  const auto of_gamma = [&](const std::string& gamma) { return said(R"({"job": 1, "gamma": )" + gamma + "}"); };
  EXPECT_NE(said("[]").find("must be an object"), std::string::npos);
  EXPECT_NE(said(R"({"gamma": [[0, 0]]})").find("job"), std::string::npos);
  for (const char* job : {"0", "-1", "1.5", "\"1\"", "99999999999", "null"}) {
    EXPECT_NE(said(fmt::format(R"({{"job": {}, "gamma": [[0, 0]]}})", job)).find("must be the number of a job"),
              std::string::npos)
        << job;
  }
  EXPECT_NE(said(R"({"job": 1})").find("gamma"), std::string::npos);
  EXPECT_NE(of_gamma("[]").find("1 to 400"), std::string::npos);
  EXPECT_NE(of_gamma("3").find("gamma"), std::string::npos);
  EXPECT_NE(of_gamma("[[0]]").find("gamma[1]"), std::string::npos);
  EXPECT_NE(of_gamma("[[0, \"x\"]]").find("gamma[1][2]"), std::string::npos);
  EXPECT_NE(of_gamma("[[0, 0], [0, 1]]").find("gamma[2][1]"), std::string::npos);
  EXPECT_NE(of_gamma("[[0, 361]]").find("gamma[1][2]"), std::string::npos);
  std::string many = "[[0, 0]";
  for (int i = 1; i <= 400; ++i) many += fmt::format(", [{}, 0]", i);
  EXPECT_NE(of_gamma(many + "]").find("1 to 400"), std::string::npos);
}

}  // namespace live_program_test
}  // namespace robomill::serve
