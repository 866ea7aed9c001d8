// No file leads out of the folder that is served: whatever it is a link to, and whatever it names.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/io/stl.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/io/system/sandbox.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/robot/files/urdf.hpp"
#include "robomill/serve/files/inspect.hpp"
#include "robomill/serve/jobs/verbs.hpp"
#include "robomill/serve/process/work.hpp"
#include "testing/serve/slot.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace escape_test {

namespace fs = std::filesystem;
using test::rejection;

constexpr const char* secret = "SECRET42";
constexpr const char* outside = "outside the folder that is served";

/// A folder that is served, and beside it what must not be read.
class Escape : public ::testing::Test {
 protected:
  Escape() {
    fs::create_directories(root());
    file("cut.toml", lobes_with("[dynamics]", "[lobes]", ""));
  }
  [[nodiscard]] fs::path root() const { return place_.at("served"); }
  fs::path file(const std::string& name, const std::string& text) const { return place_.file("served/" + name, text); }
  /// lobes.toml with another text from one table up to the next.
  static std::string lobes_with(const std::string& from, const std::string& to, const std::string& text) {
    std::string out = test::slot_lobes;
    out.replace(out.find(from), out.find(to) - out.find(from), text);
    return out;
  }
  /// What a verb says of a file in the folder.
  [[nodiscard]] std::string said(const std::string& verb, const std::string& input) const {
    const io::Confinement confinement(root());
    try {
      return run_verb({.verb = verb, .inputs = {input}}, root(), Progress::none()).report;
    } catch (const InvalidInput& error) {
      return error.what();
    }
  }

  test::Folder place_;
};

TEST_F(Escape, ByALinkOfAnyFormat) {
  const auto record = [](const fs::path& path) { static_cast<void>(io::read_record(path)); };
  const auto program = [](const fs::path& path) { static_cast<void>(program::read_program(path)); };
  const auto text = [](const fs::path& path) { static_cast<void>(io::read_file(path)); };
  const std::vector<std::pair<const char*, std::function<void(const fs::path&)>>> readers = {
      {".csv", record},
      {".txt", record},
      {".uff", record},
      {".wav", record},
      {".mat", record},
      {".ngc", program},
      {".apt", program},
      {".toml", text},
      {".json", text},
      {".stl", [](const fs::path& path) { static_cast<void>(io::read_stl(path)); }},
      {".urdf", [](const fs::path& path) { static_cast<void>(robot::read_urdf(path, {.tip = "tip"})); }},
      {".csv", [](const fs::path& path) { static_cast<void>(inspect(path)); }}};
  for (const auto& [ending, read] : readers) {
    const std::string name = std::string("theirs") + ending;
    const fs::path link = root() / name;
    fs::remove(link);
    fs::create_symlink(place_.file(name, secret), link);
    const io::Confinement confinement(root());
    EXPECT_NE(rejection([&, &reader = read] { reader(link); }).find(outside), std::string::npos) << ending;
    EXPECT_NE(rejection([&, &reader = read] { reader(root() / ".." / name); }).find(outside), std::string::npos)
        << ending;
  }
}

// The kernel alone, as it restricts a process that works for the server: each of these links is followed without it.
TEST_F(Escape, ByALinkWhereNobodyChecksPaths) {
  std::string rows = "time_s,force_n\n";
  for (int i = 0; i < 20; ++i) rows += std::to_string(i) + "e-4," + std::to_string(i % 7) + "\n";
  place_.file("theirs.csv", rows);
  place_.file("theirs.ngc", "G21 G90 G94\nS6000 M3\nG0 X0 Y0 Z5\nG1 X1 F100\nM2\n");
  place_.file("theirs.toml", secret);
  place_.file("theirs.urdf",
              "<robot name=\"arm\"><link name=\"base\"/><link name=\"tip\"/><joint name=\"j\" type=\"revolute\">"
              "<parent link=\"base\"/><child link=\"tip\"/><axis xyz=\"0 0 1\"/>"
              "<limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/></joint></robot>\n");
  io::write_wav(place_.at("theirs.wav"), std::vector<float>(100, 0.5F), 1, 1000.0);
  io::write_mat(place_.at("theirs.mat"), {{.name = "force", .re = Eigen::VectorXd::LinSpaced(20, 0.0, 1.0)}});
  const std::vector<std::pair<const char*, std::function<void(const fs::path&)>>> readers = {
      {"theirs.csv", [](const fs::path& path) { static_cast<void>(io::read_record(path)); }},
      {"theirs.wav", [](const fs::path& path) { static_cast<void>(io::read_record(path)); }},
      {"theirs.mat", [](const fs::path& path) { static_cast<void>(io::read_mat(path)); }},
      {"theirs.ngc", [](const fs::path& path) { static_cast<void>(program::read_program(path)); }},
      {"theirs.toml", [](const fs::path& path) { static_cast<void>(io::read_file(path)); }},
      {"theirs.urdf", [](const fs::path& path) { static_cast<void>(robot::read_urdf(path, {.tip = "tip"})); }}};
  for (const auto& [name, read] : readers) {
    fs::create_symlink(place_.at(name), root() / name);
    EXPECT_NO_THROW(read(root() / name)) << name;
  }
  bool known = false;
  std::thread([&] {  // it alone is restricted
    known = io::restrict_files(file_rights_of_worker(root(), false));
    if (!known) return;
    for (const auto& [name, read] : readers) EXPECT_THROW(read(root() / name), InvalidInput) << name;
  })
      .join();
  if (!known) GTEST_SKIP() << "this kernel has no Landlock";
}

