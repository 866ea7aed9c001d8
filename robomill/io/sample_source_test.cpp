#include "robomill/io/sample_source.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sndfile.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/mat.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace sample_source_test {

std::vector<float> all(SampleSource& source, std::size_t frames = 7) {
  std::vector<float> samples;
  SampleBlock block;
  while (source.next(frames, block)) samples.insert(samples.end(), block.samples.begin(), block.samples.end());
  return samples;
}

std::vector<float> read(const std::filesystem::path& path, const SampleColumns& columns,
                        RawFormat format = RawFormat::automatic) {
  return all(*open_samples(path, columns, format));
}

std::string rejection(const std::filesystem::path& path, const SampleColumns& columns) {
  return test::rejection([&] { (void)open_samples(path, columns); });
}

SampleColumns named(std::vector<std::string> channels) {
  return {.channels = std::move(channels)};
}

TEST(SampleSource, ReadsColumnsByNameOrNumber) {
  const test::Folder folder;
  const auto csv = folder.file("r.csv", "time_s,ax,ay,pulse\n0,1,10,0\n0.1,2,20,1\n0.2,3,30,0\n");
  EXPECT_EQ(read(csv, named({"ay", "ax"})), (std::vector<float>{10, 1, 20, 2, 30, 3}));
  EXPECT_EQ(read(csv, named({"3", "2"})), (std::vector<float>{10, 1, 20, 2, 30, 3}));
  EXPECT_EQ(read(csv, named({"ax", "pulse"})), (std::vector<float>{1, 0, 2, 1, 3, 0}));
  EXPECT_DOUBLE_EQ(open_samples(csv, named({"ax"}))->sample_rate_hz(), 10.0);
}

TEST(SampleSource, TakesTheUnitOfTheTimeFromARowOfUnits) {
  const test::Folder folder;
  const auto csv = folder.file("r.csv", "Time,ax\nms,g\n0,1\n0.5,2\n1,3\n");
  EXPECT_EQ(read(csv, named({"ax"})), (std::vector<float>{1, 2, 3}));
  EXPECT_DOUBLE_EQ(open_samples(csv, named({"ax"}))->sample_rate_hz(), 2000.0);
  EXPECT_NE(rejection(folder.file("s.csv", "Time,ax\n(ms),(foo)\n0,1\n"), named({"ax"})).find("ax = \"foo\""),
            std::string::npos);
}

