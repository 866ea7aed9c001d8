#include "robomill/cutting/files/slots_csv.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace slots_csv_test {

MillingCoefficients read_coefficients(const io::TomlSource& source) {
  std::vector<std::string> notes;
  return cutting::read_coefficients(source, notes);
}

const std::string head = "feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm,fx_n,fy_n,fz_n\n";

TEST(SlotsCsv, ReadsRowsInShopUnits) {
  const test::Folder folder;
  const SlotsFile file = read_slots(folder.file("slots.csv", "# titanium\n" + head +
                                                                 "0.05,5.08,3000,-555.8508,655.6513,255.9891\n\n"
                                                                 "0.1,5.08,,-751.4,887.4,446\n"));
  ASSERT_EQ(file.slots.size(), 2U);
  EXPECT_DOUBLE_EQ(file.slots[0].feed_per_tooth_m, 5e-5);
  EXPECT_DOUBLE_EQ(file.slots[0].axial_depth_m, 5.08e-3);
  EXPECT_DOUBLE_EQ(file.slots[0].spindle_speed_rad_per_s, 100.0 * std::numbers::pi);
  EXPECT_EQ(file.slots[0].mean_force_n, Eigen::Vector3d(-555.8508, 655.6513, 255.9891));
  EXPECT_EQ(file.slots[1].spindle_speed_rad_per_s, 0.0);
  EXPECT_EQ(file.lines, (std::vector<std::size_t>{3, 5}));
  // In any order, and without a speed.
  const SlotsFile other =
      read_slots(folder.file("slots.csv", "fz_n;fx_n;fy_n;axial_depth_mm;feed_per_tooth_mm\n3;1;2;4,5;0,1\n"));
  EXPECT_EQ(other.slots[0].mean_force_n, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_DOUBLE_EQ(other.slots[0].axial_depth_m, 4.5e-3);
}

TEST(SlotsCsv, RejectsInTheFilesWords) {
  const test::Folder folder;
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(read_slots(folder.file("slots.csv", text))); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  expect(head + "0.05,5,3000,1,2,3\n0.05,0,3000,1,2,3\n", "slots.csv:3: axial_depth_mm = 0 mm; must be > 0");
  expect(head + "-0.05,5,3000,1,2,3\n", "slots.csv:2: feed_per_tooth_mm = -0.05 mm; must be > 0");
  expect(head + "0.05,5,-1,1,2,3\n", "slots.csv:2: spindle_speed_rpm = -1 rpm");
  expect(head + "0.05,5,3000,1,two,3\n", "slots.csv:2: fy_n = \"two\"; must be a finite number");
  expect(head + "0.05,5,3000,1,2\n", "slots.csv:2: fz_n: is empty");
  expect(head + "0.05,5,3000,1,2,inf\n", "slots.csv:2: fz_n");
  expect("feed_per_tooth_mm,axial_depth_mm,fx_n,fy_n\n1,2,3,4\n", "has no column fz_n");
  expect("feed_per_tooth,axial_depth_mm,fx_n,fy_n,fz_n\n1,2,3,4,5\n", "Did you mean feed_per_tooth_mm?");
}

/// A structured array of NumPy.
std::string npy(const std::vector<std::string>& names, const std::vector<std::vector<double>>& rows) {
  std::string header = "{'descr': [";
  for (const std::string& name : names) header += "('" + name + "', '<f8'), ";
  header += "], 'fortran_order': False, 'shape': (" + std::to_string(rows.size()) + ",), }\n";
  std::string out("\x93NUMPY\x01\x00", 8);
  out += static_cast<char>(header.size() % 256);
  out += static_cast<char>(header.size() / 256);
  out += header;
  for (const std::vector<double>& row : rows)
    out.append(reinterpret_cast<const char*>(row.data()), sizeof(double) * row.size());
  return out;
}

TEST(SlotsCsv, ReadsTheFormatsOfRecords) {
  const test::Folder folder;
  const std::vector<std::string> names = {"feed_per_tooth_mm", "axial_depth_mm", "fx_n", "fy_n", "fz_n"};
  const SlotsFile file = read_slots(
      folder.file("slots.npy", npy(names, {{0.05, 5.08, -555.8508, 655.6513, 255.9891}, {0.1, 5.08, -1.0, 2.0, 3.0}})));
  ASSERT_EQ(file.slots.size(), 2U);
  EXPECT_DOUBLE_EQ(file.slots[0].feed_per_tooth_m, 5e-5);
  EXPECT_EQ(file.slots[0].mean_force_n, Eigen::Vector3d(-555.8508, 655.6513, 255.9891));
  EXPECT_EQ(file.slots[1].spindle_speed_rad_per_s, 0.0);
  EXPECT_EQ(file.lines, (std::vector<std::size_t>{1, 2}));
  const auto says = [&](const char* name, const std::string& content, const std::string& part) {
    const std::string said = test::rejection([&] { static_cast<void>(read_slots(folder.file(name, content))); });
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  says("slots.npy", npy(names, {{0.05, 5, 1, 2, 3}, {0.05, 0, 1, 2, 3}}),
       "slots.npy:2: axial_depth_mm = 0 mm; must be > 0");
  says("slots.npy", npy({"feed_per_tooth_mm", "axial_depth_mm", "fx_n", "fy_n"}, {{1, 2, 3, 4}, {1, 2, 3, 4}}),
       "has no column fz_n");
  says("slots.xlsx", "PK", "save the sheet as CSV");
  EXPECT_EQ(read_slots(folder.file("slots.npy", npy(names, {{50.0, 5, 1, 2, 3}, {50.0, 5, 1, 2, 3}}))).notes.size(), 1U)
      << "a feed in µm";
}

TEST(SlotsCsv, SurvivesMutations) {
  const test::Folder folder;
  const std::string good = head + "0.05,5.08,3000,-555.8,655.6,255.9\n0.1,5.08,3000,-751.4,887.4,446.0\n";
  Random random(3);
  for (int i = 0; i < test::seeds(1000); ++i) {
    std::string text = good;
    text[random.index(text.size())] = static_cast<char>(random.index(256));
    if (i % 2 == 0) text.resize(1 + random.index(good.size() - 1));
    try {
      for (const SlotForce& slot : read_slots(folder.file("slots.csv", text)).slots) slot.validate();
    } catch (const InvalidInput&) {
      continue;
    }
  }
}

SlotsFile two_speeds(double noise_n) {
  SlotsFile file;
  Random random(5);
  for (int i = 0; i < 12; ++i) {
    const double feed_m = (0.02 + 0.02 * (i / 2)) * 1e-3, depth_m = 5e-3;
    SlotForce slot{feed_m, depth_m, i % 2 == 0 ? 100.0 : 300.0, {}};
    slot.mean_force_n = {-depth_m * 770e6 * feed_m - 4.0 * depth_m / std::numbers::pi * 55.7e3,
                         depth_m * (i % 2 == 0 ? 1825e6 : 1500e6) * feed_m + 4.0 * depth_m / std::numbers::pi * 29.7e3,
                         4.0 * depth_m / std::numbers::pi * 735e6 * feed_m + 2.0 * depth_m * 1.8e3};
    for (double& force : slot.mean_force_n) force += noise_n * random.normal();
    file.slots.push_back(slot);
    file.lines.push_back(static_cast<std::size_t>(i) + 2);
  }
  return file;
}

// What is written is read again as the same coefficients, whatever stands beside them.
TEST(SlotsCsv, WritesCoefficientsThatAreReadAgain) {
  const test::Folder folder;
  const SlotsFile file = two_speeds(3.0);
  const SlotFit fit = identify_from_slots(file.slots, {.teeth = 4});
  ASSERT_TRUE(fit.depends_on_speed);
  const MillingCoefficients read = read_coefficients(folder.file("coefficients.toml", slot_fit_toml(fit, file)));
  EXPECT_NEAR(read.tangential_n_per_m2.front(), fit.tangential.cutting_n_per_m2, 1.0);
  EXPECT_NEAR(read.axial_edge_n_per_m.front(), fit.axial.edge_n_per_m, 1e-5);
  const auto json = nlohmann::json::parse(slot_fit_json(fit, file));
  EXPECT_NEAR(json["coefficients"]["radial_n_per_mm2"].get<double>(), fit.radial.cutting_n_per_m2 * 1e-6, 1e-9);
  EXPECT_NEAR(json["identification"]["std"]["radial_edge_n_per_mm"].get<double>(),
              fit.radial.edge_deviation_n_per_m * 1e-3, 1e-9);
  EXPECT_EQ(json["identification"]["by_speed"].size(), 2U);
  EXPECT_EQ(json["identification"]["residuals"][11]["line"], 13);
  EXPECT_EQ(json["identification"]["residuals"][11]["axial_depth_mm"], 5.0);
  EXPECT_NEAR(json["identification"]["residuals"][11]["force_n"][0].get<double>(), file.slots[11].mean_force_n.x(),
              1e-9);
  EXPECT_TRUE(json["identification"]["depends_on_speed"].get<bool>());
}

TEST(SlotsCsv, WritesATableOfCoefficients) {
  const SlotsFile file = two_speeds(0.0);
  const std::string table = slot_fit_csv(identify_from_slots(file.slots, {.teeth = 4}));
  EXPECT_TRUE(table.starts_with("spindle_speed_rpm,coefficient,value,std,r_squared,noise_n\n,tangential_n_per_mm2,"));
  EXPECT_NE(table.find("\n,radial_edge_n_per_mm,55.7,"), std::string::npos) << table;
  EXPECT_NE(table.find("\n954.929659,tangential_n_per_mm2,1825,"), std::string::npos) << table;
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 19);
}

TEST(SlotsCsv, SaysWhatWasAssumed) {
  const test::Folder folder;
  const SlotsFile file = two_speeds(3.0);
  const SlotFit fit = identify_from_slots(file.slots, {.teeth = 4});
  const std::vector<Assumption> assumed = {{.what = "Teeth", .taken = "4", .key = "--teeth"}};
  const std::string toml = slot_fit_toml(fit, file, assumed);
  EXPECT_NE(toml.find("assumed = [{ what = \"Teeth\", taken = \"4\", key = \"--teeth\" }]"), std::string::npos) << toml;
  static_cast<void>(read_coefficients(folder.file("coefficients.toml", toml)));
  EXPECT_EQ(nlohmann::json::parse(slot_fit_json(fit, file, assumed))["identification"]["assumed"][0]["taken"], "4");
}

TEST(SlotsCsv, WhatIsNotDeterminedIsLeftOut) {
  const test::Folder folder;
  SlotsFile file = two_speeds(0.0);
  file.slots.resize(2);
  file.lines.resize(2);
  const SlotFit fit = identify_from_slots(file.slots, {.teeth = 4});
  const std::string toml = slot_fit_toml(fit, file);
  EXPECT_NE(toml.find("status = \"edge unknown\""), std::string::npos) << toml;
  EXPECT_EQ(toml.find("inf"), std::string::npos) << toml;
  static_cast<void>(read_coefficients(folder.file("coefficients.toml", toml)));
  const auto json = nlohmann::json::parse(slot_fit_json(fit, file));
  EXPECT_TRUE(json["identification"]["std"]["axial_n_per_mm2"].is_null());
}

}  // namespace slots_csv_test
}  // namespace robomill::cutting
