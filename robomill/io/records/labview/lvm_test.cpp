#include "robomill/io/records/labview/lvm.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/records/labview/lvm_axis.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace lvm_test {

using test::Folder;
using test::rejection;

/// A file of the format, written from its description.
struct Written {
  std::string separator = "\t", decimal = ".", x_columns = "No", line_end = "\n";
  std::vector<std::string> names = {"Hammer", "Acc"}, units = {"N", "m/s^2"};
  std::string delta_x = "0.000250", x0 = "0.0", dimension = "Time", time = "10:00:01.5", samples = {};
  bool comments = true;

  [[nodiscard]] std::string line(const std::vector<std::string>& fields) const {
    return fmt::format("{}{}", fmt::join(fields, separator), line_end);
  }
  /// A field a channel, in the column of its samples.
  [[nodiscard]] std::string header_line(const std::string& tag, const std::vector<std::string>& values) const {
    std::vector<std::string> fields = {tag};
    for (const std::string& value : values) {
      if (fields.size() > 1 && x_columns == "Multi") fields.emplace_back();
      fields.push_back(value);
    }
    return line(fields);
  }
  [[nodiscard]] std::string header() const {
    return line({"LabVIEW Measurement", ""}) + line({"Writer_Version", "2"}) + line({"Reader_Version", "2"}) +
           line({"Separator", separator == "," ? "Comma" : "Tab"}) +
           (decimal.empty() ? "" : line({"Decimal_Separator", decimal})) + line({"Multi_Headings", "Yes"}) +
           line({"X_Columns", x_columns}) + line({"Time_Pref", "Absolute"}) + line({"Operator", "user"}) +
           line({"***End_of_Header***", ""}) + line({"", ""});
  }
  [[nodiscard]] std::string segment_header() const {
    const auto of_all = [&](const std::string& value) { return std::vector<std::string>(names.size(), value); };
    std::string out = line({"Channels", std::to_string(names.size()), ""});
    if (!samples.empty()) out += header_line("Samples", of_all(samples));
    out += header_line("Date", of_all("2024/02/19")) + header_line("Time", of_all(time));
    out += header_line("Y_Unit_Label", units) + header_line("X_Dimension", of_all(dimension));
    out += header_line("X0", of_all(x0)) + header_line("Delta_X", of_all(delta_x));
    out += line({"***End_of_Header***", "", ""});
    std::vector<std::string> row;
    for (const std::string& name : names) {
      if (row.empty() || x_columns == "Multi") row.emplace_back("X_Value");
      row.push_back(name);
    }
    if (comments) row.emplace_back("Comment");
    return out + line(row);
  }
};

constexpr std::string_view rows = "\t1.5\t-2\n\t2.5\t-3\tthe second\n\t3.5\t-4\n";

TEST(Lvm, ReadsChannelsWithTheirRateAndUnits) {
  const Folder folder;
  const Written written;
  const Record record =
      read_record(folder.file("a.lvm", written.header() + written.segment_header() + std::string(rows)));
  EXPECT_EQ(record.sample_rate_hz, 4000.0);
  EXPECT_TRUE(record.rate_is_stated);
  EXPECT_NEAR(record.rate_error, 0.5e-6 / 250e-6, 1e-12);
  EXPECT_EQ(record.names, (std::vector<std::string>{"Hammer", "Acc"}));
  EXPECT_EQ(record.column("Hammer"), Eigen::Vector3d(1.5, 2.5, 3.5));
  EXPECT_EQ(record.column("2"), Eigen::Vector3d(-2, -3, -4)) << "columns of x do not count";
  EXPECT_EQ(record.unit(0), "N");
  EXPECT_EQ(record.unit(1), "m/s^2");
  EXPECT_TRUE(record.notes.empty());
  EXPECT_NE(rejection([&] {
              (void)read_record(folder.at("a.lvm"), {.time = "X_Value"});
            }).find("X_Value is no column: it is counted as the time already. Leave time out"),
            std::string::npos);
  // Whatever its ending.
  EXPECT_EQ(read_record(folder.file("a.txt", written.header() + written.segment_header() + std::string(rows))).columns,
            record.columns);
}

