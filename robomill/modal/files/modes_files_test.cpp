#include "robomill/modal/files/modes_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::modal {
namespace modes_files_test {

ModalModel read_modes(const io::TomlSource& source) {
  std::vector<std::string> notes;
  return modal::read_modes(source, notes);
}

void expect_same(const ModalModel& a, const ModalModel& b, double tolerance) {
  ASSERT_EQ(a.modes.size(), b.modes.size());
  EXPECT_EQ(a.excitations, b.excitations);
  EXPECT_EQ(a.responses, b.responses);
  for (std::size_t k = 0; k < a.modes.size(); ++k) {
    EXPECT_NEAR(a.modes[k].frequency_hz, b.modes[k].frequency_hz, tolerance * b.modes[k].frequency_hz);
    EXPECT_NEAR(a.modes[k].damping_ratio, b.modes[k].damping_ratio, tolerance);
    EXPECT_LT((a.modes[k].left - b.modes[k].left).norm(), tolerance * b.modes[k].left.norm());
    EXPECT_LT((a.modes[k].right - b.modes[k].right).norm(), tolerance * b.modes[k].right.norm());
  }
}

TEST(ModesFiles, TheDataFileHoldsTheTypedTable) {
  expect_same(read_modes(ROBOMILL_SOURCE_DIR "/data/robot-modes.toml"), data::robot_modes(), 1e-14);
}

TEST(ModesFiles, JsonGivesTheModelBack) {
  const test::Folder folder;
  ModalModel model = data::robot_modes();
  model.modes[2].frequency_std_hz = 0.01;
  model.residuals.push_back({.name = parse_frf_name("xy"), .mass = {1.0, -2.0}, .stiffness = {3e-9, 4e-9}});
  const ModalModel read = read_modes(folder.file("modes.json", modes_json(model)));
  expect_same(read, model, 1e-14);
  EXPECT_DOUBLE_EQ(read.modes[2].frequency_std_hz, 0.01);
  EXPECT_TRUE(std::isnan(read.modes[3].frequency_std_hz));
  ASSERT_EQ(read.residuals.size(), 1U);
  EXPECT_EQ(read.residuals[0].stiffness, std::complex<double>(3e-9, 4e-9));
}

TEST(ModesFiles, CsvHasARowAMode) {
  ModalModel model = data::robot_modes();
  model.modes.resize(2);
  model.modes[1].frequency_std_hz = 0.01;
  const std::string table = modes_csv(model);
  EXPECT_TRUE(
      table.starts_with("mode,frequency_hz,frequency_std_hz,damping_ratio,damping_ratio_std,residue_std_ratio,"
                        "left_x_re,left_x_im,left_y_re,left_y_im,right_x_re,right_x_im,right_y_re,right_y_im,weak\n"
                        "1,17.4,,0.0127,,,-5.2e-05,8.8e-05,"))
      << table;
  EXPECT_NE(table.find("\n2,19.57,0.01,0.0223,,,"), std::string::npos) << table;
}

// A file without the mark is marked by its deviations; one with it keeps it.
TEST(ModesFiles, WeakModesAreMarked) {
  const test::Folder folder;
  ModalModel model = modes_from_mass({{.frequency_hz = 900.0, .damping_ratio = 0.03, .modal_mass_kg = 0.3},
                                      {.frequency_hz = 3300.0, .damping_ratio = 0.2, .modal_mass_kg = 140.0}},
                                     {});
  for (Mode& mode : model.modes) {
    mode.frequency_std_hz = 0.05 * mode.frequency_hz * mode.damping_ratio;
    mode.damping_ratio_std = 0.05 * mode.damping_ratio;
  }
  io::Json json = io::parse_json(modes_json(model), "modes.json");
  EXPECT_EQ(json["modes"][0]["weak"], false);
  EXPECT_NEAR(json["modes"][1]["modal_mass_kg"].get<double>(), 140.0, 1e-9);
  const double stiffness_n_per_um = 140.0 * std::pow(2.0 * std::numbers::pi * 3300.0, 2) * 1e-6;
  EXPECT_NEAR(json["modes"][1]["modal_stiffness_n_per_um"].get<double>(), stiffness_n_per_um,
              1e-9 * stiffness_n_per_um);
  const auto weak = [&] {
    const ModalModel read = read_modes(folder.file("modes.json", io::dump(json)));
    return std::pair(read.modes[0].weak, read.modes[1].weak);
  };
  EXPECT_EQ(weak(), std::pair(false, false));
  for (io::Json& mode : json["modes"]) mode.erase("weak");
  EXPECT_EQ(weak(), std::pair(false, true));
  json["modes"][0]["weak"] = true;
  json["modes"][1]["weak"] = false;
  EXPECT_EQ(weak(), std::pair(true, false));
  json["modes"][1]["weak"] = "no";
  EXPECT_NE(test::rejection([&] { static_cast<void>(weak()); }).find("modes[2].weak"), std::string::npos);
  const auto path = folder.file("modes.toml",
                                "[[modes]]\nfrequency_hz = 922\ndamping_ratio = 0.011\nleft = { x = [1, 0] }\n"
                                "right = { x = [0, -1e-4] }\nweak = true\n");
  EXPECT_TRUE(read_modes(path).modes[0].weak);
}

TEST(ModesFiles, RejectsWithTheJsonPath) {
  const test::Folder folder;
  const auto say = [&](const std::string& text) {
    return test::rejection([&] { static_cast<void>(read_modes(folder.file("modes.json", text))); });
  };
  const auto mode = [](const std::string& damping, const std::string& left) {
    return R"({"modes":[{"frequency_hz":500,"damping_ratio":)" + damping + R"(,"left":)" + left +
           R"(,"right":{"x":[1,0]}}]})";
  };
  EXPECT_NE(say(mode("-0.01", R"({"x":[1,0]})")).find("modes.json: modes[1].damping_ratio = -0.01"), std::string::npos);
  EXPECT_NE(say(mode("\"big\"", R"({"x":[1,0]})")).find("modes[1].damping_ratio"), std::string::npos);
  EXPECT_NE(say(mode("0.01", R"({"x":[1]})")).find("modes[1].left.x"), std::string::npos);
  EXPECT_NE(say(mode("0.01", R"({"up":[1,0]})")).find("modes[1].left.up"), std::string::npos);
  EXPECT_NE(say("{\"modes\":[{}]}").find("modes[1].frequency_hz: is missing"), std::string::npos);
  EXPECT_NE(say("{\"modes\":\n[}").find("modes.json:2"), std::string::npos);
  const std::string wrong_ending =
      test::rejection([&] { static_cast<void>(read_modes(folder.file("tip.uff", "    -1\n"))); });
  EXPECT_NE(wrong_ending.find("robomill modes"), std::string::npos);
}

// modes.json of a bad fit is its report, and no input until somebody accepts it.
TEST(ModesFiles, AFitThatDoesNotDescribeItsFrfsIsNoInput) {
  const test::Folder folder;
  FitResult fit;
  fit.model = data::robot_modes();
  fit.relative_error = 1.094;
  fit.at_bounds = {{2, FitBound::damping}, {2, FitBound::band_high}};
  const auto path = folder.file("modes.json", modes_json(fit));
  const io::Json json = io::read_json(path);
  EXPECT_EQ(json["fit"]["usable"], false);
  EXPECT_TRUE(json["modes"][0]["at_bounds"].empty());
  EXPECT_EQ(json["modes"][1]["at_bounds"], io::Json::array({"max_damping_ratio", "band_high_hz"}));
  const std::string said = test::rejection([&] { static_cast<void>(read_modes(path)); });
  EXPECT_NE(said.find("modes.json: fit.relative_error = 1.094; must be below 0.2"), std::string::npos) << said;
  EXPECT_NE(said.find("--accept-fit"), std::string::npos) << said;
  fit.accepted = true;
  expect_same(read_modes(folder.file("accepted.json", modes_json(fit))), fit.model, 1e-14);
}

// Cut off or changed at any place, a file is rejected or read, and never anything worse.
TEST(ModesFiles, SurvivesMutations) {
  const test::Folder folder;
  const std::string good = modes_json(data::robot_modes());
  Random random(5);
  for (int i = 0; i < test::seeds(2000); ++i) {
    try {
      read_modes(folder.file("modes.json", test_support::mutated(good, i, random))).validate();
    } catch (const InvalidInput&) {
      continue;
    }
  }
}

}  // namespace modes_files_test
}  // namespace robomill::modal
