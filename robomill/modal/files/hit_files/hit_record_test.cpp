#include "robomill/modal/files/hit_files/hit_record.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/modal/files/hits_toml.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace hit_record_test {

/// Rows of a time, a pulse and what follows it, as columns of files.
struct Rows {
  int count = 2000;
  double step_s = 1e-3;
  std::vector<int> hits = {300};

  [[nodiscard]] double force(int i) const {
    double sum = 0.0;
    for (const int at : hits)
      sum += i >= at && i < at + 6 ? 80.0 * std::sin(std::numbers::pi * (i - at + 0.5) / 6.0) : 0.0;
    return sum;
  }
  [[nodiscard]] double response(int i) const {
    double sum = 0.0;
    for (const int at : hits) sum += i < at ? 0.0 : std::exp(-0.02 * (i - at)) * std::sin(0.4 * (i - at));
    return sum;
  }
  /// @param row  (i) -> the text of a row
  template <class F>
  [[nodiscard]] std::string text(const std::string& header, F row, int begin = 0) const {
    std::string out = header;
    for (int i = begin; i < count; ++i) out += row(i) + "\n";
    return out;
  }
};

class HitRecordTest : public ::testing::Test {
 protected:
  HitsFile read(const std::string& text) { return read_hits(folder_.file("hits.toml", text)); }
  std::string rejection(const std::string& text) {
    return test::rejection([&] { static_cast<void>(read(text)); });
  }
  /// force.csv and acc.csv with times and names, the force in kN and the acceleration in g.
  void put_named(const Rows& rows = {}, int acc_begin = 0) {
    folder_.file("force.csv", rows.text("time_s,Hammer (kN)\n", [&](int i) {
      return fmt::format("{:.6f},{:.9f}", rows.step_s * i, 1e-3 * rows.force(i));
    }));
    folder_.file("acc.csv", rows.text(
                                "time_s,ax (g),ay (g)\n",
                                [&](int i) {
                                  return fmt::format("{:.6f},{:.9f},{:.9f}", rows.step_s * i, rows.response(i),
                                                     -rows.response(i));
                                },
                                acc_begin));
  }
  /// The same columns in one file.
  void put_whole(const Rows& rows = {}) {
    folder_.file("whole.csv", rows.text("time_s,Hammer (kN),ax (g),ay (g)\n", [&](int i) {
      return fmt::format("{:.6f},{:.9f},{:.9f},{:.9f}", rows.step_s * i, 1e-3 * rows.force(i), rows.response(i),
                         -rows.response(i));
    }));
  }
  static constexpr const char* columns =
      "force = \"Hammer (kN)\"\nforce_direction = \"x\"\nresponses = { x = \"ax (g)\", y = \"ay (g)\" }\n";
  test::Folder folder_;
};

void expect_same(const Hit& a, const Hit& b) {
  EXPECT_EQ(a.sample_rate_hz, b.sample_rate_hz);
  EXPECT_EQ(a.force_n, b.force_n);
  ASSERT_EQ(a.responses.size(), b.responses.size());
  for (std::size_t i = 0; i < a.responses.size(); ++i) EXPECT_EQ(a.responses[i].samples, b.responses[i].samples);
}

TEST_F(HitRecordTest, ForceAndResponsesApartAreTheSameAsTogether) {
  put_named();
  put_whole();
  const Hit together = read(std::string("[[hits]]\nfile = \"whole.csv\"\n") + columns).hits.at(0);
  const HitsFile apart = read(std::string("[[hits]]\nfile = [\"force.csv\", \"acc.csv\"]\n") + columns);
  ASSERT_EQ(apart.hits.size(), 1U);
  EXPECT_EQ(apart.hits[0].file, folder_.at("force.csv").string() + " + " + folder_.at("acc.csv").string());
  expect_same(apart.hits[0], together);
  EXPECT_NEAR(apart.hits[0].force_n.maxCoeff(), 80.0 * std::cos(std::numbers::pi / 12.0), 1e-6);
  // A list of one is the file; what two files are called in is the file's name.
  expect_same(read(std::string("[[hits]]\nfile = [\"whole.csv\"]\n") + columns).hits.at(0), together);
  const std::string three =
      "[[hits]]\nfile = [\"force.csv\", \"acc.csv\"]\nforce = \"force.csv:2\"\n"
      "force_direction = \"x\"\nresponses = { x = \"acc.csv:ax (g)\", y = \"acc.csv:3\" }\n";
  expect_same(read(three).hits.at(0), together);
}

