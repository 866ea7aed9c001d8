#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/records/numpy/npy_written.hpp"
#include "robomill/io/records/records.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace npy_test {

using npy_written::doubles;
using npy_written::npy;
using npy_written::number;
using test::Folder;
using test::rejection;

Record read(const Folder& folder, const std::string& content) {
  return read_record(folder.file("a.npy", content));
}

// Every type that holds numbers, in both orders of bytes, by the extremes of each.
TEST(Npy, ReadsEveryTypeOfNumber) {
  const Folder folder;
  struct Type {
    std::string code;
    std::size_t width;
    std::vector<std::pair<std::uint64_t, double>> values;  ///< bits, number
  };
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  const auto bits_4 = [](float value) { return std::uint64_t{std::bit_cast<std::uint32_t>(value)}; };
  const Type types[] = {{"b1", 1, {{0, 0.0}, {1, 1.0}}},
                        {"i1", 1, {{0x80, -128.0}, {0x7F, 127.0}}},
                        {"i2", 2, {{0x8000, -32768.0}, {0xFFFE, -2.0}}},
                        {"i4", 4, {{0x80000000, -2147483648.0}, {5, 5.0}}},
                        {"i8", 8, {{0xFFFFFFFFFFFFFFFF, -1.0}, {std::uint64_t{1} << 40, 1099511627776.0}}},
                        {"u1", 1, {{0xFF, 255.0}, {1, 1.0}}},
                        {"u2", 2, {{0xFFFF, 65535.0}, {0x0102, 258.0}}},
                        {"u4", 4, {{0xFFFFFFFF, 4294967295.0}, {1, 1.0}}},
                        {"u8", 8, {{0x8000000000000000, 9223372036854775808.0}, {7, 7.0}}},
                        // Half precision, by the examples of IEEE 754: the largest, the least, a third.
                        {"f2", 2, {{0x7BFF, 65504.0}, {0x0001, 0x1p-24}, {0xB555, -0.333251953125}, {0x3C00, 1.0}}},
                        {"f4", 4, {{bits_4(-1.5F), -1.5}, {bits_4(3.25F), 3.25}}},
                        {"f8", 8, {{bits(0.1), 0.1}, {bits(-1e300), -1e300}}}};
  for (const bool big_endian : {false, true}) {
    for (const Type& type : types) {
      std::string values;
      for (const auto& [value, expected] : type.values) values += number(value, type.width, big_endian);
      const Record record = read(folder, npy(fmt::format("'{}{}'", big_endian ? '>' : '<', type.code),
                                             fmt::format("({},)", type.values.size()), values));
      ASSERT_EQ(record.columns.size(), 1U) << type.code;
      EXPECT_EQ(record.sample_rate_hz, 0.0);
      for (std::size_t i = 0; i < type.values.size(); ++i) {
        EXPECT_EQ(record.columns[0](static_cast<Eigen::Index>(i)), type.values[i].second) << type.code;
      }
    }
  }
}

// n × k and k × n, in both orders, by all versions, with sides of one element: the longer side is time.
TEST(Npy, TheLongerSideIsTime) {
  const Folder folder;
  // Channel c, sample s is 10 c + s.
  for (const int version : {1, 2, 3}) {
    for (const bool rows_are_samples : {false, true}) {
      for (const bool fortran_order : {false, true}) {
        std::vector<double> values;
        for (int slow = 0; slow < (rows_are_samples != fortran_order ? 4 : 3); ++slow) {
          for (int fast = 0; fast < (rows_are_samples != fortran_order ? 3 : 4); ++fast) {
            const int channel = rows_are_samples != fortran_order ? fast : slow;
            values.push_back(10 * channel + (slow + fast - channel));
          }
        }
        const Record record = read(
            folder, npy("'<f8'", rows_are_samples ? "(4, 1, 3)" : "(3, 4)", doubles(values), fortran_order, version));
        ASSERT_EQ(record.columns.size(), 3U);
        for (int c = 0; c < 3; ++c) {
          EXPECT_EQ(record.column(std::to_string(c + 1)), Eigen::Vector4d(10 * c, 10 * c + 1, 10 * c + 2, 10 * c + 3));
        }
      }
    }
  }
}

