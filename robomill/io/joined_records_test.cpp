#include "robomill/io/joined_records.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace joined_records_test {

class JoinedRecordsTest : public ::testing::Test {
 protected:
  /// n rows of a time, written with these digits, and of the row's number.
  Record timed(const std::string& name, int n, double step_s, double begin_s = 0.0, const char* format = "{:.9g}",
               int first = 0) {
    std::string text = "time_s,value\n";
    for (int i = 0; i < n; ++i)
      text += fmt::format(fmt::runtime(format), begin_s + i * step_s) + fmt::format(",{}\n", first + i);
    return read_record(folder_.file(name, text));
  }
  Record plain(const std::string& name, int n, double stated_hz = 0.0) {
    std::string text = stated_hz > 0.0 ? fmt::format("Sample rate: {} Hz\nvalue\n", stated_hz) : "value\n";
    for (int i = 0; i < n; ++i) text += fmt::format("{}\n", i);
    return read_record(folder_.file(name, text));
  }
  static std::string rejection(std::vector<Record> parts) {
    return test::rejection([&] { static_cast<void>(join_records(std::move(parts))); });
  }
  test::Folder folder_;
};

TEST_F(JoinedRecordsTest, OneComesBackAsItIs) {
  const Record record = timed("a.csv", 300, 1e-3, 2.0);
  const JoinedRecords joined = join_records({record});
  ASSERT_EQ(joined.parts.size(), 1U);
  EXPECT_EQ(joined.parts[0].columns, record.columns);
  EXPECT_EQ(joined.sample_rate_hz, record.sample_rate_hz);
  EXPECT_EQ(joined.begin_s, 2.0);
  EXPECT_TRUE(joined.notes.empty());
}

TEST_F(JoinedRecordsTest, TakesTheStretchThatAllHave) {
  // The second begins 20 samples later, and ends 30 later.
  const JoinedRecords joined = join_records({timed("a.csv", 300, 1e-3, 5.0), timed("b.csv", 310, 1e-3, 5.02)});
  EXPECT_NEAR(joined.begin_s, 5.02, 1e-12);
  EXPECT_EQ(joined.parts[0].columns[1].size(), 280);
  EXPECT_EQ(joined.parts[1].columns[1].size(), 280);
  EXPECT_EQ(joined.parts[0].columns[1](0), 20.0);
  EXPECT_EQ(joined.parts[1].columns[1](0), 0.0);
  ASSERT_EQ(joined.notes.size(), 2U);
  EXPECT_NE(joined.notes[0].find("a.csv begins 0.02 s before b.csv"), std::string::npos) << joined.notes[0];
  EXPECT_NE(joined.notes[1].find("280 in a.csv, 310 in b.csv"), std::string::npos) << joined.notes[1];
  EXPECT_NE(rejection({timed("a.csv", 300, 1e-3), timed("b.csv", 300, 1e-3, 9.0)}).find("no time in common"),
            std::string::npos);
}

TEST_F(JoinedRecordsTest, SaysWhereSamplesLieBesideEachOther) {
  const JoinedRecords joined = join_records({timed("a.csv", 300, 1e-3), timed("b.csv", 300, 1e-3, 4e-4)});
  ASSERT_EQ(joined.notes.size(), 1U);
  EXPECT_NE(joined.notes[0].find("b"), std::string::npos);
  EXPECT_NE(joined.notes[0].find("0.40 of a sample"), std::string::npos) << joined.notes[0];
  EXPECT_NE(joined.notes[0].find("1.4e+02° a kHz"), std::string::npos) << "360° · 0.4 ms · 1 kHz: " << joined.notes[0];
}

// Times with few digits agree with exact ones, and these give the rate.
TEST_F(JoinedRecordsTest, RatesAgreeWithinTheirDigits) {
  Record rounded = timed("a.csv", 4000, 2.5e-4, 0.0, "{:.2e}");
  rounded.sample_rate_hz = rounded_sample_rate_of(rounded.columns[0]);
  ASSERT_GT(std::abs(rounded.sample_rate_hz / 4000.0 - 1.0), 1e-9);
  const JoinedRecords joined = join_records({rounded, timed("b.csv", 4000, 2.5e-4)});
  EXPECT_NEAR(joined.sample_rate_hz, 4000.0, 1e-6);
  EXPECT_TRUE(joined.notes.empty());
  const std::string said = rejection({rounded, timed("b.csv", 4000, 2.6e-4)});
  EXPECT_NE(said.find("b.csv: was sampled at 3846.15 Hz, and a.csv at 3999.9 Hz"), std::string::npos) << said;
}