// Numbers: of the force in the first file, of responses in the second; a time in each.
TEST_F(HitRecordTest, NumbersCountInTheirFile) {
  const Rows rows{.count = 1200, .step_s = 2.5e-4};
  folder_.file("impact.txt",
               rows.text("", [&](int i) { return fmt::format("{:.2e} {}", rows.step_s * i, rows.force(i)); }));
  folder_.file("accel.txt",
               rows.text("", [&](int i) { return fmt::format("{:.7g} {}", rows.step_s * i, rows.response(i)); }));
  const HitsFile file = read(
      "[[hits]]\nfile = [\"impact.txt\", \"accel.txt\"]\ntime = 1\nforce = 2\n"
      "force_direction = \"x\"\nresponses = { x = 2 }\n");
  ASSERT_EQ(file.hits.size(), 1U);
  EXPECT_NEAR(file.hits[0].sample_rate_hz, 4000.0, 1e-6) << "the exact time's";
  for (const int i : {300, 303, 500, 1199}) {
    EXPECT_NEAR(file.hits[0].force_n(i), rows.force(i), 1e-12);
    EXPECT_NEAR(file.hits[0].responses[0].samples(i), rows.response(i), 1e-12);
  }
  ASSERT_FALSE(file.notes.empty());
  EXPECT_NE(file.notes[0].find("impact.txt: column 1 has few digits: the sample rate"), std::string::npos);
  // The time of one file alone.
  EXPECT_EQ(read("[[hits]]\nfile = [\"impact.txt\", \"accel.txt\"]\ntime = \"accel.txt:1\"\nforce = 2\n"
                 "force_direction = \"x\"\nresponses = { x = 2 }\n")
                .hits.at(0)
                .sample_rate_hz,
            file.hits[0].sample_rate_hz);
}

TEST_F(HitRecordTest, SaysWhatDoesNotGoTogether) {
  put_named();
  const std::string list = "[[hits]]\nfile = [\"force.csv\", \"acc.csv\"]\n";
  const auto says = [&](const std::string& text, const std::string& part) {
    EXPECT_NE(rejection(text).find(part), std::string::npos) << rejection(text);
  };
  says(list + "force = \"Kraft\"\nforce_direction = \"x\"\nresponses = { x = 2 }\n",
       "have no column Kraft. force.csv has time_s, Hammer (kN); acc.csv has time_s, ax (g), ay (g)");
  says(list + "force = 2\nforce_direction = \"x\"\nresponses = { x = 7 }\n", "acc.csv: has no column 7");
  says(list + "time = \"Zeit\"\n" + columns, "have no column Zeit of time");
  says(std::string("[[hits]]\nfile = [\"force.csv\", \"force.csv\"]\n") + columns, "names a file twice");
  says(std::string("[[hits]]\nfile = []\n") + columns, "hits[1].file");
  says(std::string("[[hits]]\nfile = [\"force.csv\", \"none.csv\"]\n") + columns, "none.csv");
  Rows fast;
  fast.step_s = 9e-4;
  folder_.file("acc.csv",
               fast.text("time_s,ax (g),ay (g)\n", [&](int i) { return fmt::format("{:.6f},0.1,0.2", 9e-4 * i); }));
  says(list + columns, "was sampled at 1111.11 Hz, and force.csv at 1000 Hz");
  folder_.file("third.csv", fast.text("x\n", [](int) { return std::string("1"); }));
  put_named();
  says(
      "[acquisition]\nsample_rate_hz = 1000\n[[hits]]\nfile = [\"force.csv\", \"acc.csv\", \"third.csv\"]\nforce = 2\n"
      "force_direction = \"x\"\nresponses = { x = 2 }\n",
      "Write the file before it: \"third.csv:2\"");
}

TEST_F(HitRecordTest, TimesThatBeginApartAreAligned) {
  put_named({}, 25);
  put_whole();
  const HitsFile apart = read(std::string("[[hits]]\nfile = [\"force.csv\", \"acc.csv\"]\n") + columns);
  const Hit together = read(std::string("[[hits]]\nfile = \"whole.csv\"\n") + columns).hits.at(0);
  EXPECT_EQ(apart.hits.at(0).force_n, together.force_n.tail(1975));
  EXPECT_EQ(apart.hits[0].responses[0].samples, together.responses[0].samples.tail(1975));
  EXPECT_TRUE(std::ranges::any_of(apart.notes, [](const std::string& note) {
    return note.find("begins 0.025 s before acc.csv") != std::string::npos;
  }));
}