TEST_F(Escape, ByANameInADocument) {
  for (const char* name : {"theirs.toml", "theirs.csv", "theirs.json", "theirs.uff"}) place_.file(name, secret);
  const std::vector<std::pair<const char*, std::string>> documents = {
      {"plan", "[job]\nmodes = \"../theirs.toml\"\nlobes = \"cut.toml\"\n"},
      {"plan", "[job]\nfrf = [\"../theirs.csv\"]\nlobes = \"cut.toml\"\n"},
      {"plan", "[job]\nhits = \"../theirs.toml\"\nlobes = \"cut.toml\"\n"},
      {"plan", "[job]\nmodes = \"" + place_.at("theirs.json").string() + "\"\nlobes = \"cut.toml\"\n"},
      {"lobes", lobes_with("[dynamics]", "[lobes]", "[dynamics]\nmodes = \"../theirs.toml\"\n")},
      {"lobes", lobes_with("[dynamics]", "[lobes]", "[dynamics]\nfrf = \"../theirs.uff\"\n")},
      {"lobes", lobes_with("[coefficients]", "[dynamics]", "[coefficients]\nfile = \"../theirs.toml\"\n")},
      {"frf",
       "[[hits]]\nfile = \"../theirs.csv\"\nforce_direction = \"x\"\nforce = \"1\"\nresponses = { x = \"2\" }\n"}};
  for (const auto& [verb, text] : documents) {
    file("ours.toml", text);
    const std::string answer = said(verb, "ours.toml");
    EXPECT_NE(answer.find(outside), std::string::npos) << text << answer;
    EXPECT_EQ(answer.find(secret), std::string::npos) << text << answer;
  }
}

// What other programs would read into a program is not read: the statement is rejected or left out.
TEST_F(Escape, ByAnIncludeOfAProgram) {
  place_.file("theirs.ngc", "G1 X424242 F100\n");
  const std::vector<std::pair<const char*, std::string>> programs = {
      {"a.ngc", "G21 G90 G94\nS6000 M3\nG0 X0 Y0 Z5\nO<../theirs> call\nM98 P../theirs.ngc\nG1 X1 F100\nM2\n"},
      {"b.ngc", "G21 G90 G94\nS6000 M3\nG0 X0 Y0 Z5\n$INCLUDE ../theirs.ngc\nG1 X1 F100\nM2\n"},
      {"c.apt",
       "UNITS/MM\nFROM/0,0,5\nINCLUD/../theirs.ngc\nREAD/2,../theirs.ngc\nFEDRAT/100,MMPM\nGOTO/1,0,5\nFINI\n"}};
  for (const auto& [name, text] : programs) {
    const fs::path path = file(name, text);
    const io::Confinement confinement(root());
    try {
      const program::Program read = program::read_program(path);
      for (const program::Block& block : read.blocks) {
        EXPECT_LT(block.end.tip_m.cwiseAbs().maxCoeff(), 1.0) << name;
      }
    } catch (const InvalidInput& error) {
      EXPECT_EQ(std::string(error.what()).find("424242"), std::string::npos) << error.what();
    }
  }
}

// Nor an entity of XML, nor a mesh.
TEST_F(Escape, ByAUrdf) {
  place_.file("theirs.txt", secret);
  const std::string way = place_.at("theirs.txt").string();
  const fs::path path =
      file("arm.urdf",
           "<?xml version=\"1.0\"?>\n<!DOCTYPE robot [<!ENTITY theirs SYSTEM \"file://" + way +
               "\">]>\n<robot name=\"&theirs;\"><link name=\"base\"><visual><geometry><mesh filename=\"file://" + way +
               "\"/></geometry></visual></link><link name=\"tip\"/>"
               "<joint name=\"&theirs;\" type=\"revolute\"><parent link=\"base\"/><child link=\"tip\"/>"
               "<axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" velocity=\"1\" effort=\"1\"/></joint>"
               "</robot>\n");
  const io::Confinement confinement(root());
  try {
    EXPECT_EQ(robot::read_urdf(path, {.tip = "tip"}).name.find(secret), std::string::npos);
  } catch (const InvalidInput& error) {
    EXPECT_EQ(std::string(error.what()).find(secret), std::string::npos) << error.what();
  }
}

}  // namespace escape_test
}  // namespace robomill::serve
