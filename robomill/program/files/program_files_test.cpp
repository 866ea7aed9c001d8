#include "robomill/program/files/program_files.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/program/files/program_lines.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace program_files_test {

bool same(const Block& a, const Block& b) {
  return a.kind == b.kind && a.line == b.line && a.end.tip_m == b.end.tip_m && a.end.axis == b.end.axis &&
         a.duration_s == b.duration_s && a.spindle_speed_rad_per_s == b.spindle_speed_rad_per_s;
}

/// Straight moves, arcs, dwells, words left out and axes a little off, longer than any buffer.
std::string long_program(std::size_t lines) {
  Random random(51);
  std::string text = "%\nG0 X0 Y0 Z0 A0 C0 S1000\nF600\n";
  for (std::size_t i = 0; i < lines; ++i) {
    switch (random.index(12)) {
      case 0:
        text += fmt::format("G91 G2 X0 Y0 I{:.3f} A1\n", random.uniform(0.1, 2.0));
        break;
      case 1:
        text += "G4 P0.1 M48\n";
        break;
      case 2:
        text += fmt::format("G90 G0 X{:.3f} ~\nY{:.3f}\n", random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
        break;
      default:
        text += fmt::format("G90 G1 X{:.3f} Y{:.3f} Z{:.3f} A{:.3f} C{:.3f}\n", random.uniform(-9.0, 9.0),
                            random.uniform(-9.0, 9.0), random.uniform(0.0, 9.0), random.uniform(0.0, 60.0),
                            random.uniform(0.0, 90.0));
    }
  }
  return text;
}

TEST(ProgramFiles, StreamedAndWholeAreTheSameAndAgainAfterRewinding) {
  const test::Folder folder;
  const auto path = folder.file("part.ngc", long_program(20000));
  const ProgramReading reading = {.machine = Machine::xyzac_trt, .chord_tolerance_m = 1e-5};
  const Program whole = read_program(path, reading);
  ASSERT_GT(whole.blocks.size(), 20000U);
  ASSERT_GT(whole.skipped.size(), 1000U) << "all of them";
  const std::unique_ptr<ProgramFile> file = open_program(path, reading);
  EXPECT_EQ(file->start().tip_m, whole.start.tip_m);
  Block block;
  for (const std::size_t stop : {std::size_t{5000}, whole.blocks.size()}) {
    for (std::size_t i = 0; i < stop; ++i) {
      ASSERT_TRUE(file->next(block)) << i;
      ASSERT_TRUE(same(block, whole.blocks[i])) << i;
    }
    if (stop == whole.blocks.size()) {
      EXPECT_FALSE(file->next(block));
      EXPECT_FALSE(file->next(block));
    }
    file->rewind();
  }
  EXPECT_EQ(file->remarks().skipped_count, whole.skipped.size()) << "reported once, however often it is read";
  const std::vector<Skipped> skipped = file->remarks().skipped;
  ASSERT_EQ(skipped.size(), 500U);
  for (std::size_t i = 0; i < 500; ++i) EXPECT_EQ(skipped[i].line, whole.skipped[i].line);
}

TEST(ProgramFiles, NotesAreReportedOnceToo) {
  const test::Folder folder;
  const auto file = open_program(folder.file("part.apt", "FEDRAT/9\nGOTO/0,0,0,0,0,.9995\nGOTO/1,0,0,0,0,.9998\n"));
  ASSERT_EQ(file->remarks().notes.size(), 1U) << "of the start";
  Block block;
  for (int pass = 0; pass < 3; ++pass) {
    while (file->next(block)) {
    }
    file->rewind();
    EXPECT_EQ(file->remarks().notes.at(0), "2 axes made a unit vector, off by up to 0.0005, the first in line 2.");
  }
}

TEST(ProgramFiles, TheEndingDeterminesTheFormat) {
  EXPECT_EQ(program_format_of("a.APT"), ProgramFormat::apt);
  EXPECT_EQ(program_format_of("a.cls"), ProgramFormat::apt);
  for (const char* name : {"a.cl", "a.ncl", "a.AptSource"}) EXPECT_EQ(program_format_of(name), ProgramFormat::apt);
  EXPECT_EQ(program_format_of("a.Csv"), ProgramFormat::csv);
  for (const char* name : {"a.ngc", "a.nc", "a.gcode", "a.tap", "a", "apt"}) {
    EXPECT_EQ(program_format_of(name), ProgramFormat::gcode) << name;
  }
  const test::Folder folder;
  const auto path = folder.file("part.txt", "GOTO/1,2,3\n");
  EXPECT_EQ(read_program(path, {.format = ProgramFormat::apt}).start.tip_m.z(), 3e-3);
}

// One program in three languages.
TEST(ProgramFiles, TheThreeFormatsGiveTheSame) {
  Random random(52);
  std::string gcode = "G0 X0 Y0 Z0 I0 J0 K1\n";
  std::string apt = "GOTO/0,0,0,0,0,1\n";
  std::string csv = "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n0,0,0,0,0,1,\n";
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d tip(random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
    const Eigen::Vector3d axis = Eigen::Vector3d(random.normal(), random.normal(), 5.0).normalized();
    const double feed = random.uniform(1.0, 9000.0);
    gcode += fmt::format("G1 X{:.9f} Y{:.9f} Z{:.9f} I{:.12f} J{:.12f} K{:.12f} F{:.6f}\n", tip.x(), tip.y(), tip.z(),
                         axis.x(), axis.y(), axis.z(), feed);
    apt += fmt::format("FEDRAT/MMPM,{:.6f}\nGOTO/{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f}\n", feed, tip.x(),
                       tip.y(), tip.z(), axis.x(), axis.y(), axis.z());
    csv += fmt::format("{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.6f}\n", tip.x(), tip.y(), tip.z(), axis.x(),
                       axis.y(), axis.z(), feed);
  }
  const test::Folder folder;
  const Program a = read_program(folder.file("part.ngc", gcode));
  const Program b = read_program(folder.file("part.apt", apt));
  const Program c = read_program(folder.file("part.csv", csv));
  ASSERT_EQ(a.blocks.size(), 300U);
  ASSERT_EQ(b.blocks.size(), 300U);
  ASSERT_EQ(c.blocks.size(), 300U);
  for (std::size_t i = 0; i < 300; ++i) {
    EXPECT_EQ(a.blocks[i].end.tip_m, b.blocks[i].end.tip_m);
    EXPECT_EQ(a.blocks[i].end.axis, b.blocks[i].end.axis);
    EXPECT_EQ(a.blocks[i].end.tip_m, c.blocks[i].end.tip_m);
    EXPECT_EQ(a.blocks[i].end.axis, c.blocks[i].end.axis);
    EXPECT_NEAR(a.blocks[i].duration_s, b.blocks[i].duration_s, 1e-12 * a.blocks[i].duration_s);
    EXPECT_NEAR(a.blocks[i].duration_s, c.blocks[i].duration_s, 1e-12 * a.blocks[i].duration_s);
  }
}

// Lines of every length about the end of the buffer.
TEST(ProgramFiles, LinesAreWholeWhereverTheBufferEnds) {
  Random random(53);
  std::string text = "\xEF\xBB\xBF";
  std::vector<std::string> lines;
  for (std::size_t bytes = 0; bytes < 2000000;) {
    const std::size_t longest = random.index(20) == 0 ? ProgramLines::longest : 80;
    std::string line(random.index(longest + 1), 'x');
    if (!line.empty()) line.back() = static_cast<char>('a' + random.index(26));
    if (!line.empty()) line.front() = static_cast<char>('a' + random.index(26));
    bytes += line.size();
    text += line + (random.index(2) == 0 ? "\n" : "\r\n");
    lines.push_back(std::move(line));
  }
  const test::Folder folder;
  ProgramLines read(folder.file("text", text));
  for (int pass = 0; pass < 2; ++pass) {
    std::string_view line;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      ASSERT_TRUE(read.next(line));
      ASSERT_EQ(line, lines[i]) << i;
      const bool has_next = i + 1 < lines.size() && !lines[i + 1].empty();
      if (has_next) {
        ASSERT_EQ(read.ahead(), lines[i + 1].front()) << i;
      }
    }
    EXPECT_EQ(read.ahead(), '\n');
    EXPECT_FALSE(read.next(line));
    read.rewind();
  }
}

