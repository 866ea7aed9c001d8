#include "robomill/io/records/text/maker_text.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace maker_text_test {

using test::Folder;
using test::rejection;

/// A text as DynoWare (Kistler) exports it.
/// @param time  of each row, with as many digits as it is written with
std::string dynoware(char separator, int stated, const std::vector<std::string>& times, const std::string& end = "\n") {
  std::string out;
  const auto line = [&](const std::vector<std::string>& fields) {
    out += fmt::format("{}", fmt::join(fields, std::string(1, separator))) + end;
  };
  line({"DynoWare", "Version 3.1.2.0"});
  line({"Path:", "C:\\cuts"});
  line({"Filename:", "slot 3.dwd"});
  line({"Date:", "Monday"});
  line({"Sampling rate [Hz]:", "10000"});
  line({"Measuring time [s]:", "0.5"});
  line({"Cycles:", "1"});
  line({"Samples per channel:", std::to_string(stated)});
  line({"Cycle No:", "1"});
  line({"Time", "Fx", "Fy", "Mz"});
  line({"s", "N", "kN", "Nm"});
  for (std::size_t i = 0; i < times.size(); ++i) line({times[i], fmt::format("{}.5", i), "-0.25", "1e-3"});
  return out;
}

TEST(DynoWare, IsReadWithRateAndUnits) {
  const Folder folder;
  for (const char separator : {',', '\t', ';'}) {
    for (const std::string end : {"\n", "\r\n"}) {
      const Record record =
          read_record(folder.file("a.csv", dynoware(separator, 4, {"8", "8.0001", "8.0002", "8.0003"}, end)));
      EXPECT_NEAR(record.sample_rate_hz, 10000.0, 1e-6);
      EXPECT_FALSE(record.rate_is_stated);
      EXPECT_EQ(record.names, (std::vector<std::string>{"Time", "Fx", "Fy", "Mz"}));
      EXPECT_EQ(record.unit(1), "N");
      EXPECT_EQ(record.unit(2), "kN");
      EXPECT_EQ(record.unit(3), "Nm");
      EXPECT_EQ(record.column("Fx"), Eigen::Vector4d(0.5, 1.5, 2.5, 3.5));
      EXPECT_TRUE(record.notes.empty());
    }
  }
}

// Six digits are too few for the times of a long record: the header's rate counts.
TEST(DynoWare, TheHeaderCountsWhereTheTimesAreRounded) {
  const Folder folder;
  std::vector<std::string> times;
  for (int i = 0; i < 4000; ++i) times.push_back(fmt::format("{:.6g}", 100.0 + 1e-4 * i));
  const Record record = read_record(folder.file("a.txt", dynoware('\t', 4000, times)));
  EXPECT_EQ(record.sample_rate_hz, 10000.0);
  EXPECT_TRUE(record.rate_is_stated);
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("column Time is rounded and does not count as the time"), std::string::npos);
}

TEST(DynoWare, WhatIsMissingOrContradictsIsSaid) {
  const Folder folder;
  const std::vector<std::string> times = {"0", "0.0001", "0.0002"};
  const Record part = read_record(folder.file("a.csv", dynoware(',', 5000, times)));
  ASSERT_EQ(part.notes.size(), 1U);
  EXPECT_NE(part.notes[0].find("holds 3 of the 5000 samples a channel that its header states"), std::string::npos);
  const Record slow = read_record(folder.file("a.csv", dynoware(',', 3, {"0", "0.001", "0.002"})));
  EXPECT_NEAR(slow.sample_rate_hz, 1000.0, 1e-6);
  ASSERT_EQ(slow.notes.size(), 1U);
  EXPECT_NE(slow.notes[0].find("its header states 10000 Hz, and column Time runs at 1000 Hz, which counts"),
            std::string::npos);
  const std::string twice = dynoware(',', 3, times) + "Cycle No:,2\nTime,Fx,Fy,Mz\ns,N,kN,Nm\n0,1,2,3\n";
  EXPECT_NE(rejection([&] {
              static_cast<void>(read_record(folder.file("a.csv", twice)));
            }).find("a.csv:15: holds several cycles of DynoWare. Export each into a file of its own"),
            std::string::npos);
}

/// A block as PULSE (Brüel & Kjær) exports it: so many lines of header, then a number, x and y.
std::string pulse(const std::string& name, const std::string& unit, const std::string& x_unit, double step,
                  const std::vector<double>& values, const std::string& type = "Real") {
  std::string out = "Header Size:\t8\nVersion:\t1\nData Type:\t" + type + "\nX-Axis size:\t" +
                    std::to_string(values.size()) + "\nX-Axis unit:\t" + x_unit + "\nSignal:\t" + name +
                    "\nAmplitudeUnit:\t" + unit + "\n1 2 3 4\n\n";
  for (std::size_t i = 0; i < values.size(); ++i) {
    out += fmt::format("{}\t{:.6e}\t{:.6e}", i + 1, step * static_cast<double>(i), values[i]);
    out += type == "Real" ? "\n" : "\t0\n";
  }
  return out;
}

