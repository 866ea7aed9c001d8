#include "robomill/serve/lobes/live_lobes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::serve {
namespace live_lobes_test {

using nlohmann::json;
using stability::Limit;
using test::rejection;
using test_support::replaced;

const std::filesystem::path examples = std::filesystem::path(ROBOMILL_SOURCE_DIR) / "examples";
const std::filesystem::path first_lobes = examples / "first-lobes" / "lobes.toml";
const std::filesystem::path ball_end = examples / "ball-end-lobes" / "lobes.toml";

using Settings = std::vector<io::TomlSetting>;

json answer(LiveLobes& live, const std::filesystem::path& file, Settings settings = {}, bool chart = false,
            std::vector<stability::OperatingPoint> points = {}) {
  return json::parse(
      live.answer({.file = file, .settings = std::move(settings), .chart = chart, .points = std::move(points)}));
}

jobs::LobesFile read(const std::filesystem::path& file, const Settings& settings = {}) {
  jobs::LobesFile out = jobs::read_lobes({file, {}, settings});
  jobs::load_dynamics(out);
  return out;
}

/// Limits of a live answer against those at 1e-6 over the file's own depths, every n-th speed: how far they lie
/// apart at most, as a share of the range of depths. One that has none is at the range's end.
double furthest_apart(const jobs::LobesFile& cut, const json& lobes, std::size_t every) {
  const double deepest_m = cut.options.axial_depth_m[1];
  const double range_m = deepest_m - cut.options.axial_depth_m[0];
  std::vector<double> speeds, drawn_m;
  for (std::size_t i = 0; i < lobes["limit"].size(); i += every) {
    const json& row = lobes["limit"][i];
    speeds.push_back(row["spindle_speed_rpm"].get<double>() * units::rpm);
    drawn_m.push_back(row["axial_depth_mm"].is_null() ? deepest_m : row["axial_depth_mm"].get<double>() * units::mm);
  }
  const std::vector<Limit> exact = stability::limit_depths(cut.problem, cut.options, speeds);
  double furthest = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const bool found = exact[i].status == Limit::Status::found;
    const double exact_m = found ? exact[i].axial_depth_m : deepest_m;
    double apart_m = std::abs(drawn_m[i] - exact_m);
    if (drawn_m[i] < exact_m && apart_m > 5e-3 * range_m) {
      // Lower than what the exact search saw: an island between its depths, or wrong.
      const double into_m = drawn_m[i] + 1e-3 * range_m;
      if (stability::evaluate_point(cut.problem, cut.options, {speeds[i], into_m}).spectral_radius > 0.999)
        apart_m = 0.0;
    }
    furthest = std::max(furthest, apart_m / range_m);
  }
  return furthest;
}

TEST(LiveLobes, DrawsTheLimitsOfTheFile) {
  LiveLobes live;
  for (const std::filesystem::path& file : {first_lobes, ball_end}) {
    const json lobes = answer(live, file)["lobes"];
    ASSERT_EQ(lobes["limit"].size(), 100U);
    const jobs::LobesFile cut = read(file);
    EXPECT_NEAR(lobes["limit"][0]["spindle_speed_rpm"].get<double>() * units::rpm,
                cut.options.spindle_speed_rad_per_s[0], 1e-9);
    EXPECT_NEAR(lobes["limit"][99]["spindle_speed_rpm"].get<double>() * units::rpm,
                cut.options.spindle_speed_rad_per_s[1], 1e-9);
    EXPECT_LT(furthest_apart(cut, lobes, 1), 2e-3) << file;
    EXPECT_TRUE(lobes["boundary"].empty());
  }
}

TEST(LiveLobes, NamesModeAndFrequencyOfEachLimit) {
  LiveLobes live;
  const jobs::LobesFile cut = read(first_lobes);
  std::vector<double> speeds;
  const json limits = answer(live, first_lobes)["lobes"]["limit"];
  for (const json& row : limits) speeds.push_back(row["spindle_speed_rpm"].get<double>() * units::rpm);
  const std::vector<Limit> exact = stability::limit_depths(cut.problem, cut.options, speeds);
  int alike = 0, found = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (limits[i]["axial_depth_mm"].is_null()) continue;
    ++found;
    const double frequency_hz = limits[i]["chatter_frequency_hz"].get<double>();
    alike += limits[i]["mode"] == exact[i].mode.number &&
                     std::abs(frequency_hz - exact[i].chatter_frequency_hz) < 2e-3 * exact[i].chatter_frequency_hz
                 ? 1
                 : 0;
  }
  EXPECT_GT(found, 50);
  EXPECT_GE(alike, found - 3);  // where two lobes meet either one may be named
}