// The same samples in every way that the format has of writing them.
TEST(Lvm, ReadsEveryWayOfWriting) {
  const Folder folder;
  for (const auto& [separator, decimal] : {std::pair{"\t", "."}, {"\t", ","}, {"\t", ""}, {",", "."}, {",", ""}}) {
    for (const char* const x : {"No", "One", "Multi"}) {
      for (const char* const end : {"\n", "\r\n"}) {
        Written written{.separator = separator, .decimal = decimal, .x_columns = x, .line_end = end};
        const bool comma = written.decimal == ",";
        const auto number = [&](double value, int decimals) {
          std::string text = fmt::format("{:.{}f}", value, decimals);
          if (comma) std::replace(text.begin(), text.end(), '.', ',');
          return text;
        };
        written.delta_x = comma ? "1,953125E-5" : "1.953125E-5";
        std::string content = (end[0] == '\n' ? "" : "\xEF\xBB\xBF") + written.header() + written.segment_header();
        Eigen::VectorXd force(100), response(100);
        for (int i = 0; i < 100; ++i) {
          force(i) = i * 0.25 - 7.0;
          response(i) = 1e-3 * i * i;
          const std::string time = number(i / 51200.0, 9);
          std::vector<std::string> fields = {written.x_columns == "No" ? "" : time, number(force(i), 6)};
          if (written.x_columns == "Multi") fields.push_back(time);
          fields.push_back(number(response(i), 6));
          content += written.line(fields);
        }
        const Record record = read_record(folder.file("a.lvm", content));
        EXPECT_NEAR(record.sample_rate_hz, 51200.0, 51200.0 * record.rate_error + 1e-9);
        EXPECT_LT(record.rate_error, 1e-3);
        EXPECT_EQ(record.rate_is_stated, written.x_columns == "No") << "times confirm it";
        ASSERT_EQ(record.names, (std::vector<std::string>{"Hammer", "Acc"}));
        EXPECT_LT((record.columns[0] - force).norm(), 1e-12);
        EXPECT_LT((record.columns[1] - response).norm(), 1e-12);
      }
    }
  }
}

TEST(Lvm, TimesCountBeforeDeltaX) {
  const Folder folder;
  Written written{.x_columns = "One"};
  written.delta_x = "1.000000";
  const auto read = [&](const std::string& samples) {
    return read_record(folder.file("a.lvm", written.header() + written.segment_header() + samples));
  };
  const Record record = read("0\t1\t2\n0.001\t3\t4\n0.002\t5\t6\n");
  EXPECT_EQ(record.sample_rate_hz, 1000.0);
  EXPECT_FALSE(record.rate_is_stated);
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("X_Value contradicts Delta_X"), std::string::npos);
  const std::string said = rejection([&] { (void)read("0\t1\t2\n0.3\t3\t4\n1.2\t5\t6\n1.5\t5\t6\n"); });
  EXPECT_NE(said.find("the time does not run evenly: from 0.3 s to 1.2 s where 0.5 s are a step, line 23"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("export one"), std::string::npos);
  // Times of too few digits stand still; Delta_X counts where they agree on the whole.
  written.delta_x = "4.0E-4";
  const Record rounded = read("0\t1\t2\n0.000\t3\t4\n0.001\t5\t6\n0.001\t5\t6\n0.002\t5\t6\n0.002\t5\t6\n");
  EXPECT_EQ(rounded.sample_rate_hz, 2500.0);
}

TEST(Lvm, ReadsSegmentsOneBehindTheOther) {
  const Folder folder;
  Written written;
  const std::string begin = written.header() + written.segment_header() + std::string(rows) + "\n";
  // Behind 3 samples at 4000 Hz.
  written.time = "10:00:01.50075";
  const Record record =
      read_record(folder.file("a.lvm", begin + "***Start_Special***\nWfm_Sclr_Meas\n\x01\x02\n***End_Special***\n\n" +
                                           written.segment_header() + "\t7\t8\n"));
  EXPECT_EQ(record.column("Hammer"), Eigen::Vector4d(1.5, 2.5, 3.5, 7.0));
  ASSERT_EQ(record.notes.size(), 2U);
  EXPECT_EQ(record.notes[0], folder.at("a.lvm").string() + ": its 2 segments are read one behind the other");
  EXPECT_NE(record.notes[1].find("special blocks are left out"), std::string::npos);
  written.time = "10:00:09.5";
  const Record apart = read_record(folder.file("a.lvm", begin + written.segment_header() + "\t7\t8\n"));
  EXPECT_NE(apart.notes[0].find("Warning: "), std::string::npos);
  EXPECT_NE(apart.notes[0].find("1 of them begin up to 7.999 s off the end"), std::string::npos) << apart.notes[0];
  const auto says = [&](const Written& second) {
    return rejection([&] { (void)read_record(folder.file("a.lvm", begin + second.segment_header() + "\t7\t8\n")); });
  };
  EXPECT_NE(says({.names = {"Hammer", "Other"}}).find("a segment has other channels than those before it"),
            std::string::npos);
  EXPECT_NE(says({.delta_x = "0.001"}).find("Delta_X of Hammer is 0.001 s in a segment and 0.00025 s before it"),
            std::string::npos);
}