TEST(Pulse, ReadsBlocksOfTimeSignals) {
  const Folder folder;
  const std::string content = pulse("Hammer", "N", "s", 0.25, {0, 5, 1}) + pulse("Tip", "m/s²", "s", 0.25, {1, -2, 3}) +
                              pulse("H1", "(m/s²)/N", "Hz", 2.0, {1, 1, 1}, "Complex");
  const Record record = read_record(folder.file("a.txt", content));
  EXPECT_EQ(record.sample_rate_hz, 4.0);
  EXPECT_EQ(record.names, (std::vector<std::string>{"Hammer", "Tip"}));
  EXPECT_EQ(record.column("Tip"), Eigen::Vector3d(1, -2, 3));
  EXPECT_EQ(record.unit(1), "m/s²");
  EXPECT_EQ(record.left_out, std::vector<std::string>{"H1 (complex numbers)"});
  ASSERT_EQ(record.notes.size(), 2U);
  EXPECT_NE(record.notes[1].find("untried on a real file"), std::string::npos);
  const Record in_ms = read_record(folder.file("a.txt", pulse("Hammer", "N", "ms", 0.25, {0, 5, 1})));
  EXPECT_EQ(in_ms.sample_rate_hz, 4000.0);
  const std::string cut_off = pulse("Hammer", "N", "s", 0.25, {0, 5, 1, 2});
  const Record part = read_record(folder.file("a.txt", cut_off.substr(0, cut_off.rfind("4\t"))));
  EXPECT_NE(part.notes.front().find("Hammer holds 3 of the 4 samples that its header states"), std::string::npos);
  const auto source = open_samples(folder.file("b.txt", content), {.channels = {"Tip"}});
  SampleBlock block;
  ASSERT_TRUE(source->next(10, block));
  EXPECT_EQ(block.samples, (std::vector<float>{1, -2, 3}));
}

TEST(Pulse, SaysWhatIsWrong) {
  const Folder folder;
  const auto says = [&](const std::string& content) {
    return rejection([&] { static_cast<void>(read_record(folder.file("a.txt", content))); });
  };
  const std::string good = pulse("Hammer", "N", "s", 0.25, {0, 5, 1});
  EXPECT_NE(says(good.substr(0, good.find("\n\n"))).find("holds no line of numbers behind a header"),
            std::string::npos);
  EXPECT_NE(says(good + "4\t0.75\tx\n").find("a.txt:13:"), std::string::npos) << says(good + "4\t0.75\tx\n");
  EXPECT_NE(says(pulse("S", "N", "Hz", 0.25, {0, 5, 1})).find("S (over Hz)"), std::string::npos);
  std::string gap = good;
  gap.replace(gap.find("5.000000e-01"), 12, "9.000000e-01");
  EXPECT_NE(says(gap + "4\t1.1\t0\n").find("the time does not run evenly"), std::string::npos);
}

std::string testlab(const std::string& function_class, const std::string& rows) {
  return "Function class\t" + function_class + "\nPoint id\ttip:+Z\nX axis unit\ts\nY axis unit\tg\n\n" + rows;
}

TEST(Testlab, ReadsATimeSignal) {
  const Folder folder;
  for (const std::string rows : {"0\t1\n0.5\t-2\n1\t3\n", "0,0\t1,0\n0,5\t-2,0\n1,0\t3,0\n"}) {
    const Record record = read_record(folder.file("a.txt", testlab("Time", rows)));
    EXPECT_EQ(record.sample_rate_hz, 2.0);
    EXPECT_EQ(record.names, std::vector<std::string>{"tip:+Z"});
    EXPECT_EQ(record.columns[0], Eigen::Vector3d(1, -2, 3));
    EXPECT_EQ(record.unit(0), "g");
    EXPECT_NE(record.notes.back().find("as a text of Testlab"), std::string::npos);
  }
  EXPECT_NE(rejection([&] {
              static_cast<void>(read_record(folder.file("a.txt", testlab("FRF", "0\t1\n1\t2\n"))));
            }).find("tip:+Z (is no time signal: frf)"),
            std::string::npos);
}

// A table that happens to have such words is a table.
TEST(MakerText, OtherTextsAreTables) {
  EXPECT_EQ(text_maker_of(std::string_view("time_s,force\n0,1\n")), TextMaker::none);
  EXPECT_EQ(text_maker_of(std::string_view("Header Size: 3\nfs: 5\ntime,force\n0,1\n")), TextMaker::none);
  EXPECT_EQ(text_maker_of(std::string_view("")), TextMaker::none);
}

// Mutated copies of valid texts are read or rejected, never more.
TEST(MakerText, SurvivesMutations) {
  const Folder folder;
  const std::string files[] = {pulse("Hammer", "N", "s", 0.25, {0, 5, 1}) + pulse("Tip", "g", "ms", 0.25, {1, -2, 3}),
                               testlab("Time", "0\t1\n0.5\t-2\n1\t3\n"), dynoware(',', 3, {"0", "0.0001", "0.0002"})};
  for (int seed = 0; seed < test::seeds(20000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = files[random.index(3)];
    for (std::uint64_t i = random.index(6); i > 0; --i) {
      const char letters[] = "0123456789.,:;-\t\neE[]";
      content[random.index(content.size())] =
          random.index(3) > 0 ? letters[random.index(21)] : static_cast<char>(random.index(256));
    }
    if (random.index(4) == 0) content.resize(random.index(content.size()) + 1);
    try {
      const Record record = read_record(folder.file("b.txt", content));
      for (const Eigen::VectorXd& column : record.columns) ASSERT_TRUE(column.allFinite());
      ASSERT_TRUE(std::isfinite(record.sample_rate_hz) && record.sample_rate_hz >= 0.0);
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace maker_text_test
}  // namespace robomill::io