TEST(LiveLobes, SetKeysAreAsThoseOfAnEditedFile) {
  const test::Folder folder;
  const std::string text = replaced(io::read_file(first_lobes), "../../data/", ROBOMILL_SOURCE_DIR "/data/");
  const auto file = folder.file("lobes.toml", text);
  const auto edited = folder.file("edited.toml", replaced(replaced(text, "teeth = 2 ", "teeth = 3 "),
                                                          "radial_depth_mm = 1.8", "radial_depth_mm = 2.5"));
  LiveLobes live;
  json set = answer(live, file, {{"tool.teeth", "3"}, {"cut.radial_depth_mm", "2.5"}});
  json own = answer(live, edited);
  for (json* one : {&set, &own}) (*one)["lobes"].erase("seconds");
  EXPECT_EQ(set["lobes"], own["lobes"]);
  EXPECT_EQ(set["fields"]["tool.teeth"]["value"], 3);
  EXPECT_NE(set["lobes"]["limit"], answer(live, file)["lobes"]["limit"]);
}

TEST(LiveLobes, RejectsKeysInTheFilesWords) {
  LiveLobes live;
  const auto said = [&](const std::string& key, const std::string& value) {
    return rejection([&] { static_cast<void>(answer(live, first_lobes, {{key, value}})); });
  };
  const std::string name = first_lobes.string();
  EXPECT_EQ(said("tool.teeth", "0").find(name + ": tool.teeth = 0; must"), 0U) << said("tool.teeth", "0");
  EXPECT_NE(said("tool.flutess", "2").find("tool.flutess"), std::string::npos);
  EXPECT_NE(said("tool.flutess", "2").find("not known here"), std::string::npos);
  EXPECT_NE(said("cut.radial_depth_mm", "13").find("radial_depth_mm = 13 mm"), std::string::npos);
  EXPECT_NE(said("dynamics.keep_modes", "[9]").find("keep_modes"), std::string::npos);
  EXPECT_NE(said("dynamics.modes", "\"missing.toml\"").find("missing.toml"), std::string::npos);
}

TEST(LiveLobes, ReadsTheStructureAgainOnlyWhenItChanged) {
  const test::Folder folder;
  const std::string modes = io::read_file(ROBOMILL_SOURCE_DIR "/data/robot-modes.toml");
  const auto modes_file = folder.file("robot-modes.toml", modes);
  const auto file = folder.file(
      "lobes.toml", replaced(io::read_file(first_lobes), "../../data/robot-modes.toml", "robot-modes.toml"));
  LiveLobes live;
  const json before = answer(live, file);
  static_cast<void>(answer(live, file, {{"tool.teeth", "4"}}));
  static_cast<void>(answer(live, file, {{"dynamics.keep_modes", "[1, 2]"}}));
  EXPECT_EQ(live.dynamics().reads(), 1U);
  const auto written = std::filesystem::last_write_time(modes_file);
  folder.file("robot-modes.toml", replaced(modes, "frequency_hz = ", "frequency_hz = 1"));
  std::filesystem::last_write_time(modes_file, written + std::chrono::seconds(2));
  const json after = answer(live, file);
  EXPECT_EQ(live.dynamics().reads(), 2U);
  EXPECT_NE(before["modes"], after["modes"]);
  // Another document, another structure; of these so many are kept.
  for (int i = 0; i < 20; ++i) {
    static_cast<void>(answer(live, folder.file("lobes" + std::to_string(i) + ".toml", io::read_file(file))));
  }
  EXPECT_EQ(live.dynamics().reads(), 22U);
  static_cast<void>(answer(live, file));
  EXPECT_EQ(live.dynamics().reads(), 23U);
}

TEST(LiveLobes, StopsWhenItIsTold) {
  LiveLobes live;
  std::atomic<bool> stop{true};
  Progress stopped({}, &stop);
  EXPECT_THROW(static_cast<void>(live.answer({.file = first_lobes}, stopped)), Interrupted);
  // In the middle: the first task that begins is the last.
  stop = false;
  std::vector<std::string> tasks;
  Progress begun(
      [&](const std::string& task, double) {
        tasks.push_back(task);
        stop = true;
      },
      &stop);
  EXPECT_THROW(static_cast<void>(live.answer({.file = ball_end, .chart = true}, begun)), Interrupted);
  ASSERT_FALSE(tasks.empty());
  EXPECT_EQ(std::set<std::string>(tasks.begin(), tasks.end()).size(), 1U);
  EXPECT_EQ(answer(live, first_lobes)["lobes"]["limit"].size(), 100U);  // and goes on
}