TEST(SampleSource, ReadsTextOfManyKinds) {
  const test::Folder folder;
  EXPECT_EQ(read(folder.file("a.csv", "1\n2\n3\n"), named({"ax_m_per_s2"})), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(read(folder.file("b.csv", "1\r\n2\r\n3"), named({"1"})), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(read(folder.file("c.csv", "x;y\n1,5;2\n-2,5;3\n"), named({"x"})), (std::vector<float>{1.5F, -2.5F}));
  EXPECT_EQ(read(folder.file("d.txt", "# made by a tester\nx y\nm m\n 1  2\n\n 3\t4 \n"), named({"y"})),
            (std::vector<float>{2, 4}));
  EXPECT_EQ(read(folder.file("e.csv", "\xEF\xBB\xBF\"a x\",\"b\"\n\"1\",\"2\"\n"), named({"a x"})),
            (std::vector<float>{1}));
}

// What a table rejects, a monitor lives through.
TEST(SampleSource, RowsThatCannotBeReadAreNaN) {
  const test::Folder folder;
  const auto csv = folder.file("r.csv", "a,b\n1,2\nnan,3\n,4\n5\nx,6\n7,y\n8,9\n");
  const auto source = open_samples(csv, named({"a"}));
  const std::vector<float> samples = all(*source);
  ASSERT_EQ(samples.size(), 7U);
  const std::vector<bool> is_nan = {false, true, true, true, true, false, false};
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_EQ(std::isnan(samples[i]), is_nan[i]) << i;
  EXPECT_EQ(samples.back(), 8.0F);
  EXPECT_EQ(source->unreadable_rows(), 2U);
  EXPECT_EQ(source->first_unreadable_line(), 5U);
}

TEST(SampleSource, FollowsAColumn) {
  const test::Folder folder;
  const auto csv = folder.file("r.csv", "a,speed_rpm\n1,3000\n2,3001\n3,\n4,4500\n");
  const auto source = open_samples(csv, {.channels = {"a"}, .followed = "speed_rpm", .followed_factor = units::rpm});
  SampleBlock block;
  std::vector<double> rpm;
  while (source->next(1, block)) rpm.push_back(std::round(block.followed / units::rpm));
  EXPECT_EQ(rpm, (std::vector<double>{3000, 3001, 3001, 4500}));
}

TEST(SampleSource, ReportsWhatIsWrong) {
  const test::Folder folder;
  const auto csv = folder.file("r.csv", "time_s,ax,ay\n0,1,10\n0.1,2,20\n0.2,3,30\n");
  EXPECT_NE(rejection(csv, named({"az"})).find("has no column az. It has 3 columns: time_s, ax, ay"), std::string::npos)
      << rejection(csv, named({"az"}));
  EXPECT_NE(rejection(csv, named({"4"})).find("has no column 4"), std::string::npos);
  EXPECT_NE(rejection(csv, named({"ax", "2"})).find("would be two channels"), std::string::npos);
  SampleColumns fast = named({"ax"});
  fast.sample_rate_hz = 20.0;
  EXPECT_NE(rejection(csv, fast).find("was sampled at 10 Hz, not at signal.sample_rate_hz = 20 Hz"), std::string::npos);
  EXPECT_NE(rejection(folder.file("two.csv", "1,2\n3,4\n"), named({"ax"})).find("has no column ax"), std::string::npos);
  EXPECT_NE(rejection(folder.file("words.csv", "no\nnumbers\n"), named({"1"})).find("holds no line of numbers"),
            std::string::npos);
  EXPECT_NE(rejection(folder.at("none.wav"), named({"1"})).find("none.wav"), std::string::npos);
  EXPECT_NE(rejection(folder.file("r.step", "1\n"), named({"1"})).find("is no recording by its ending"),
            std::string::npos);
  EXPECT_NE(rejection(folder.file("bad.wav", "RIFF, or not"), named({"1"})).find("is no sound file"),
            std::string::npos);
  EXPECT_NE(rejection(folder.path(), named({"1"})).find("folder"), std::string::npos)
      << rejection(folder.path(), named({"1"}));
}

TEST(SampleSource, WavComesBackAsWritten) {
  const test::Folder folder;
  const std::vector<float> samples = {0.5F, -1.5F, 100.0F, 1e-20F, NAN, -3.0F};
  write_wav(folder.at("a.wav"), samples, 2, 10240.0);
  std::ifstream file(folder.at("a.wav"), std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(file), {});
  EXPECT_EQ(bytes.find("PEAK"), std::string::npos);  // which would hold the time of writing
  const auto source = open_samples(folder.at("a.wav"), named({"ax", "ay"}));
  EXPECT_EQ(source->sample_rate_hz(), 10240.0);
  EXPECT_EQ(source->full_scale(), 0.0);
  const std::vector<float> back = all(*source, 2);
  ASSERT_EQ(back.size(), samples.size());
  EXPECT_EQ(std::memcmp(back.data(), samples.data(), 4 * samples.size()), 0);
  EXPECT_EQ(read(folder.at("a.wav"), named({"1"})).at(1), 100.0F);
  SampleColumns other = named({"1"});
  other.sample_rate_hz = 5000.0;
  EXPECT_NE(rejection(folder.at("a.wav"), other).find("was sampled at 10240 Hz"), std::string::npos);
  EXPECT_NE(rejection(folder.at("a.wav"), named({"ax"})).find("It has 2 columns"), std::string::npos);
  EXPECT_THROW(write_wav(folder.at("b.wav"), samples, 2, 10240.5), InvalidInput);
}

TEST(SampleSource, IntegersAreScaledAndClipAtTheirFullScale) {
  const test::Folder folder;
  SF_INFO info{};
  info.samplerate = 5000;
  info.channels = 1;
  info.format = SF_FORMAT_WAV | SF_FORMAT_PCM_16;
  const std::vector<short> shorts = {0, 16384, -32768, 32767};
  SNDFILE* sound = sf_open(folder.at("i.wav").c_str(), SFM_WRITE, &info);
  ASSERT_NE(sound, nullptr);
  sf_write_short(sound, shorts.data(), 4);
  sf_close(sound);
  SampleColumns scaled = named({"1"});
  scaled.scale = 50.0;
  const auto wav = open_samples(folder.at("i.wav"), scaled);
  const double full = 50.0 * 32767.0 / 32768.0;
  EXPECT_DOUBLE_EQ(wav->full_scale(), full);
  EXPECT_EQ(all(*wav), (std::vector<float>{0.0F, 25.0F, -50.0F, static_cast<float>(full)}));
  const auto raw = folder.file("i.raw", std::string(reinterpret_cast<const char*>(shorts.data()), 8));
  const auto source = open_samples(raw, scaled, RawFormat::int16);
  EXPECT_DOUBLE_EQ(source->full_scale(), full);
  EXPECT_EQ(all(*source), (std::vector<float>{0.0F, 25.0F, -50.0F, static_cast<float>(full)}));
}

TEST(SampleSource, ThatCannotBeWrittenLeavesTheOldOne) {
  const test::Folder folder;
  const std::vector<float> samples(4000, 0.5F);
  write_wav(folder.at("a.wav"), samples, 2, 5000.0);
  const std::size_t size = read_file(folder.at("a.wav")).size();
  for (const std::size_t room : {std::size_t{0}, std::size_t{20}, size / 2, size - 1}) {
    const auto path = folder.file("a.wav", "old");
    const test::FileSizeLimit full(room);
    EXPECT_NE(test::rejection([&] { write_wav(path, samples, 2, 5000.0); }).find("a.wav: cannot be written"),
              std::string::npos)
        << room;
    EXPECT_EQ(read_file(path), "old");
  }
  EXPECT_EQ(folder.count(), 1U);
}

// What its file says of a recording comes with it.
TEST(SampleSource, SaysThatARecordingWasCutOff) {
  const test::Folder folder;
  write_wav(folder.at("a.wav"), std::vector<float>(4000, 0.5F), 1, 4000.0);
  const std::string whole = read_file(folder.at("a.wav"));
  EXPECT_TRUE(open_samples(folder.at("a.wav"), named({"1"}))->notes().empty());
  const auto cut = folder.file("cut.wav", std::string_view(whole).substr(0, whole.size() - 8000));
  const auto source = open_samples(cut, named({"1"}));
  ASSERT_EQ(source->notes().size(), 1U);
  EXPECT_NE(source->notes().front().find("holds 0.5 s of the 1 s that its header states"), std::string::npos);
  EXPECT_EQ(all(*source).size(), 2000U);
  for (std::size_t bytes = 1; bytes <= 4; ++bytes) {  // of the last frame
    const auto short_one = folder.file("cut.wav", std::string_view(whole).substr(0, whole.size() - bytes));
    EXPECT_EQ(open_samples(short_one, named({"1"}))->notes().size(), 1U) << bytes;
  }
}

TEST(SampleSource, ReadsMat) {
  const test::Folder folder;
  write_mat(folder.at("m.mat"), {{"ax", Eigen::Vector3d(1, 2, 3)},
                                 {"ay", Eigen::Vector3d(4, 5, 6)},
                                 {"sample_rate_hz", Eigen::MatrixXd::Constant(1, 1, 5000.0)}});
  EXPECT_EQ(read(folder.at("m.mat"), named({"ay", "ax"})), (std::vector<float>{4, 1, 5, 2, 6, 3}));
  EXPECT_EQ(open_samples(folder.at("m.mat"), named({"ay"}))->sample_rate_hz(), 5000.0);
}

// One recording in two files is that in one.
TEST(SampleSource, JoinsChannelsThatAreApart) {
  const test::Folder folder;
  std::string whole = "time_s,ax,ay\n", x = "time_s,ax\n", y = "time_s,ay\n";
  for (int i = 0; i < 50; ++i) {
    const std::string time = std::to_string(0.25 * i);
    whole += time + "," + std::to_string(i) + "," + std::to_string(-i) + "\n";
    x += time + "," + std::to_string(i) + "\n";
    y += time + "," + std::to_string(-i) + "\n";
  }
  const auto together = folder.file("whole.csv", whole), a = folder.file("x.csv", x), b = folder.file("y.csv", y);
  const auto source = open_samples({a, b}, named({"ay", "ax"}));
  EXPECT_EQ(source->sample_rate_hz(), 4.0);
  EXPECT_EQ(all(*source), read(together, named({"ay", "ax"})));
  EXPECT_EQ(all(*open_samples({a, b}, named({"y.csv:2", "ax"}))), read(together, named({"ay", "ax"})));
  EXPECT_EQ(all(*open_samples(std::vector{together}, named({"ax"}))), read(together, named({"ax"})));
  // Sound names nothing: its columns in their order.
  write_wav(folder.at("x.wav"), {1, 2, 3}, 1, 8.0);
  write_wav(folder.at("y.wav"), {4, 5, 6, 7}, 1, 8.0);
  const auto sound = open_samples({folder.at("x.wav"), folder.at("y.wav")}, named({"ax", "ay"}));
  EXPECT_EQ(all(*sound), (std::vector<float>{1, 4, 2, 5, 3, 6}));
  EXPECT_EQ(sound->notes().size(), 2U) << "they begin together, and one is longer";
  const auto says = [&](const std::vector<std::filesystem::path>& files, const SampleColumns& columns,
                        const std::string& part) {
    const std::string said = test::rejection([&] { (void)open_samples(files, columns); });
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  says({folder.at("x.wav"), folder.at("y.wav")}, named({"1"}), "column 1 may be of any of the files");
  says({a, b}, named({"ax", "x.csv:2"}), "column 2 would be two channels, x.csv:2 among them");
  says({a, b}, named({"az"}), "have no column az. x.csv has time_s, ax; y.csv has time_s, ay");
  says({a, folder.at("x.wav")}, named({"ax"}), "x.wav: was sampled at 8 Hz, and x.csv at 4 Hz");
  says({a, b}, {.channels = {"ax"}, .sample_rate_hz = 5.0}, "was sampled at 4 Hz, not at signal.sample_rate_hz = 5 Hz");
  says({a, folder.at("none.csv")}, named({"ax"}), "none.csv");
  says({}, named({"ax"}), "files: must name one at least");
}

TEST(SampleSource, HoldsWholeWhatIsNotReadInBlocks) {
  const test::Folder folder;
  for (const char* name : {"a.mat", "a.npz", "a.h5", "a.tdms", "a.uff"}) EXPECT_TRUE(is_held_whole(name)) << name;
  EXPECT_FALSE(is_held_whole("a.wav"));
  EXPECT_FALSE(is_held_whole("a.raw"));
  EXPECT_FALSE(is_held_whole(folder.file("a.csv", "1\n2\n")));
  EXPECT_TRUE(is_held_whole(folder.file("a.txt", "LabVIEW Measurement\t\n")));
}

/// A pipe whose other end is written by a thread, some bytes at a time.
class Pipe {
 public:
  explicit Pipe(std::string bytes, std::size_t step = 3) {
    EXPECT_EQ(::pipe(ends_), 0);
    thread_ = std::jthread([this, bytes = std::move(bytes), step] {
      for (std::size_t at = 0; at < bytes.size(); at += step) {
        const std::size_t count = std::min(step, bytes.size() - at);
        if (::write(ends_[1], bytes.data() + at, count) != static_cast<ssize_t>(count)) break;
      }
      ::close(ends_[1]);
    });
  }
  ~Pipe() {
    thread_.join();
    ::close(ends_[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  [[nodiscard]] int end() const { return ends_[0]; }

 private:
  int ends_[2] = {-1, -1};
  std::jthread thread_;
};

TEST(SampleSource, TakesBytesAsTheyCome) {
  Random random(3);
  std::vector<float> samples;
  for (int i = 0; i < 600; ++i) samples.push_back(static_cast<float>(random.normal()));
  const std::string bytes(reinterpret_cast<const char*>(samples.data()), 4 * samples.size());
  for (const std::size_t step : {std::size_t{1}, std::size_t{5}, std::size_t{4096}}) {
    const Pipe pipe(bytes, step);
    EXPECT_EQ(all(*open_sample_stream(pipe.end(), "standard input", named({"a", "b"}), RawFormat::automatic), 64),
              samples);
  }
  {
    const Pipe cut(bytes.substr(0, 4 * 10 + 3));  // ends within a sample
    EXPECT_EQ(all(*open_sample_stream(cut.end(), "standard input", named({"a"}), RawFormat::float32)).size(), 10U);
  }
  const Pipe text("ax,ay\n1,2\n3,4\n", 1);
  EXPECT_EQ(all(*open_sample_stream(text.end(), "standard input", named({"ay"}), RawFormat::automatic)),
            (std::vector<float>{2, 4}));
}

// A peer that closes with bytes unread resets the connection: what came is no whole recording.
TEST(SampleSource, AReadThatFailsIsNoEnd) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  ASSERT_EQ(::write(ends[1], "ax,ay\n1,2\n3,4\n", 14), 14);
  ASSERT_EQ(::write(ends[0], "unread", 6), 6);
  ::close(ends[1]);
  std::vector<float> samples;
  const std::string text = test::rejection([&] {
    const auto source = open_sample_stream(ends[0], "standard input", named({"ax", "ay"}), RawFormat::csv);
    SampleBlock block;
    while (source->next(1, block)) samples.insert(samples.end(), block.samples.begin(), block.samples.end());
  });
  ::close(ends[0]);
  EXPECT_EQ(text, "standard input: cannot be read to its end. Connection reset by peer");
  EXPECT_EQ(samples, (std::vector<float>{1, 2, 3, 4}));
}

// A writer that writes at once would be ended by a first reader that goes.
TEST(SampleSource, OpensANamedPipeOnce) {
  const test::Folder folder;
  const std::filesystem::path pipe = folder.at("pipe.csv");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  constexpr int rows = 5000;
  int written = 0;
  std::atomic<bool> done{false};
  std::jthread writer([&] {
    int end = -1;
    while ((end = ::open(pipe.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC)) < 0) {
    }
    ::fcntl(end, F_SETFL, 0);  // from here on it waits
    while (written < rows && ::write(end, "1,2\n", 4) == 4) ++written;
    ::close(end);
    while (!done) ::close(::open(pipe.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));  // a second reader would wait
  });
  std::vector<float> samples;
  EXPECT_NO_THROW(samples = read(pipe, named({"1"})));
  done = true;
  writer.join();
  std::signal(SIGPIPE, before);
  EXPECT_EQ(written, rows);
  EXPECT_EQ(samples.size(), static_cast<std::size_t>(rows));
}

TEST(SampleSource, NumbersPickAmongRawColumns) {
  const std::vector<float> samples = {1, 2, 3, 4, 5, 6};
  const std::string bytes(reinterpret_cast<const char*>(samples.data()), 24);
  {
    const Pipe pipe(bytes);
    EXPECT_EQ(all(*open_sample_stream(pipe.end(), "-", named({"3"}), RawFormat::float32)), (std::vector<float>{3, 6}));
  }
  SampleColumns of_two = named({"1"});
  of_two.raw_columns = 2;
  const Pipe pipe(bytes);
  EXPECT_EQ(all(*open_sample_stream(pipe.end(), "-", of_two, RawFormat::float32)), (std::vector<float>{1, 3, 5}));
}

// A pipe that stays open gives its reader back when asked to stop.
TEST(SampleSource, StopsWhileItWaits) {
  int ends[2] = {-1, -1};
  ASSERT_EQ(::pipe(ends), 0);
  std::atomic<bool> stop{false};
  bool more = true;
  {
    const std::jthread reader([&] {
      SampleBlock block;
      more = open_sample_stream(ends[0], "-", named({"1"}), RawFormat::float32, &stop)->next(16, block);
    });
    stop = true;
  }
  EXPECT_FALSE(more);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST(SampleSource, SurvivesAnyText) {
  const test::Folder folder;
  Random random(5);
  const std::string good = "time_s;ax;spindle_speed_rpm\n0;1,5;3000\n0,1;2;3000\n0,2;-3e-2;3000\n";
  const std::string letters = "0123456789.,;\t\n\r\"#eE+-nax \xC3\x00";
  int rows = 0;
  for (int round = 0; round < test::seeds(4000); ++round) {
    std::string text = good;
    const int changes = 1 + static_cast<int>(random.index(6));
    for (int i = 0; i < changes; ++i) text[random.index(text.size())] = letters[random.index(letters.size())];
    try {
      const SampleColumns columns = {.channels = {"ax"}, .followed = "spindle_speed_rpm"};
      rows += static_cast<int>(read(folder.file("f.csv", text), columns).size());
    } catch (const InvalidInput&) {
    }
  }
  EXPECT_GT(rows, 0);
}

}  // namespace sample_source_test
}  // namespace robomill::io