TEST(Lvm, LeavesOutWhatDoesNotGoTogether) {
  const Folder folder;
  Written written{.names = {"Hammer", "Acc", "Log", "Empty"}, .units = {"N", "g", "bar", ""}};
  std::string content = written.header() + written.segment_header();
  for (int i = 0; i < 20; ++i) content += i % 4 == 1 ? "\t1\t2\t3\t\n" : "\t1\t2\n";
  const Record record = read_record(folder.file("a.lvm", content));
  EXPECT_EQ(record.names, (std::vector<std::string>{"Hammer", "Acc"}));
  EXPECT_EQ(record.left_out, (std::vector<std::string>{"Log (is empty in line 21)", "Empty (no samples)"}));
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("2 of its 4 channels are read at 4000 Hz; left out: Log (is empty in line 21), "),
            std::string::npos);
  const std::string said = rejection([&] { (void)record.column("Log"); });
  EXPECT_NE(said.find("has no column Log. It has 2 columns: Hammer, Acc. Left out: Log (is empty in line 21)"),
            std::string::npos)
      << said;
  written.dimension = "Frequency";
  EXPECT_NE(rejection([&] {
              (void)read_record(folder.file("b.lvm", written.header() + written.segment_header() + "\t1\t2\t3\t4\n"));
            }).find("holds no channel that can be read as a record: Hammer (over Frequency); Acc"),
            std::string::npos);
}

TEST(Lvm, ARateOfFewDigitsGivesWayToTheUsers) {
  const Folder folder;
  Written written;
  written.delta_x = "0.000039";
  const Record record =
      read_record(folder.file("a.lvm", written.header() + written.segment_header() + std::string(rows)));
  std::vector<std::string> notes;
  EXPECT_EQ(rate_of(record, 25600.0, "rate", notes), 25600.0);
  EXPECT_TRUE(notes.empty()) << "0.000039 is 0.0000390625 with its digits";
  EXPECT_NEAR(rate_of(record, 0.0, "rate", notes), 25641.0, 0.1);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("as 25641 Hz to 1.3 %: give rate"), std::string::npos) << notes[0];
  notes.clear();
  EXPECT_EQ(rate_of(record, 51200.0, "rate", notes), 51200.0);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("One of them is wrong"), std::string::npos);
}

TEST(Lvm, SaysWhatIsWrong) {
  const Folder folder;
  const Written written;
  const std::string head = written.header() + written.segment_header();
  const auto says = [&](const std::string& content) {
    return rejection([&] { (void)read_record(folder.file("a.lvm", content)); });
  };
  EXPECT_NE(says(head + "\t1\ttext\n").find("a.lvm:21: Acc = \"text\"; must be a finite number"), std::string::npos);
  EXPECT_NE(says(head + "\t1\t1,5\n").find("Acc = \"1,5\""), std::string::npos) << "Decimal_Separator is a point";
  EXPECT_NE(says(head + "\t1\tNaN\n").find("must be a finite number"), std::string::npos);
  EXPECT_NE(says(head).find("holds no channel that can be read as a record: Hammer (no samples)"), std::string::npos);
  EXPECT_NE(says(written.header()).find("holds no channel"), std::string::npos);
  EXPECT_NE(says("LabVIEW Measurement\t\n").find("has no line ***End_of_Header***"), std::string::npos);
  EXPECT_NE(says(written.header() + "Channels\t2\n").find("the header of a segment has no line"), std::string::npos);
  EXPECT_NE(says("LabVIEW Measurement\nSeparator\tSemicolon\n").find("a.lvm:2: Separator is Semicolon. Known are Tab"),
            std::string::npos);
  EXPECT_NE(says(written.header() + "***Start_Special***\n1\n").find("the special block of line 12 has no end"),
            std::string::npos);
  EXPECT_NE(says(written.header() + "Channels\t9\n***End_of_Header***\nX_Value\tA\tB\n\t1\t2\n").find("Channels is 9"),
            std::string::npos);
  Written stated;
  stated.samples = "51200";
  const Record cut = read_record(folder.file("b.lvm", stated.header() + stated.segment_header() + std::string(rows)));
  ASSERT_EQ(cut.notes.size(), 1U);
  EXPECT_NE(cut.notes[0].find("holds 3 of the 51200 samples that its header states: was it cut off?"),
            std::string::npos);
  // Without headers it is a table.
  EXPECT_EQ(read_record(folder.file("c.lvm", "0.0\t1.5\n0.1\t2.5\n")).column("2"), Eigen::Vector2d(1.5, 2.5));
}

