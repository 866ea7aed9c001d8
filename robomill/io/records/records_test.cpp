#include "robomill/io/records/records.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sndfile.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/records/uff.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace records_test {

using test::Folder;
using test::rejection;

TEST(Records, ReadsColumnsByNameAndNumber) {
  const Folder folder;
  const Record record = read_record(folder.file("a.csv", "time_s, force_n, 2\n0,1,7\n0.5,2,8\n1.0,3,9\n"));
  EXPECT_EQ(record.sample_rate_hz, 2.0);
  EXPECT_EQ(record.column("force_n"), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(record.column("1"), Eigen::Vector3d(0.0, 0.5, 1.0));
  // A column named "2" goes before the second column.
  EXPECT_EQ(record.column("2"), Eigen::Vector3d(7.0, 8.0, 9.0));
  for (const std::string none : {"4", "0", "-1", "x", "", "1.0", "99999999999999999999"}) {
    EXPECT_EQ(rejection([&] { (void)record.column(none); }),
              folder.at("a.csv").string() + ": has no column " + none + ". It has 3 columns: time_s, force_n, 2");
  }
  const Record twice = read_record(folder.file("b.csv", "a, a\n0,1\n"));
  EXPECT_NE(rejection([&] { (void)twice.column("a"); }).find("has several columns a"), std::string::npos);
}

TEST(Records, FindsTheSampleRate) {
  const Folder folder;
  const auto rate = [&](const std::string& content, const std::string& time = "") {
    return read_record(folder.file("a.txt", content), {.time = time}).sample_rate_hz;
  };
  EXPECT_EQ(rate("0 5\n0.25 6\n0.5 7\n", "1"), 4.0);
  EXPECT_EQ(rate("0 5\n0.25 6\n0.5 7\n"), 0.0);
  EXPECT_EQ(rate("Time (s)\tx\n0\t5\n0.25\t6\n0.5\t7\n"), 4.0);
  EXPECT_EQ(rate("clock;x\n0;5\n0,25;6\n0,5;7\n", "clock"), 4.0);
  // Rounding of the time to a fifth of a step is no jitter; a lost sample is.
  EXPECT_NEAR(rate("0.0 1\n0.1 1\n0.3 1\n0.4 1\n0.6 1\n0.7 1\n0.9 1\n1.0 1\n", "1"), 7.0, 1e-12);
  EXPECT_NE(rejection([&] { rate("0 5\n1 6\n2 7\n4 8\n5 9\n", "1"); }).find("does not run evenly: from 2 s to 4 s"),
            std::string::npos);
  EXPECT_NE(rejection([&] { rate("0 5\n-1 6\n", "1"); }).find("the time does not rise"), std::string::npos);
  EXPECT_NE(rejection([&] { rate("0 5\n", "1"); }).find("fewer than two samples"), std::string::npos);
}

TEST(Records, ReadsMatFiles) {
  const Folder folder;
  Eigen::MatrixXd block(3, 2);
  block << 1, 2, 3, 4, 5, 6;
  write_mat(folder.at("a.mat"), {{.name = "Fs", .re = Eigen::MatrixXd::Constant(1, 1, 51200.0)},
                                 {.name = "force_n", .re = Eigen::Vector3d(1, 2, 3)},
                                 {.name = "row", .re = Eigen::RowVector3d(4, 5, 6)},
                                 {.name = "block", .re = block},
                                 {.name = "H", .re = Eigen::Vector3d(1, 2, 3), .im = Eigen::Vector3d(1, 2, 3)}});
  const Record record = read_record(folder.at("a.mat"));
  EXPECT_EQ(record.sample_rate_hz, 51200.0);
  EXPECT_EQ(record.names, (std::vector<std::string>{"force_n", "row", "block(:,1)", "block(:,2)"}));
  EXPECT_EQ(record.column("row"), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(record.column("block(:,2)"), Eigen::Vector3d(2, 4, 6));
  EXPECT_EQ(record.notes.size(), 1u);
}

TEST(Records, TakesTheRateThatAFileStates) {
  const Folder folder;
  const auto rate = [&](const std::string& head) {
    return read_record(folder.file("a.txt", head + "force\tacc\n0\t1\n1\t2\n0\t3\n")).sample_rate_hz;
  };
  EXPECT_EQ(rate(""), 0.0);
  EXPECT_EQ(rate("Sampling rate: 25600 Hz\n"), 25600.0);
  EXPECT_EQ(rate("# Sample Rate [kHz] = 25.6\n"), 25600.0);
  EXPECT_EQ(rate("Fs\t51200\n"), 51200.0);
  EXPECT_NEAR(rate("Delta_X\t3,906250E-5\n"), 25600.0, 1e-6);
  EXPECT_NEAR(rate("dt = 0.2 ms\n"), 5000.0, 1e-9);
  EXPECT_EQ(rate("Samples\t32768\nOffset 0.5\n"), 0.0);
  // A column of time counts before what a header says.
  const Record timed = read_record(folder.file("b.csv", "sample rate,100\ntime_s,f\n0,1\n0.5,2\n1.0,3\n"));
  EXPECT_EQ(timed.sample_rate_hz, 2.0);
}

TEST(Records, WhatIsNotReadIsNamedWithWhatToDo) {
  const Folder folder;
  struct Unread {
    std::string name, what, remedy;
  };
  for (const Unread& unread : {Unread{"a.TDM", "a LabVIEW TDM file", "Export it as CSV"},
                               {"a.mf4", "an ASAM MDF file", "Export it as CSV"},
                               {"a.dwd", "a DynoWare file", "Export it as CSV"},
                               {"a.xlsx", "a spreadsheet", "save the sheet as CSV"},
                               {"a.xls", "a spreadsheet", "save the sheet as CSV"},
                               {"a.ods", "a spreadsheet", "save the sheet as CSV"},
                               {"a.mp3", "a compressed sound file", "record it as WAV"}}) {
    const std::string said = rejection([&] { (void)read_record(folder.file(unread.name, "0 1\n1 2\n")); });
    EXPECT_NE(said.find("is " + unread.what + ", which is not read yet"), std::string::npos) << said;
    EXPECT_NE(said.find(unread.remedy), std::string::npos) << said;
    EXPECT_FALSE(is_read_as_record(unread.name));
  }
  EXPECT_EQ(unread_record("a.csv").what, "");
}

/// The endings in a text: words of a point and letters.
std::vector<std::string> endings_in(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = text.find(" ."); at != std::string::npos; at = text.find(" .", at + 1)) {
    const std::size_t end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789", at + 2);
    if (end > at + 2) out.push_back(text.substr(at + 1, end - at - 1));
  }
  std::ranges::sort(out);
  return out;
}

// One list: what is read, what errors name, and what the documents say.
TEST(Records, EndingsAreTheSameEverywhere) {
  const std::vector<std::string> known = endings_in(" " + record_endings_text());
  ASSERT_EQ(known.size(), 16U);
  for (const std::string& ending : known) {
    EXPECT_TRUE(is_read_as_record("a" + ending)) << ending;
    EXPECT_EQ(unread_record("a" + ending).what, "") << ending;
  }
  const std::filesystem::path source(ROBOMILL_SOURCE_DIR);
  struct Place {
    const char *file, *before;
  };
  for (const Place& place : {Place{"docs/formats.md", "Files of measurement are"},
                             {"docs/formats.md", "Inputs:"},
                             {"robomill/io/README.md", "| `records/records.hpp` |"},
                             {"robomill/io/sample_source.hpp", "/// A file by its ending ("}}) {
    const std::string text = read_file(source / place.file);
    const std::size_t at = text.find(place.before);
    ASSERT_NE(at, std::string::npos) << place.before;
    std::string line = text.substr(at, text.find(place.before[0] == '/' ? "`format`" : "\n", at) - at);
    for (char& letter : line) {
      if (letter == '(' || letter == '`' || letter == '\n' || letter == '/') letter = ' ';
    }
    EXPECT_EQ(endings_in(line), known) << place.file << ": " << line;
  }
}

// Property: of a time that is rounded so far that values repeat the whole column gives the rate.
TEST(Records, ARoundedTimeHasARate) {
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    const double rate_hz = random.uniform(500.0, 50'000.0);
    const Eigen::Index n = 2000 + static_cast<Eigen::Index>(random.index(4000));
    Eigen::VectorXd time(n);
    for (Eigen::Index k = 0; k < n; ++k) time(k) = std::stod(fmt::format("{:.2e}", static_cast<double>(k) / rate_hz));
    EXPECT_NEAR(rounded_sample_rate_of(time) / rate_hz, 1.0, 2e-3) << rate_hz;
    for (Eigen::Index k = 0; k < n; ++k) time(k) = static_cast<double>(k) / rate_hz;
    EXPECT_EQ(rounded_sample_rate_of(time), 0.0) << "it is exact";
    time.tail(n / 2).array() += 0.3 * static_cast<double>(n) / rate_hz;
    EXPECT_EQ(rounded_sample_rate_of(time), 0.0) << "samples are missing";
  }
}

TEST(Records, ReadsUniversalFiles) {
  const Folder folder;
  UffFunction function;
  function.type = 1;
  function.abscissa = Eigen::VectorXd::LinSpaced(101, 0.0, 100.0 / 51200.0);
  function.values = Eigen::VectorXd::LinSpaced(101, -1.0, 1.0).cast<std::complex<double>>();
  function.numerator = {.type = 12, .label = "ax", .unit = "g"};
  UffFunction force = function;
  force.numerator = {.type = 13};
  force.id[0] = "force_n";
  write_file(folder.at("a.uff"), format_uff({function, force}, true));
  const Record record = read_record(folder.at("a.uff"));
  EXPECT_NEAR(record.sample_rate_hz, 51200.0, 1e-6);
  EXPECT_EQ(record.column("ax")(100), 9.80665);
  EXPECT_EQ(record.column("force_n")(100), 1.0);
  EXPECT_EQ(record.unit(0), "m/s^2");
  EXPECT_EQ(record.unit(1), "N");
  // Of another rate it stands in another record.
  force.abscissa *= 2.0;
  write_file(folder.at("a.uff"), format_uff({function, force}, false));
  const Record one = read_record(folder.at("a.uff"));
  EXPECT_EQ(one.names, std::vector<std::string>{"ax"});
  EXPECT_EQ(one.left_out, std::vector<std::string>{"force_n (25600 Hz, 101 samples)"});
}

/// A time response of four samples.
UffFunction response(double step, const std::string& label, int type, const std::string& unit) {
  UffFunction out;
  out.type = 1;
  out.abscissa = Eigen::VectorXd::LinSpaced(4, 0.0, 3.0 * step);
  out.values = Eigen::Vector4d(0, 1, -2, 3).cast<std::complex<double>>();
  out.abscissa_axis = {.type = 17, .label = "Time", .unit = "s"};
  out.numerator = {.type = type, .label = label, .unit = unit};
  return out;
}

TEST(Records, UniversalFilesSayUnitsAndNames) {
  const Folder folder;
  const auto read = [&](const std::vector<UffFunction>& functions, bool binary) {
    write_file(folder.at("a.uff"), format_uff(functions, binary));
    return read_record(folder.at("a.uff"));
  };
  UffFunction x = response(0.5, "Acceleration", 12, "mm/s²"), z = x, force = response(0.5, "NONE", 13, "NONE");
  x.response_node = z.response_node = 7;
  x.response_direction = 1;
  z.response_direction = -3;
  force.id[0] = "Hammer";
  for (const bool binary : {false, true}) {
    const Record record = read({x, z, force, response(0.5, "Mic", 0, "V")}, binary);
    EXPECT_NEAR(record.sample_rate_hz, 2.0, 1e-12);
    EXPECT_EQ(record.names, (std::vector<std::string>{"Acceleration 7+x", "Acceleration 7-z", "Hammer", "Mic"}));
    EXPECT_EQ(record.units, (std::vector<std::string>{"m/s^2", "m/s^2", "N", "V"}));
    EXPECT_NEAR(record.column("Acceleration 7-z")(3), 0.003, 1e-15);
    EXPECT_EQ(record.column("Hammer"), Eigen::Vector4d(0, 1, -2, 3));
  }
  // An abscissa in ms; one that is uneven, which the file stores as such; lines over frequency; another start.
  UffFunction in_ms = x, uneven = force, lines = force, later = force, pair = force;
  in_ms.abscissa *= 1000.0;
  in_ms.abscissa_axis.unit = "ms";
  uneven.abscissa(1) += 0.2;
  lines.abscissa_axis = {.type = 18, .label = "Frequency", .unit = "Hz"};
  later.abscissa.array() += 0.5;
  pair.is_complex = true;
  lines.id[0] = "Lines";
  later.id[0] = "Later";
  pair.id[0] = "Pair";
  const Record record = read({in_ms, uneven, lines, later, pair}, true);
  EXPECT_EQ(record.names, (std::vector<std::string>{"Acceleration", "Hammer"}));
  EXPECT_NEAR(record.sample_rate_hz, 2.0, 1e-9);
  EXPECT_EQ(record.left_out, (std::vector<std::string>{"Lines (over Hz)", "Later (2 Hz, 4 samples, starts 0.5 s later)",
                                                       "Pair (complex values)"}));
  uneven.abscissa(1) += 0.2;
  EXPECT_NE(rejection([&] { static_cast<void>(read({uneven}, false)); }).find("Hammer (the time does not run evenly"),
            std::string::npos);
}

TEST(Records, AUniversalFileWithoutAnyUnitIsTakenAsSi) {
  const Folder folder;
  const std::string text = format_uff({response(0.5, "Hammer", 13, "NONE")}, false);
  write_file(folder.at("a.uff"), text);
  EXPECT_FALSE(read_record(folder.at("a.uff")).si_assumed) << "data set 164 states SI";
  const std::string bare = text.substr(text.find("    -1\n    58"));
  write_file(folder.at("a.uff"), bare);
  EXPECT_TRUE(read_record(folder.at("a.uff")).si_assumed);
  EXPECT_EQ(read_record(folder.at("a.uff")).units, std::vector<std::string>{"N"});
  const std::string stated = format_uff({response(0.5, "Hammer", 13, "N")}, false);
  write_file(folder.at("a.uff"), stated.substr(stated.find("    -1\n    58")));
  EXPECT_FALSE(read_record(folder.at("a.uff")).si_assumed);
}

// Of a data type and a unit that contradict each other the unit counts, which has the factor.
TEST(Records, AUnitOfAUniversalFileCountsBeforeItsDataType) {
  const Folder folder;
  write_file(folder.at("a.uff"), format_uff({response(0.5, "Hammer", 12, "kN")}, false));
  const Record record = read_record(folder.at("a.uff"));
  EXPECT_EQ(record.column("Hammer"), Eigen::Vector4d(0, 1000, -2000, 3000));
  EXPECT_EQ(record.units, std::vector<std::string>{"N"});
  ASSERT_EQ(record.notes.size(), 1U);
  EXPECT_NE(record.notes[0].find("Warning: "), std::string::npos);
  EXPECT_NE(record.notes[0].find("its ordinate is of data type 12, and in \"kN\": the unit counts"), std::string::npos);
  // A sensor's voltage, whatever it is of.
  write_file(folder.at("a.uff"), format_uff({response(0.5, "Tip", 12, "mV")}, false));
  EXPECT_EQ(read_record(folder.at("a.uff")).units, std::vector<std::string>{"mV"});
  EXPECT_EQ(read_record(folder.at("a.uff")).column("Tip"), Eigen::Vector4d(0, 1, -2, 3));
}

void write_wav(const std::filesystem::path& path, int format, const std::vector<double>& frames, int channels) {
  SF_INFO info{.frames = 0,
               .samplerate = 10240,
               .channels = channels,
               .format = SF_FORMAT_WAV | format,
               .sections = 0,
               .seekable = 0};
  const std::unique_ptr<SNDFILE, decltype(&sf_close)> sound(sf_open(path.c_str(), SFM_WRITE, &info), &sf_close);
  sf_write_double(sound.get(), frames.data(), static_cast<sf_count_t>(frames.size()));
}

TEST(Records, ReadsWavWithItsScale) {
  const Folder folder;
  for (const auto& [format, tolerance] :
       {std::pair{SF_FORMAT_PCM_16, 1.0 / 32768}, {SF_FORMAT_PCM_24, 1.0 / 8388608}, {SF_FORMAT_DOUBLE, 0.0}}) {
    write_wav(folder.at("a.wav"), format, {0.5, -0.25, 0.125, 0.75, -0.5, 0.0}, 2);
    const Record record = read_record(folder.at("a.wav"), {.scale = 100.0});
    EXPECT_EQ(record.sample_rate_hz, 10240.0);
    ASSERT_EQ(record.columns.size(), 2u);
    EXPECT_NEAR((record.column("1") - 100.0 * Eigen::Vector3d(0.5, 0.125, -0.5)).cwiseAbs().maxCoeff(), 0.0,
                100.0 * tolerance);
    EXPECT_NEAR((record.column("2") - 100.0 * Eigen::Vector3d(-0.25, 0.75, 0.0)).cwiseAbs().maxCoeff(), 0.0,
                100.0 * tolerance);
  }
  EXPECT_NE(rejection([&] { (void)read_record(folder.at("a.wav"), {.scale = 0.0}); }).find("scale = 0"),
            std::string::npos);
}

TEST(Records, SaysThatASoundFileWasCutOff) {
  const Folder folder;
  write_wav(folder.at("a.wav"), SF_FORMAT_PCM_16, std::vector<double>(20480, 0.5), 2);
  EXPECT_TRUE(read_record(folder.at("a.wav")).notes.empty());
  const std::string whole = read_file(folder.at("a.wav"));
  const auto cut = folder.file("cut.wav", std::string_view(whole).substr(0, whole.size() - 20480));
  const Record record = read_record(cut);
  ASSERT_EQ(record.notes.size(), 1u);
  EXPECT_EQ(record.notes.front(),
            "Warning: " + cut.string() + " holds 0.5 s of the 1 s that its header states: it was cut off");
  EXPECT_EQ(record.columns.front().size(), 5120);
  // A recorder that was not stopped leaves a length of all that fits, or of none.
  const auto stated = [&](char byte) {
    std::string content = whole;
    std::fill_n(content.begin() + static_cast<std::ptrdiff_t>(whole.find("data")) + 4, 4, byte);
    return folder.file("stated.wav", content);
  };
  EXPECT_TRUE(read_record(stated('\xFF')).notes.empty());
  EXPECT_NE(rejection([&] {
              static_cast<void>(read_record(stated('\0')));
            }).find("states no samples, and 40960 bytes of them follow"),
            std::string::npos);
}

TEST(Records, SaysWhatIsWrong) {
  const Folder folder;
  const auto says = [&](const std::string& name, const std::string& content) {
    return rejection([&] { (void)read_record(folder.file(name, content)); });
  };
  EXPECT_NE(says("a.csv", "t,x\n0,1\n1,nan\n").find("a.csv:3: x = \"nan\"; must be a finite number"),
            std::string::npos);
  EXPECT_NE(says("a.pdf", "PK").find("is no record by its ending"), std::string::npos);
  EXPECT_NE(says("a.wav", "RIFF").find("is no sound file"), std::string::npos);
  EXPECT_NE(says("a.mat", "hello, this is no MAT file").find("is no MAT file"), std::string::npos);
  EXPECT_NE(says("a.mat", "").find("is empty"), std::string::npos);
  EXPECT_NE(rejection([&] { (void)read_record(folder.at("none.wav")); }).find("there is no such file"),
            std::string::npos);
}

/// Mutated copies of a valid file are read or rejected, never more.
void survive(const std::string& name, const std::string& original, int count, std::size_t from = 0) {
  const Folder folder;
  for (int seed = 0; seed < test::seeds(count); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string content = original;
    for (std::uint64_t i = random.index(5); i > 0; --i) {
      content[from + random.index(content.size() - from)] =
          static_cast<char>(random.index(4) == 0 ? 255 : random.index(256));
    }
    if (random.index(3) == 0) content.resize(random.index(content.size()) + 1);
    try {
      const Record record = read_record(folder.file(name, content));
      for (const Eigen::VectorXd& column : record.columns) ASSERT_TRUE(column.allFinite());
    } catch (const InvalidInput&) {
    }
  }
}

TEST(Records, SurvivesMutatedSounds) {
  const Folder folder;
  write_wav(folder.at("a.wav"), SF_FORMAT_PCM_16, {0.5, -0.25, 0.125, 0.75, -0.5, 0.0}, 2);
  survive("b.wav", read_file(folder.at("a.wav")), 2000);
}

TEST(Records, SurvivesMutatedMatFiles) {
  const Folder folder;
  write_mat(folder.at("a.mat"), {{.name = "time_s", .re = Eigen::VectorXd::LinSpaced(50, 0.0, 1.0)},
                                 {.name = "force_n", .re = Eigen::VectorXd::Random(50)}});
  survive("b.mat", read_file(folder.at("a.mat")), 2000, 116);
}

}  // namespace records_test
}  // namespace robomill::io