TEST(Npy, ReadsTheFieldsOfAStructuredArray) {
  const Folder folder;
  std::string values;
  for (int i = 0; i < 4; ++i) {
    values += doubles({3.0 + 0.25 * i}, true) + number(static_cast<std::uint64_t>(100 - i), 2) + "text" +
              doubles({1.0 * i, 2.0 * i});
  }
  const Record record =
      read(folder,
           npy("[('time', '>f8'), (('Hammer of the left', 'force_n'), '<i2'), ('note', '|S4'), ('acc', '<f8', (2,))]",
               "(4,)", values));
  EXPECT_EQ(record.sample_rate_hz, 4.0);
  EXPECT_EQ(record.names, (std::vector<std::string>{"time", "force_n", "acc[:,0]", "acc[:,1]"}));
  EXPECT_EQ(record.column("time"), Eigen::Vector4d(3, 3.25, 3.5, 3.75));
  EXPECT_EQ(record.column("force_n"), Eigen::Vector4d(100, 99, 98, 97));
  EXPECT_EQ(record.column("acc[:,1]"), Eigen::Vector4d(0, 2, 4, 6));
  EXPECT_EQ(record.unit(1), "N");
  EXPECT_EQ(record.left_out, std::vector<std::string>{"note (text)"});
}

// A date in ns has more digits than a double: the steps count.
// 14 November 2023, 22:13:20.123 456 789: files of one measurement count from one midnight.
TEST(Npy, DatesAreSecondsOfTheDay) {
  const Folder folder;
  for (const auto& [unit, ticks] : {std::pair{"ns", 39063U}, {"us", 39U}, {"ms", 4U}, {"s", 2U}}) {
    std::string values;
    for (std::uint64_t i = 0; i < 5; ++i) {
      values += number(1'700'000'000'123'456'789U + i * ticks, 8, true) + doubles({static_cast<double>(i)});
    }
    const Record record = read(folder, npy(fmt::format("[('time', '>M8[{}]'), ('x', '<f8')]", unit), "(5,)", values));
    const double s = unit == std::string("ns") ? 1e-9 : unit == std::string("us") ? 1e-6 : unit[0] == 'm' ? 1e-3 : 1.0;
    EXPECT_NEAR(record.sample_rate_hz * s * ticks, 1.0, 1e-6) << unit;
    const auto day = static_cast<std::uint64_t>(std::llround(86400.0 / s));
    EXPECT_NEAR(record.column("time")(0), s * static_cast<double>(1'700'000'000'123'456'789U % day), 1e-9) << unit;
  }
}

TEST(Npy, SaysWhatIsWrong) {
  const Folder folder;
  const auto says = [&](const std::string& content) { return rejection([&] { (void)read(folder, content); }); };
  const std::string good = npy("'<f8'", "(3,)", doubles({1, 2, 3}));
  EXPECT_NE(says("1,2,3\n").find("is no NPY file: it does not begin as one"), std::string::npos);
  EXPECT_NE(says(good.substr(0, 20)).find("ends within its header"), std::string::npos);
  EXPECT_NE(says(good.substr(0, good.size() - 1)).find("states 3 values of 8 bytes, and 23 bytes follow"),
            std::string::npos);
  EXPECT_NE(says(npy("'<f8'", "(1000000000000,)", "12345678")).find("bytes follow. Was it cut off?"),
            std::string::npos);
  EXPECT_NE(says(npy("'<f8'", "(4294967296, 4294967296)", "12345678")).find("a header of NPY that makes no sense"),
            std::string::npos);
  for (const auto& [type, reason] : {std::pair{"'|O'", "Python objects"},
                                     {"'<c16'", "complex numbers"},
                                     {"'<f16'", "numbers of extended precision"},
                                     {"'|V16'", "bytes without a type"}}) {
    const std::string said = says(npy(type, "(3,)", std::string(48, '\1')));
    EXPECT_NE(said.find(fmt::format("cannot be read as a record: {}. Save the samples as numbers", reason)),
              std::string::npos)
        << said;
  }
  EXPECT_NE(says(npy("'<f8'", "(2, 2, 2)", doubles(std::vector<double>(8, 1.0)))).find("of 3 dimensions"),
            std::string::npos);
  EXPECT_NE(says(npy("'|u1'", "(5000, 5000)", std::string(25'000'000, '\1'))).find("5000 columns: at most 4096"),
            std::string::npos);
  EXPECT_NE(says(npy("'<f8'", "(3,)", doubles({1, NAN, 3}))).find("a value is no finite number"), std::string::npos);
  EXPECT_NE(says(npy("'<f8'", "(0,)", "")).find("no values"), std::string::npos);
  EXPECT_NE(says(npy("'<f8', 'x': [[[[[[[[[[1]]]]]]]]]]", "(3,)", doubles({1, 2, 3}))).find("makes no sense"),
            std::string::npos);
  std::string other = good;
  other[6] = 4;
  EXPECT_NE(says(other).find("is of version 4 of NPY, and 1 to 3 are read"), std::string::npos);
  // Several arrays may stand in one file.
  const Record twice = read(folder, good + good);
  ASSERT_EQ(twice.notes.size(), 1U);
  EXPECT_NE(twice.notes[0].find("152 bytes behind the array are left out"), std::string::npos) << twice.notes[0];
}