TEST_F(JoinedRecordsTest, WithoutATimeLengthAndRateDecide) {
  const JoinedRecords same = join_records({plain("a.csv", 300, 1000.0), plain("b.csv", 290, 1000.0)});
  EXPECT_EQ(same.parts[0].columns[0].size(), 290);
  ASSERT_EQ(same.notes.size(), 2U);
  EXPECT_EQ(same.notes[0], "a.csv, b.csv are taken to begin at the same time: not all of them have a column of time");
  const JoinedRecords as_long = join_records({plain("a.csv", 300, 1000.0), plain("b.csv", 300)});
  EXPECT_EQ(as_long.sample_rate_hz, 1000.0);
  EXPECT_EQ(as_long.notes.at(0), "b.csv states no sample rate: it has that of a.csv, which is as long");
  const std::string said = rejection({plain("a.csv", 300, 1000.0), plain("b.csv", 299)});
  EXPECT_NE(said.find("states no sample rate and has 299 samples, where a.csv has 300"), std::string::npos) << said;
  EXPECT_NE(rejection({plain("a.csv", 300, 1000.0), plain("b.csv", 300, 1001.0)}).find("at one rate"),
            std::string::npos);
  EXPECT_EQ(join_records({plain("a.csv", 300), plain("b.csv", 300)}).sample_rate_hz, 0.0);
}

TEST_F(JoinedRecordsTest, ThreeFilesAreJoinedToo) {
  const JoinedRecords joined =
      join_records({timed("a.csv", 300, 1e-3), timed("b.csv", 300, 1e-3, 0.01), timed("c.csv", 300, 1e-3, 0.005)});
  EXPECT_EQ(joined.parts[0].columns[1](0), 10.0);
  EXPECT_EQ(joined.parts[1].columns[1](0), 0.0);
  EXPECT_EQ(joined.parts[2].columns[1](0), 5.0);
  EXPECT_EQ(joined.parts[2].columns[1].size(), 290);
}

TEST_F(JoinedRecordsTest, FindsColumnsByNameFileAndNumber) {
  const std::vector<Record> parts = {read_record(folder_.file("a.csv", "time_s,force,x\n0,1,2\n1,3,4\n2,5,6\n")),
                                     read_record(folder_.file("b.csv", "time_s,acc,x\n0,1,2\n1,3,4\n2,5,6\n"))};
  EXPECT_EQ(find_column(parts, "force"), (PartColumn{0, 1}));
  EXPECT_EQ(find_column(parts, "acc"), (PartColumn{1, 1}));
  EXPECT_EQ(find_column(parts, "b.csv:x"), (PartColumn{1, 2}));
  EXPECT_EQ(find_column(parts, "b.csv:2"), (PartColumn{1, 1}));
  EXPECT_EQ(find_column(parts, "x", 1), (PartColumn{1, 2}));
  EXPECT_EQ(find_column(parts, "3", 0), (PartColumn{0, 2}));
  const auto says = [&](const std::string& text, const std::string& part) {
    const std::string said = test::rejection([&] { static_cast<void>(find_column(parts, text)); });
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  says("x", "has a column x, as another of its files has. Write the file before it: \"b.csv:x\"");
  says("2", "column 2 may be of any of the files");
  says("y", "a.csv, b.csv: have no column y. a.csv has time_s, force, x; b.csv has time_s, acc, x");
  says("b.csv:y", "b.csv: has no column y");
  // Its name finds each column again, whichever file is its own.
  for (const std::optional<std::size_t> own :
       {std::optional<std::size_t>(), std::optional<std::size_t>(0), std::optional<std::size_t>(1)}) {
    for (std::size_t part = 0; part < 2; ++part) {
      for (std::size_t place = 0; place < 3; ++place) {
        const PartColumn column{part, place};
        EXPECT_EQ(find_column(parts, column_name(parts, column, own), own), column) << part << place;
      }
    }
  }
}

// Any two records are joined or rejected: what comes out has one length and one rate.
TEST_F(JoinedRecordsTest, SurvivesWhateverItIsGiven) {
  const char* const formats[] = {"{:.9g}", "{:.3g}", "{:.1f}", "{:.0e}"};
  for (int seed = 0; seed < test::seeds(300); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::vector<Record> parts;
    try {
      for (const char* name : {"a.csv", "b.csv"}) {
        const int n = 1 + static_cast<int>(random.index(40));
        parts.push_back(random.index(2) == 0 ? plain(name, n, random.index(2) == 0 ? 0.0 : 1000.0)
                                             : timed(name, n, random.index(2) == 0 ? 1e-3 : 1e3 * random.uniform(),
                                                     1e3 * random.normal(), formats[random.index(4)]));
      }
      const JoinedRecords joined = join_records(parts);
      EXPECT_EQ(joined.parts[0].columns[0].size(), joined.parts[1].columns[0].size()) << seed;
      EXPECT_GT(joined.parts[0].columns[0].size(), 0) << seed;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(".csv"), std::string::npos) << error.what();
    }
  }
}

}  // namespace joined_records_test
}  // namespace robomill::io