TEST(Lvm, IsARecordingToo) {
  const Folder folder;
  const Written written;
  const std::string content = written.header() + written.segment_header() + std::string(rows);
  for (const char* const name : {"a.lvm", "a.txt"}) {
    const auto source = open_samples(folder.file(name, content), {.channels = {"Acc"}, .sample_rate_hz = 4000.0});
    SampleBlock block;
    ASSERT_TRUE(source->next(10, block));
    EXPECT_EQ(block.samples, (std::vector<float>{-2.0F, -3.0F, -4.0F}));
    EXPECT_FALSE(source->next(10, block));
  }
  EXPECT_NE(
      rejection([&] { (void)open_samples(folder.at("a.lvm"), {.channels = {"x"}}); }).find("columns: Hammer, Acc"),
      std::string::npos);
  EXPECT_NE(rejection([&] {
              (void)open_samples(folder.at("a.lvm"), {.channels = {"Acc"}, .sample_rate_hz = 8000.0});
            }).find("was sampled at 4000 Hz"),
            std::string::npos);
  const auto table = open_samples(folder.file("c.lvm", "0.0\t1.5\n0.1\t2.5\n"), {.channels = {"2"}});
  SampleBlock block;
  EXPECT_TRUE(table->next(10, block));
}

// Property: an axis is even where each step is within half of the mean step.
TEST(LvmAxis, IsEvenToHalfAStep) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    LvmAxis axis;
    Eigen::VectorXd time(20);
    double at = random.uniform(-10.0, 10.0);
    for (Eigen::Index i = 0; i < time.size(); ++i) {
      time(i) = at;
      axis.add(at, static_cast<std::size_t>(i));
      at += random.uniform(0.6, 1.4) + (random.index(40) == 0 ? 1.0 : 0.0);
    }
    bool even = true;
    try {
      EXPECT_NEAR(sample_rate_of(time, ""), 1.0 / axis.step_s(), 1e-9);
    } catch (const InvalidInput&) {
      even = false;
    }
    EXPECT_EQ(axis.fault().empty(), even) << axis.fault();
  }
}

// Mutated copies of valid files are read or rejected, never more; what comes is finite and of one length.
TEST(Lvm, SurvivesMutations) {
  const Folder folder;
  for (int seed = 0; seed < test::seeds(5000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Written written{.x_columns = random.index(2) == 0 ? "No" : "Multi"};
    std::string content = written.header();
    for (int segment = 0; segment < 2; ++segment) {
      content += written.segment_header();
      for (int i = 0; i < 5; ++i)
        content += written.x_columns == "No" ? "\t1\t2\n" : fmt::format("{0}\t1\t{0}\t2\n", i);
    }
    for (std::uint64_t i = random.index(6); i > 0; --i) {
      const std::size_t at = random.index(content.size());
      switch (random.index(4)) {
        case 0:
          content[at] = static_cast<char>(random.index(256));
          break;
        case 1:
          content.insert(at, 1, "\t\n,.0E-*"[random.index(8)]);
          break;
        case 2:
          content.erase(at, random.index(20));
          break;
        default:
          content.insert(at, content.substr(random.index(content.size()), random.index(80)));
          break;
      }
    }
    if (random.index(3) == 0) content.resize(random.index(content.size()) + 1);
    try {
      const Record record = read_record(folder.file("b.lvm", content));
      for (const Eigen::VectorXd& column : record.columns) {
        ASSERT_TRUE(column.allFinite());
        ASSERT_EQ(column.size(), record.columns.front().size());
      }
      ASSERT_TRUE(std::isfinite(record.sample_rate_hz) && record.sample_rate_hz >= 0.0);
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace lvm_test
}  // namespace robomill::io