TEST(LiveLobes, GivesTheLimitAtEachPoint) {
  LiveLobes live;
  const stability::OperatingPoint stable = {6500 * units::rpm, 0.1 * units::mm};
  const stability::OperatingPoint unstable = {6500 * units::rpm, 2.5 * units::mm};
  const jobs::LobesFile cut = read(first_lobes);
  const double exact_mm =
      stability::limit_depths(cut.problem, cut.options, {stable.spindle_speed_rad_per_s})[0].axial_depth_m / units::mm;
  for (const bool chart : {false, true}) {
    const json points = answer(live, first_lobes, {}, chart, {stable, unstable})["lobes"]["points"];
    ASSERT_EQ(points.size(), 2U);
    EXPECT_EQ(points[0]["stable"], true);
    EXPECT_EQ(points[1]["stable"], false);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(points[i]["limit_depth_mm"].get<double>(), exact_mm, 2e-3 * 3.0);
      EXPECT_NEAR(points[i]["margin"].get<double>(),
                  1.0 - points[i]["axial_depth_mm"].get<double>() / points[i]["limit_depth_mm"].get<double>(), 1e-12);
      EXPECT_GT(points[i]["dominant_frequency_hz"].get<double>(), 0.0);
      EXPECT_TRUE(points[i]["mode"].is_number());
    }
    EXPECT_NEAR(points[1]["spectral_radius"].get<double>(),
                stability::evaluate_point(cut.problem, cut.options, unstable).spectral_radius, 1e-3);
  }
}

TEST(LiveLobes, DrawsBoundaryAndBandOfAChart) {
  const test::Folder folder;
  std::vector<std::string> notes;
  modal::ModalModel model = modal::read_modes(ROBOMILL_SOURCE_DIR "/data/robot-modes.toml", notes);
  for (modal::Mode& mode : model.modes) {
    mode.frequency_std_hz = 0.01 * mode.frequency_hz;
    mode.damping_ratio_std = 0.1 * mode.damping_ratio;
    mode.residue_std_ratio = 0.08;
  }
  folder.file("modes.json", modal::modes_json(model));
  const std::string text = replaced(io::read_file(first_lobes), "../../data/robot-modes.toml", "modes.json");
  const auto file = folder.file("lobes.toml", text);
  LiveLobes live;
  const json lobes = answer(live, file, {}, true)["lobes"];
  EXPECT_GT(lobes["boundary"].size(), 100U);
  EXPECT_EQ(lobes["limit"].size(), 120U);
  const json& band = lobes["uncertainty"];
  int known = 0;
  for (std::size_t i = 0; i < band["spindle_speed_rpm"].size(); ++i) {
    const json &low = band["limit_5_percent_mm"][i], &middle = band["limit_50_percent_mm"][i];
    if (low.is_null() || middle.is_null()) continue;
    EXPECT_LE(low.get<double>(), middle.get<double>());
    ++known;
  }
  EXPECT_GT(known, 20);
  // Modes that know nothing of themselves, and nothing said: no band.
  EXPECT_FALSE(answer(live, first_lobes, {}, true)["lobes"].contains("uncertainty"));
  EXPECT_TRUE(answer(live, first_lobes,
                     {{"uncertainty.samples", "200"}, {"uncertainty.tangential_std_n_per_mm2", "60"}}, true)["lobes"]
                  .contains("uncertainty"));
}