TEST(ProgramFiles, RejectsWhatIsNoProgram) {
  const test::Folder folder;
  const auto says = [&](const std::filesystem::path& path, const std::string& words, const ProgramReading& how = {}) {
    const std::string said = test::rejection([&] { static_cast<void>(open_program(path, how)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  says(folder.at("none.ngc"), "none.ngc: there is no such file");
  says(folder.path(), "is a folder, not a file");
  says(folder.file("empty.ngc", ""), "empty.ngc: is empty");
  says(folder.file("binary.cl", std::string("CL\0\1", 4)), "binary.cl: is no plain text. Is it a binary file?");
  says(folder.file("wide.ngc", std::string("\xFF\xFEG\0", 4)), "It is UTF-16: save it as UTF-8");
  says(folder.file("line.ngc", "G0 X0\n" + std::string(40000, ' ') + "\n"),
       "line.ngc:2: is a line of more than 32768 bytes");
  says(folder.file("end.ngc", std::string(32769, ' ')), "end.ngc:1: is a line of more than 32768 bytes");
  says(folder.file("no.ngc", "G0 X0\n"), "no.ngc: holds no complete position");
  says(folder.file("good.ngc", "G0 X0 Y0 Z0\n"), "chord_tolerance_m = 0 m; must be >= 1e-9 and < 1",
       {.chord_tolerance_m = 0.0});
}

// A pipe can be read once.
TEST(ProgramFiles, ReadsAPipeButNotTwice) {
  const test::Folder folder;
  const std::filesystem::path path = folder.at("pipe.ngc");
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  std::jthread writer([&] { std::ofstream(path) << "G0 X0 Y0 Z0\nG1 X1 F60\n"; });
  const auto file = open_program(path);
  Block block;
  EXPECT_TRUE(file->next(block));
  EXPECT_FALSE(file->next(block));
  const std::string said = test::rejection([&] { file->rewind(); });
  EXPECT_NE(said.find("pipe.ngc: cannot be read a second time"), std::string::npos) << said;
}

}  // namespace program_files_test
}  // namespace robomill::program