TEST_F(HitRecordTest, SeveralHitsAreCutApart) {
  const Rows rows{.count = 9000, .hits = {400, 2300, 4500, 6600, 8900}};
  put_whole(rows);
  put_named(rows);
  const std::string whole = std::string("[[hits]]\nfile = \"whole.csv\"\n") + columns;
  const HitsFile file = read(whole);
  ASSERT_EQ(file.hits.size(), 5U);
  const std::string path = folder_.at("whole.csv").string();
  EXPECT_EQ(file.hits[2].file, path + ", hit 3 of 5 at 4.50 s");
  EXPECT_TRUE(std::ranges::find(file.notes, path + ": 5 hits, cut apart by the pulses of the force") !=
              file.notes.end());
  EXPECT_NE(file.hits[4].fault.find("the record ends"), std::string::npos) << file.hits[4].fault;
  const HitsFile apart = read(std::string("[[hits]]\nfile = [\"force.csv\", \"acc.csv\"]\n") + columns);
  ASSERT_EQ(apart.hits.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) expect_same(apart.hits[i], file.hits[i]);
  // As one, and without some.
  EXPECT_EQ(read(whole + "split = false\n").hits.size(), 1U);
  EXPECT_EQ(read(whole + "split = false\n").hits[0].force_n.size(), 9000);
  EXPECT_EQ(read("[acquisition]\nhit_spacing_s = 3\n" + whole).hits.size(), 1U);
  const HitsFile some = read(whole + "leave_out = [1, 5]\n");
  ASSERT_EQ(some.hits.size(), 3U);
  EXPECT_EQ(some.hits[0].file, path + ", hit 2 of 5 at 2.30 s");
  EXPECT_NE(rejection(whole + "leave_out = [6]\n").find("names hit 6, and the record has 5"), std::string::npos);
  EXPECT_NE(rejection(whole + "leave_out = [1, 2, 3, 4, 5]\n").find("leaves no hit"), std::string::npos);
  EXPECT_NE(rejection("[acquisition]\nhit_spacing_s = 0\n" + whole).find("must be > 0"), std::string::npos);
}

// Times in ms serve the alignment and the hits' places too.
TEST_F(HitRecordTest, TimesInOtherUnitsAreConverted) {
  const Rows rows{.count = 4000, .hits = {400, 2300}};
  folder_.file("whole.csv", rows.text("time_ms,force_n,ax_m_per_s2\n", [&](int i) {
    return fmt::format("{},{:.9f},{:.9f}", 5000 + i, rows.force(i), rows.response(i));
  }));
  const HitsFile file = read(
      "[[hits]]\nfile = \"whole.csv\"\ntime = \"time_ms\"\nforce = \"force_n\"\n"
      "force_direction = \"x\"\nresponses = { x = \"ax_m_per_s2\" }\n");
  ASSERT_EQ(file.hits.size(), 2U);
  EXPECT_NEAR(file.hits[0].sample_rate_hz, 1000.0, 1e-9);
  EXPECT_EQ(file.hits[1].file, folder_.at("whole.csv").string() + ", hit 2 of 2 at 7.30 s");
}

// Cut off or changed at any place, two files are rejected or read.
TEST_F(HitRecordTest, SurvivesMutations) {
  const Rows rows{.count = 300, .hits = {40}};
  put_named(rows);
  const auto content = [&](const char* name) { return io::read_file(folder_.at(name)); };
  const std::string force = content("force.csv"), acc = content("acc.csv");
  const std::string text = std::string("[[hits]]\nfile = [\"force.csv\", \"acc.csv\"]\n") + columns;
  for (int seed = 0; seed < test::seeds(500); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    for (const auto& [name, good] : {std::pair{"force.csv", force}, {"acc.csv", acc}}) {
      std::string bad = good;
      for (std::uint64_t i = random.index(3); i > 0; --i) {
        bad[random.index(bad.size())] = static_cast<char>(random.index(128));
      }
      if (random.index(3) == 0) bad.resize(1 + random.index(bad.size()));
      folder_.file(name, bad);
    }
    try {
      for (const Hit& hit : read(text).hits) {
        EXPECT_EQ(hit.force_n.size(), hit.responses.at(0).samples.size());
      }
    } catch (const InvalidInput& error) {
      EXPECT_FALSE(std::string(error.what()).empty());
    }
  }
}

}  // namespace hit_record_test
}  // namespace robomill::modal