TEST(LiveLobes, GivesTheFieldsOfTheFile) {
  LiveLobes live;
  const json plane = answer(live, first_lobes)["fields"];
  EXPECT_EQ(plane["tool.teeth"], json::parse(R"({"value": 2, "min": 1, "max": 20, "step": 1})"));
  EXPECT_EQ(plane["tool.diameter_mm"]["value"], 12);
  EXPECT_EQ(plane["cut.radial_depth_mm"]["value"], 1.8);
  EXPECT_EQ(plane["cut.radial_depth_mm"]["max"], 12);
  EXPECT_EQ(plane["coefficients.tangential_n_per_mm2"]["value"], 712);
  EXPECT_EQ(plane["tool.helix_deg"]["value"], 0);
  for (const char* key : {"cut.lead_deg", "cut.tilt_deg", "cut.stepover_mm", "cut.axial_depth_mm"}) {
    EXPECT_FALSE(plane.contains(key)) << key;
  }
  const json ball = answer(live, ball_end)["fields"];
  EXPECT_EQ(ball["cut.lead_deg"]["value"], -10);
  EXPECT_EQ(ball["cut.tilt_deg"]["value"], 15);
  EXPECT_EQ(ball["cut.stepover_mm"]["value"], 0.8);
  EXPECT_FALSE(ball.contains("cut.radial_depth_mm"));
  const json lead = answer(live, examples / "ball-end-lobes" / "lead.toml")["fields"];
  EXPECT_FALSE(lead.contains("cut.lead_deg"));
  EXPECT_EQ(lead["cut.axial_depth_mm"]["value"], 0.25);
  // Whatever is set, a range is that of the file.
  const test::Folder folder;
  const std::string hard = replaced(replaced(io::read_file(first_lobes), "../../data/", ROBOMILL_SOURCE_DIR "/data/"),
                                    "tangential_n_per_mm2 = 712", "tangential_n_per_mm2 = 6000");
  const auto file = folder.file("lobes.toml", hard);
  for (const char* value : {"6000", "700"}) {
    const json k = answer(live, file, {{"coefficients.tangential_n_per_mm2", value}})["fields"];
    EXPECT_EQ(k["coefficients.tangential_n_per_mm2"]["max"], 12000);
    EXPECT_EQ(k["coefficients.tangential_n_per_mm2"]["value"], std::stod(value));
  }
  // What the fields offer can be set.
  for (const auto& [key, field] : ball.items()) EXPECT_NO_THROW(answer(live, ball_end, {{key, field["value"].dump()}}));
}

TEST(LiveLobes, ListsTheModesAndWhichOfThemCount) {
  LiveLobes live;
  const json all = answer(live, first_lobes)["modes"];
  ASSERT_EQ(all.size(), 8U);
  EXPECT_EQ(all[7]["number"], 8);
  EXPECT_GT(all[7]["frequency_hz"].get<double>(), all[0]["frequency_hz"].get<double>());
  for (const json& mode : all) EXPECT_EQ(mode["kept"], true);
  const json some = answer(live, first_lobes, {{"dynamics.keep_modes", "[1, 8]"}})["modes"];
  ASSERT_EQ(some.size(), 8U);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(some[static_cast<std::size_t>(i)]["kept"], i == 0 || i == 7);
}

TEST(LiveLobes, AnswersSweepsAndDrilling) {
  LiveLobes live;
  const json sweep = answer(live, examples / "ball-end-lobes" / "lead.toml", {}, false,
                            {{10000 * units::rpm, 5.0 * units::mm}})["lobes"];
  EXPECT_EQ(sweep["sweep"], "lead");
  EXPECT_FALSE(sweep["stable"].empty());
  EXPECT_EQ(sweep["points"][0]["lead_deg"], 5.0);
  const test::Folder folder;
  const auto drill = folder.file("drill.toml", R"([tool]
teeth = 2
diameter_mm = 10
[cut]
kind = "drilling"
feed_per_revolution_mm = 0.1
[coefficients]
tangential_n_per_mm2 = 1500
radial_n_per_mm2 = 900
[dynamics]
z = [{ frequency_hz = 400, damping_ratio = 0.03, modal_mass_kg = 4 }]
[lobes]
spindle_speed_rpm = [500, 3000]
axial_depth_mm = [0, 5]
)");
  const json lobes = answer(live, drill)["lobes"];
  EXPECT_EQ(lobes["limit"].size(), 100U);
  EXPECT_LT(furthest_apart(read(drill), lobes, 7), 5e-3);
}

// Random cuts of the robot: limits lie where the exact search finds them, and no lower one is missed.
TEST(LiveLobes, MissesNoLimitOfRandomSettings) {
  LiveLobes live;
  int limited = 0;
  for (int seed = 0; seed < test::seeds(200); ++seed) {
    Random random(91, static_cast<std::uint64_t>(seed));
    const auto between = [&](double low, double high) { return std::to_string(random.uniform(low, high)); };
    Settings settings = {{"tool.teeth", std::to_string(1 + random.index(6))},
                         {"cut.direction", random.index(2) == 0 ? "\"up\"" : "\"down\""},
                         {"cut.radial_depth_mm", between(0.2, 12.0)},
                         {"cut.feed_direction_deg", between(-180.0, 180.0)},
                         {"coefficients.tangential_n_per_mm2", between(200.0, 2500.0)},
                         {"coefficients.radial_n_per_mm2", between(50.0, 1000.0)},
                         {"lobes.grid", "[2, 200]"}};
    if (random.index(2) == 0) settings.push_back({"tool.helix_deg", between(5.0, 45.0)});
    if (random.index(3) == 0) {
      const std::uint64_t first = 1 + random.index(7);
      settings.push_back({"dynamics.keep_modes", "[" + std::to_string(first) + ", 8]"});
    }
    const json lobes = answer(live, first_lobes, settings)["lobes"];
    EXPECT_LT(furthest_apart(read(first_lobes, settings), lobes, 7), 5e-3) << seed;
    limited += static_cast<int>(
        std::ranges::count_if(lobes["limit"], [](const json& row) { return !row["axial_depth_mm"].is_null(); }));
  }
  EXPECT_GT(limited, 50 * test::seeds(200));
}

