#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/io/records/numpy/npy_written.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace npz_test {

using npy_written::doubles;
using npy_written::letters;
using npy_written::npy;
using npy_written::number;
using test::Folder;
using test::rejection;

struct Member {
  std::string name, content;
};

std::string deflated(const std::string& content) {
  z_stream stream = {};
  EXPECT_EQ(::deflateInit2(&stream, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string in = content, out(content.size() + 1000, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(::deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(out.size() - stream.avail_out);
  ::deflateEnd(&stream);
  return out;
}

/// An archive as numpy.savez writes it: headers of their own in ZIP64, the directory behind them.
/// @param method  0 stored, 8 deflated
std::string zip(const std::vector<Member>& members, int method, bool directory_64 = false) {
  std::string out, directory;
  for (const Member& member : members) {
    const std::string packed = method == 8 ? deflated(member.content) : member.content;
    const std::uint64_t crc =
        ::crc32(0, reinterpret_cast<const Bytef*>(member.content.data()), static_cast<uInt>(member.content.size()));
    const std::string sizes_64 = number(member.content.size(), 8) + number(packed.size(), 8);
    const std::string begin =
        number(20, 2) + number(0, 2) + number(static_cast<std::uint64_t>(method), 2) + number(0, 4) + number(crc, 4);
    const std::size_t at = out.size();
    out += "PK\x03\x04" + begin + std::string(8, '\xFF') + number(member.name.size(), 2) + number(20, 2) + member.name +
           number(1, 2) + number(16, 2) + sizes_64 + packed;
    const std::string extra =
        directory_64 ? number(0x5455, 2) + number(1, 2) + "x" + number(1, 2) + number(24, 2) + sizes_64 + number(at, 8)
                     : "";
    directory += "PK\x01\x02" + number(45, 2) + begin;
    directory += directory_64 ? std::string(8, '\xFF') : number(packed.size(), 4) + number(member.content.size(), 4);
    directory += number(member.name.size(), 2) + number(extra.size(), 2) + number(0, 2) + number(0, 2) + number(0, 2) +
                 number(0, 4) + (directory_64 ? std::string(4, '\xFF') : number(at, 4)) + member.name + extra;
  }
  const std::size_t directory_at = out.size();
  out += directory;
  if (directory_64) {
    const std::size_t end_at = out.size();
    out += "PK\x06\x06" + number(44, 8) + number(45, 2) + number(45, 2) + number(0, 4) + number(0, 4) +
           number(members.size(), 8) + number(members.size(), 8) + number(directory.size(), 8) +
           number(directory_at, 8);
    out += "PK\x06\x07" + number(0, 4) + number(end_at, 8) + number(1, 4);
    return out + "PK\x05\x06" + number(0, 4) + std::string(12, '\xFF') + number(0, 2);
  }
  return out + "PK\x05\x06" + number(0, 4) + number(members.size(), 2) + number(members.size(), 2) +
         number(directory.size(), 4) + number(directory_at, 4) + number(7, 2) + "comment";
}

std::vector<Member> hit() {
  return {{"force_n.npy", npy("'<f8'", "(4,)", doubles({0, 5, 1, 0}))},
          {"acc.npy", npy("'>f8'", "(1, 4)", doubles({1, -2, 3, -4}, true))},
          {"acc_unit.npy", npy("'<U3'", "()", letters("g", 3))},
          {"fs.npy", npy("'<i8'", "()", number(51200, 8))}};
}

TEST(Npz, ReadsArraysByNameWithRateAndUnit) {
  const Folder folder;
  for (const int method : {0, 8}) {
    for (const bool directory_64 : {false, true}) {
      const Record record = read_record(folder.file("a.npz", zip(hit(), method, directory_64)));
      EXPECT_EQ(record.sample_rate_hz, 51200.0);
      EXPECT_EQ(record.names, (std::vector<std::string>{"force_n", "acc"}));
      EXPECT_EQ(record.column("force_n"), Eigen::Vector4d(0, 5, 1, 0));
      EXPECT_EQ(record.column("acc"), Eigen::Vector4d(1, -2, 3, -4));
      EXPECT_EQ(record.unit(0), "N");
      EXPECT_EQ(record.unit(1), "g");
      EXPECT_TRUE(record.notes.empty());
    }
  }
}

TEST(Npz, FindsTheRate) {
  const Folder folder;
  const auto rate = [&](const std::string& name, double value) {
    return read_record(folder.file("a.npz", zip({{"x.npy", npy("'<f8'", "(3,)", doubles({1, 2, 3}))},
                                                 {name + ".npy", npy("'<f8'", "(1,)", doubles({value}))}},
                                                8)))
        .sample_rate_hz;
  };
  for (const char* name : {"fs", "Fs", "sample_rate", "sampling_rate_hz", "samplerate", "sampling_frequency", "rate"}) {
    EXPECT_EQ(rate(name, 25600.0), 25600.0) << name;
  }
  EXPECT_EQ(rate("sample_rate_khz", 25.6), 25600.0);
  for (const char* name : {"dt", "delta_t", "Ts", "sample_interval_s", "dt_s"}) {
    EXPECT_EQ(rate(name, 1.0 / 25600.0), 25600.0) << name;
  }
  EXPECT_EQ(rate("dt_ms", 0.2), 5000.0);
  EXPECT_EQ(rate("dt_us", 20.0), 50000.0);
  for (const char* name : {"frequency", "speed", "offset", "fs2"}) EXPECT_EQ(rate(name, 5.0), 0.0) << name;
  EXPECT_EQ(rate("fs", -5.0), 0.0);
  EXPECT_EQ(rate("fs", NAN), 0.0);
}

// Times count before a number; of two rates the one with more samples is read, and the other named.
TEST(Npz, TimesCountAndChannelsOfAnotherRateAreLeftOut) {
  const Folder folder;
  const Record record =
      read_record(folder.file("a.npz", zip({{"time_ms.npy", npy("'<f8'", "(4,)", doubles({0, 0.5, 1.0, 1.5}))},
                                            {"f.npy", npy("'<f8'", "(4,)", doubles({1, 2, 3, 4}))},
                                            {"fs.npy", npy("'<f8'", "()", doubles({10.0}))},
                                            {"temperature.npy", npy("'<f8'", "(2,)", doubles({20, 21}))},
                                            {"c.npy", npy("'<c16'", "(4,)", doubles(std::vector<double>(8, 1.0)))}},
                                           0)));
  EXPECT_EQ(record.sample_rate_hz, 2000.0);
  EXPECT_EQ(record.names, (std::vector<std::string>{"time_ms", "f"}));
  EXPECT_EQ(record.column("time_ms"), Eigen::Vector4d(0, 0.0005, 0.001, 0.0015));
  EXPECT_EQ(record.unit(0), "s");
  ASSERT_EQ(record.notes.size(), 3U);
  EXPECT_NE(record.notes[0].find("time_ms is converted to s"), std::string::npos);
  EXPECT_NE(record.notes[1].find("it states 10 Hz beside time_ms, which runs at 2000 Hz and counts"),
            std::string::npos);
  EXPECT_NE(record.notes[2].find("left out: temperature (10 Hz, 2 samples), c (complex numbers)"), std::string::npos)
      << record.notes[2];
  EXPECT_NE(rejection([&] { (void)record.column("c"); }).find("Left out: temperature"), std::string::npos);
  const Record uneven =
      read_record(folder.file("b.npz", zip({{"t.npy", npy("'<f8'", "(4,)", doubles({0, 1, 2, 5}))},
                                            {"f.npy", npy("'<f8'", "(4,)", doubles({1, 2, 3, 4}))},
                                            {"g.npy", npy("'<f8'", "(9,)", doubles(std::vector<double>(9, 1.0)))}},
                                           0)));
  EXPECT_EQ(uneven.names, std::vector<std::string>{"g"});
  EXPECT_NE(uneven.left_out[0].find("the time does not run evenly: from 2 s to 5 s"), std::string::npos);
}

// A rounded time is no rate, but it is in s all the same.
TEST(Npz, ARoundedTimeIsInSecondsToo) {
  const Folder folder;
  std::vector<double> times_ms, values;
  for (int i = 0; i < 400; ++i) {
    times_ms.push_back(static_cast<double>(i / 2));
    values.push_back(static_cast<double>(i));
  }
  const Record record =
      read_record(folder.file("a.npz", zip({{"time_ms.npy", npy("'<f8'", "(400,)", doubles(times_ms))},
                                            {"x.npy", npy("'<f8'", "(400,)", doubles(values))}},
                                           0)));
  EXPECT_DOUBLE_EQ(record.column("time_ms")(399), 0.199);
  EXPECT_EQ(record.unit(0), "s");
}

TEST(Npz, NamesAndUnitsOfAMatrixStandBesideIt) {
  const Folder folder;
  const std::vector<Member> members = {{"data.npy", npy("'<f8'", "(3, 2)", doubles({1, 10, 2, 20, 3, 30}))},
                                       {"channels.npy", npy("'<U5'", "(2,)", letters("Force", 5) + letters("Acc", 5))},
                                       {"units.npy", npy("'|S5'", "(2,)", std::string("kN\0\0\0m/s^2", 10))},
                                       {"sensitivity.npy", npy("'<f8'", "()", doubles({0.1}))},
                                       {"dt.npy", npy("'<f4'", "()", number(0x3A83126F, 4))}};  // 0.001
  const Record record = read_record(folder.file("a.npz", zip(members, 8)));
  EXPECT_EQ(record.names, (std::vector<std::string>{"Force", "Acc"}));
  EXPECT_EQ(record.column("Acc"), Eigen::Vector3d(10, 20, 30));
  EXPECT_EQ(record.unit(0), "kN");
  EXPECT_EQ(record.unit(1), "m/s^2");
  EXPECT_NEAR(record.sample_rate_hz, 1000.0, 1e-4);
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("sensitivity = 0.1 is not applied to data"), std::string::npos);
  const Record bare = read_record(folder.file("b.npz", zip({members[0]}, 0)));
  EXPECT_EQ(bare.names, (std::vector<std::string>{"data[:,0]", "data[:,1]"}));
}

TEST(Npz, IsARecordingToo) {
  const Folder folder;
  const auto source = open_samples(folder.file("a.npz", zip(hit(), 8)), {.channels = {"acc"}});
  EXPECT_EQ(source->sample_rate_hz(), 51200.0);
  SampleBlock block;
  ASSERT_TRUE(source->next(10, block));
  EXPECT_EQ(block.samples, (std::vector<float>{1, -2, 3, -4}));
}

TEST(Npz, SaysWhatIsWrong) {
  const Folder folder;
  const auto says = [&](const std::string& content) {
    return rejection([&] { (void)read_record(folder.file("a.npz", content)); });
  };
  const std::string good = zip(hit(), 8);
  EXPECT_NE(says(good.substr(0, good.size() - 60)).find("is a damaged ZIP archive, or one that was cut off"),
            std::string::npos);
  EXPECT_NE(says(zip({{"readme.txt", "hello"}}, 0)).find("is an archive that holds no array of NumPy"),
            std::string::npos);
  std::string content = zip(hit(), 0);
  content[content.find("acc.npy") + 160] ^= 1;  // of its values
  EXPECT_NE(says(content).find("acc.npy: is damaged: its checksum is another"), std::string::npos) << says(content);
  const std::size_t first = good.find("PK\x01\x02");
  content = good;
  content[first + 8] = 1;
  EXPECT_NE(says(content).find("force_n.npy: is encrypted"), std::string::npos);
  content = good;
  content[first + 10] = 14;
  EXPECT_NE(says(content).find("is packed by method 14 of ZIP"), std::string::npos);
  // A small file must not ask for much: 40 MB of zeros in 40 kB, and a size that is not there.
  std::string zeros = npy("'|i1'", "(40000000,)", "");
  zeros.resize(zeros.size() + 40'000'000);
  EXPECT_NE(says(zip({{"x.npy", zeros}}, 8)).find("would take 320 MB of memory, more than a file of its size"),
            std::string::npos);
  content = good;
  content.replace(first + 24, 4, std::string(4, '\x7F'));
  EXPECT_NE(says(content).find("damaged ZIP archive"), std::string::npos);
  EXPECT_NE(says("PK").find("damaged ZIP archive"), std::string::npos);
}

// Mutated copies of valid files are read or rejected, never more.
TEST(Npz, SurvivesMutations) {
  const Folder folder;
  const std::string files[] = {zip(hit(), 0), zip(hit(), 8), zip(hit(), 8, true)};
  for (int seed = 0; seed < test::seeds(20000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = files[random.index(3)];
    const std::size_t from = random.index(2) == 0 ? 0 : content.find("PK\x01\x02");
    for (std::uint64_t i = random.index(5); i > 0; --i) {
      content[from + random.index(content.size() - from)] =
          static_cast<char>(random.index(3) == 0 ? 255 : random.index(256));
    }
    if (random.index(4) == 0) content.resize(random.index(content.size()) + 1);
    try {
      const Record record = read_record(folder.file("b.npz", content));
      for (const Eigen::VectorXd& column : record.columns) ASSERT_TRUE(column.allFinite());
      ASSERT_TRUE(std::isfinite(record.sample_rate_hz) && record.sample_rate_hz >= 0.0);
    } catch (const InvalidInput&) {
    }
  }
}

}  // namespace npz_test
}  // namespace robomill::io