// Property: what is written is read, whatever its type, order and shape.
TEST(Npy, ReadsWhatIsWritten) {
  const Folder folder;
  for (int seed = 0; seed < test::seeds(1000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const std::size_t channels = 1 + random.index(4), samples = channels + 1 + random.index(40);
    const bool big_endian = random.index(2) == 0, fortran_order = random.index(2) == 0, by_rows = random.index(2) == 0;
    const bool whole = random.index(2) == 0;
    Eigen::MatrixXd written(samples, channels);
    for (double& value : written.reshaped()) value = std::floor(random.uniform(-30000.0, 30000.0));
    std::string values;
    for (std::size_t i = 0; i < samples * channels; ++i) {
      const bool samples_slow = by_rows == fortran_order;
      const std::size_t fast = samples_slow ? channels : samples;
      const auto a = static_cast<Eigen::Index>(i / fast), b = static_cast<Eigen::Index>(i % fast);
      const double value = samples_slow ? written(a, b) : written(b, a);
      values += whole ? number(static_cast<std::uint64_t>(static_cast<std::int64_t>(value)), 4, big_endian)
                      : doubles({value}, big_endian);
    }
    const std::string shape =
        by_rows ? fmt::format("({}, {})", channels, samples) : fmt::format("({}, {})", samples, channels);
    const Record record = read(
        folder, npy(fmt::format("'{}{}'", big_endian ? '>' : '<', whole ? "i4" : "f8"), shape, values, fortran_order));
    ASSERT_EQ(record.columns.size(), channels) << seed;
    for (std::size_t c = 0; c < channels; ++c) ASSERT_EQ(record.columns[c], written.col(static_cast<Eigen::Index>(c)));
  }
}

// Mutated copies of valid files are read or rejected, never more; what comes is finite.
TEST(Npy, SurvivesMutations) {
  const Folder folder;
  const std::string files[] = {
      npy("'<f8'", "(3, 2)", doubles({1, 2, 3, 4, 5, 6})), npy("'>i2'", "(2, 4)", "0123456789abcdef", true, 2),
      npy("[('time', '<M8[us]'), ('x', '<f4', (2,))]", "(4,)", std::string(64, '\2'), false, 3)};
  for (int seed = 0; seed < test::seeds(20000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = files[random.index(3)];
    for (std::uint64_t i = random.index(5); i > 0; --i) {
      const char letters[] = "0123456789(),[]'<>Mfiu";
      content[random.index(content.size())] =
          random.index(2) == 0 ? letters[random.index(22)] : static_cast<char>(random.index(256));
    }
    if (random.index(4) == 0) content.resize(random.index(content.size()) + 1);
    try {
      const Record record = read(folder, content);
      for (const Eigen::VectorXd& column : record.columns) ASSERT_TRUE(column.allFinite());
      ASSERT_TRUE(std::isfinite(record.sample_rate_hz) && record.sample_rate_hz >= 0.0);
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace npy_test
}  // namespace robomill::io