TEST(LiveLobes, MissesNoLimitOfRandomBallEnds) {
  LiveLobes live;
  for (int seed = 0; seed < test::seeds(40); ++seed) {
    Random random(92, static_cast<std::uint64_t>(seed));
    const auto between = [&](double low, double high) { return std::to_string(random.uniform(low, high)); };
    const Settings settings = {{"tool.teeth", std::to_string(1 + random.index(4))},
                               {"tool.helix_deg", between(0.0, 40.0)},
                               {"cut.stepover_mm", between(0.2, 3.0)},
                               {"cut.lead_deg", between(-30.0, 30.0)},
                               {"cut.tilt_deg", between(-30.0, 30.0)},
                               {"coefficients.tangential_n_per_mm2", between(500.0, 2500.0)},
                               {"lobes.grid", "[2, 60]"}};
    const json lobes = answer(live, ball_end, settings)["lobes"];
    EXPECT_LT(furthest_apart(read(ball_end, settings), lobes, 25), 5e-3) << seed;
  }
}

TEST(LiveLobesRequest, ReadsTheBody) {
  const LiveLobesRequest request = read_live_lobes_request(
      R"({"file": "a/lobes.toml", "set": {"tool.teeth": 3, "cut.direction": "up", "dynamics.keep_modes": [1, 2],
          "dynamics.equal_directions": true, "cut.radial_depth_mm": 1.25}, "answer": "chart", "at": [[6500, 0.8]],
          "client": "c1", "channel": "a", "sequence": 17})");
  EXPECT_EQ(request.file, "a/lobes.toml");
  ASSERT_EQ(request.settings.size(), 5U);
  EXPECT_EQ(request.settings[0].key, "tool.teeth");
  EXPECT_EQ(request.settings[0].value, "3");
  EXPECT_EQ(request.settings[1].value, "\"up\"");
  EXPECT_EQ(request.settings[2].value, "[1, 2]");
  EXPECT_EQ(request.settings[3].value, "true");
  EXPECT_EQ(request.settings[4].value, "1.25");
  EXPECT_TRUE(request.chart);
  ASSERT_EQ(request.points.size(), 1U);
  EXPECT_DOUBLE_EQ(request.points[0].spindle_speed_rad_per_s, 6500 * units::rpm);
  EXPECT_DOUBLE_EQ(request.points[0].axial_depth_m, 0.8 * units::mm);
  EXPECT_EQ(request.order.client, "c1");
  EXPECT_EQ(request.order.channel, "a");
  EXPECT_EQ(request.order.sequence, 17U);
  EXPECT_FALSE(read_live_lobes_request(R"({"file": "l.toml", "sequence": 1})").chart);
}

TEST(LiveLobesRequest, RejectsWhatItIsNot) {
  const auto said = [](const std::string& body) {
    return rejection([&] { static_cast<void>(read_live_lobes_request(body)); });
  };
  EXPECT_NE(said("{").find("is no JSON"), std::string::npos);
  EXPECT_NE(said("[]").find("must be an object"), std::string::npos);
  EXPECT_NE(said("{}").find("file"), std::string::npos);
  EXPECT_NE(said("{}").find("is missing"), std::string::npos);
  EXPECT_NE(said(R"({"file": 3})").find("file = 3; must be text"), std::string::npos);
  EXPECT_NE(said(R"({"file": "a", "set": {"x": null}})").find("set.x"), std::string::npos);
  EXPECT_NE(said(R"({"file": "a", "set": {"x": {"y": 1}}})").find("set.x"), std::string::npos);
  EXPECT_NE(said(R"({"file": "a", "answer": "map"})").find("\"limit\" or \"chart\""), std::string::npos);
  EXPECT_NE(said(R"({"file": "a", "at": [[1]]})").find("at[1]"), std::string::npos);
  EXPECT_NE(said(R"({"file": "a", "sequence": -1})").find("sequence"), std::string::npos);
  EXPECT_NE(said(R"({"file": "a"})").find("sequence: is missing"), std::string::npos);
  EXPECT_NE(said(R"({"file": "a", "client": ")" + std::string(65, 'x') + R"("})").find("client"), std::string::npos);
}

}  // namespace live_lobes_test
}  // namespace robomill::serve
