#include "robomill/modal/files/hit_files/bare_hits.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "testing/support.hpp"

namespace robomill::modal {
namespace bare_hits_test {

/// A record of hits on a mode, column by column.
struct Record {
  std::string header = "time_s,force_n,ax_m_per_s2\n";
  double force_scale = 1.0;
  int responses = 1;
  bool has_time = true;
  int count = 2000;
  std::vector<int> hits = {200};
  std::string separator = ",";

  [[nodiscard]] std::string text() const {
    std::string out = header;
    for (int i = 0; i < count; ++i) {
      double force = 0.0, moved = 0.0;
      for (const int at : hits) {
        if (i >= at && i < at + 8) force += 90.0 * std::sin(std::numbers::pi * (i - at + 0.5) / 8.0);
        if (i >= at) moved += 20.0 * std::exp(-0.02 * (i - at)) * std::sin(0.5 * (i - at));
      }
      std::string row = has_time ? fmt::format("{:.4f}", i * 1e-3) + separator : std::string();
      row += fmt::format("{:.6f}", force_scale * force);
      for (int k = 0; k < responses; ++k) row += fmt::format("{}{:.6f}", separator, moved / (k + 1));
      out += row + "\n";
    }
    return out;
  }
};

class BareHitsTest : public ::testing::Test {
 protected:
  HitsFile read(const Record& record, const std::string& name = "hit.csv") {
    return read_bare_hits({folder_.file(name, record.text())});
  }
  std::string rejection(const Record& record, const std::string& name = "hit.csv") {
    return test::rejection([&] { static_cast<void>(read(record, name)); });
  }
  static std::vector<std::string> assumed(const HitsFile& file) {
    std::vector<std::string> out;
    for (const Assumption& one : file.assumed) out.push_back(one.what + ": " + one.taken);
    return out;
  }
  test::Folder folder_;
};

bool has(const std::vector<std::string>& texts, const std::string& one) {
  return std::ranges::find(texts, one) != texts.end();
}

TEST_F(BareHitsTest, ARecordOfTheFolderThatRobomillRunsIn) {
  const std::filesystem::path file = folder_.file("hit.csv", Record{}.text());
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(file.parent_path());
  const HitsFile read = read_bare_hits({"hit.csv"});
  std::filesystem::current_path(before);
  EXPECT_EQ(read.hits.size(), 1U);
  EXPECT_NE(test::rejection([] { static_cast<void>(read_bare_hits({})); }).find("none is given"), std::string::npos);
}

TEST_F(BareHitsTest, NamesUnitsAndTimeAreEnough) {
  const HitsFile file = read({});
  ASSERT_EQ(file.hits.size(), 1U);
  EXPECT_EQ(file.hits[0].file, folder_.at("hit.csv").string());
  EXPECT_NEAR(file.hits[0].sample_rate_hz, 1000.0, 1e-6);
  EXPECT_EQ(file.options.response, ResponseKind::acceleration);
  EXPECT_EQ(file.hits[0].excitation.axis, Axis::x);
  EXPECT_EQ(file.hits[0].responses.at(0).dof.axis, Axis::x);
  // What the file says is no assumption; nobody says what the accelerometer weighs.
  EXPECT_EQ(assumed(file), std::vector<std::string>{"Accelerometer's mass: 0 kg, nothing is taken out of the FRFs"});
}

TEST_F(BareHitsTest, UnitsAreConverted) {
  const HitsFile in_g = read({.header = "Time (s),Hammer (lbf),acc y [g]\n"});
  EXPECT_NEAR(in_g.hits.at(0).force_n.maxCoeff(), 90.0 * std::sin(std::numbers::pi * 4.5 / 8.0) * 4.4482216152605,
              1e-2);
  EXPECT_NEAR(in_g.hits[0].responses.at(0).samples(203) / 9.80665, 20.0 * std::exp(-0.06) * std::sin(1.5), 1e-4);
  EXPECT_EQ(in_g.hits[0].excitation.axis, Axis::y) << "hit where the only sensor is";
  const HitsFile in_um = read({.header = "t,force_kn,x_um\n", .force_scale = 1e-3});
  EXPECT_EQ(in_um.options.response, ResponseKind::displacement);
  EXPECT_NEAR(in_um.hits.at(0).force_n.maxCoeff(), 90.0 * std::sin(std::numbers::pi * 4.5 / 8.0), 1e-2);
  EXPECT_NEAR(in_um.hits[0].responses.at(0).samples(203), 20e-6 * std::exp(-0.06) * std::sin(1.5), 1e-11);
  EXPECT_EQ(read({.header = "t,force_n,v_mm_per_s\n"}).options.response, ResponseKind::velocity);
  // The header states the rate.
  const HitsFile stated = read({.header = "Sample rate: 5.12 kHz\nforce_n,ay_m_per_s2\n", .has_time = false}, "a.txt");
  EXPECT_NEAR(stated.hits.at(0).sample_rate_hz, 5120.0, 1e-9);
}

TEST_F(BareHitsTest, WhatNobodySaysIsListed) {
  const std::vector<std::string> direction = assumed(read({.header = "time_s,force_n,acc_m_per_s2\n"}));
  EXPECT_TRUE(has(direction, "Direction of the hit in hit.csv: x, and of the response alike"));
  const std::vector<std::string> by_file = assumed(read({.header = "time_s,force_n,acc_m_per_s2\n"}, "tap_y_1.csv"));
  EXPECT_TRUE(has(by_file, "Direction of the response in tap_y_1.csv: y"));
  // Three columns without a name.
  const HitsFile plain = read({.header = "", .separator = " "}, "hit.txt");
  ASSERT_EQ(plain.hits.size(), 1U);
  const std::vector<std::string> all = assumed(plain);
  for (const char* one :
       {"Column of the force in hit.txt: 2, by its sharp peak", "Column of the response in hit.txt: 3, by what is left",
        "Direction of the hit in hit.txt: x, and of the response alike", "Responses: accelerations",
        "Forces in records without a unit: N", "Responses in records without a unit: m/s²"}) {
    EXPECT_TRUE(has(all, one)) << one;
  }
}

TEST_F(BareHitsTest, SaysWhatToAdd) {
  const auto says = [&](const Record& record, const std::vector<std::string>& parts) {
    const std::string message = rejection(record);
    for (const std::string& part : parts) EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
  };
  says({.header = "time_s,Hammer (V),acc x (V)\n"},
       {"hit.csv: does not say the hammer's sensitivity; nor the sensor's sensitivity. Write hits.toml with these "
        "lines, "
        "and run robomill frf hits.toml:\n  [acquisition]\n",
        "\n  force_mv_per_n = 2.25  # to be given: the hammer's sensitivity\n",
        "\n  response_mv_per_g = 100  # to be given: the sensor's sensitivity\n  [[hits]]\n  file = \"hit.csv\"\n",
        "\n  force = \"Hammer (V)\"\n  force_direction = \"x\"\n  responses = { x = \"acc x (V)\" }"});
  says({.header = "force_n,ax_m_per_s2\n", .has_time = false},
       {"does not say the sample rate", "\n  sample_rate_hz = 51200  # to be given: the sample rate"});
  says({.header = "time_s,force_n,acc1_g,acc2_g\n", .responses = 2}, {"does not say the direction of acc1_g, acc2_g"});
  says({.header = "time_s,force_n,ax_g,ay_g\n", .responses = 2}, {"does not say the direction of the hit"});
  says({.header = "time_s,force_n,ax (furlong)\n"}, {"does not say what \"furlong\" of column ax (furlong) is"});
  says({.header = "", .force_scale = 0.02}, {"names no unit of its force, whose highest number is 1.77", "volts"});
  says({.header = "time_s,ax_g,ay_g\n", .force_scale = 0.0},
       {"no column looks like a hammer's force", "\n  force = …  # column", "file = \"hit.csv\""});
  EXPECT_NE(test::rejection([&] { static_cast<void>(read_bare_hits({folder_.at("none.csv")})); }).find("none.csv"),
            std::string::npos);
  EXPECT_EQ(
      test::rejection([&] {
        static_cast<void>(read_bare_hits({folder_.file("hit.xlsx", "PK")}));
      }).substr(folder_.at("hit.xlsx").string().size()),
      ": is a spreadsheet, which is not read yet. Open it and save the sheet as CSV, with one line of names above "
      "the numbers and nothing below them");
  const auto path = folder_.at("hit.csv");
  EXPECT_NE(test::rejection([&] {
              static_cast<void>(read_bare_hits({path, path}));
            }).find("given twice"),
            std::string::npos);
}

// The lines that an error shows are read once their gaps are filled.
TEST_F(BareHitsTest, TheLinesOfAnErrorServe) {
  const std::string message = rejection({.header = "time_s,Hammer (mV),acc x (V)\n"});
  const std::string lines = message.substr(message.find(":\n") + 2);
  const HitsFile file = read_hits(folder_.file("hits.toml", lines));
  EXPECT_NEAR(file.hits.at(0).force_n.maxCoeff(), 90.0 * std::sin(std::numbers::pi * 4.5 / 8.0) / 2.25, 1e-3);
}

TEST_F(BareHitsTest, SeveralHitsInOneRecordAndSeveralRecords) {
  const HitsFile one = read({.count = 6000, .hits = {200, 2200, 4200}});
  EXPECT_EQ(one.hits.size(), 3U);
  EXPECT_EQ(one.hits[2].file, folder_.at("hit.csv").string() + ", hit 3 of 3 at 4.20 s");
  const auto first = folder_.file("hit_x_1.csv", Record{}.text());
  const auto second = folder_.file("hit_x_2.csv", Record{.hits = {300}}.text());
  EXPECT_EQ(read_bare_hits({first, second}).hits.size(), 2U);
  const auto in_g = folder_.file("hit_x_3.csv", Record{.header = "time_s,force_n,ax_g\n"}.text());
  const std::string said = test::rejection([&] { static_cast<void>(read_bare_hits({first, second, in_g})); });
  EXPECT_NE(said.find("hit_x_3.csv: its response is in g, that of hit_x_1.csv in m/s^2"), std::string::npos) << said;
}

TEST_F(BareHitsTest, ForceAndResponseApart) {
  const Record whole;
  static_cast<void>(read(whole));
  std::string force = "time_s,force_n\n", response = "time_s,ax_m_per_s2\n";
  std::string text = whole.text();
  text.erase(0, text.find('\n') + 1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at), comma = text.find(',', at), last = text.rfind(',', end);
    force += text.substr(at, last - at) + "\n";
    response += text.substr(at, comma - at) + text.substr(last, end - last) + "\n";
    at = end + 1;
  }
  const HitsFile apart = read_bare_hits({folder_.file("b.csv", response), folder_.file("a.csv", force)});
  ASSERT_EQ(apart.hits.size(), 1U);
  const Hit together = read(whole).hits.at(0);
  EXPECT_EQ(apart.hits[0].force_n, together.force_n);
  EXPECT_EQ(apart.hits[0].responses.at(0).samples, together.responses.at(0).samples);
}

}  // namespace bare_hits_test
}  // namespace robomill::modal
