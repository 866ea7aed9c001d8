// A document and the files that it includes.
#include "robomill/io/toml/assembly.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/io/toml/tables.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace toml_assembly_test {

using test::Folder;

/// What the InvalidInput that f throws says; empty where it throws none.
template <class F>
std::string rejection(F&& f) {
  try {
    f();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

int integer(TomlFile& file, const char* key) {
  int out = 0;
  file.integer(key, key, out);
  return out;
}

// A shop keeps a file a tool: the job brings it in, and says what it adds.
TEST(TomlAssembly, BringsInTheTablesOfOtherFiles) {
  const Folder folder;
  std::filesystem::create_directory(folder.at("tools"));
  folder.file("tools/em12.toml", "include = \"coating.toml\"\n[tool]\nteeth = 4\nmodes = \"m.json\"\n");
  folder.file("tools/coating.toml", "[coating]\nlayers = 2\n");
  const auto job = folder.file("job.toml", "include = [\"tools/em12.toml\"]\n[tool]\nlength_mm = 80\n");
  TomlFile file(job);
  EXPECT_EQ(integer(file, "tool.teeth"), 4);
  EXPECT_EQ(integer(file, "tool.length_mm"), 80);
  EXPECT_EQ(integer(file, "coating.layers"), 2);
  std::filesystem::path modes;
  EXPECT_TRUE(file.path("tool.modes", modes));
  EXPECT_EQ(modes, job.parent_path() / "tools/m.json") << "relative to the file that names it";
  EXPECT_EQ(file.file_of("tool.teeth"), job.parent_path() / "tools/em12.toml");
  EXPECT_EQ(file.file_of("tool.length_mm"), job);
  EXPECT_EQ(file.texts().size(), 3U);
  EXPECT_TRUE(file.done().empty());
  // Errors are of the file and line that hold the value.
  const std::string text = file.reject("tool.teeth", "must be odd").what();
  EXPECT_TRUE(text.ends_with("tools/em12.toml:3: tool.teeth = 4; must be odd")) << text;
}

TEST(TomlAssembly, ReadsEachFileOnce) {
  const Folder folder;
  folder.file("a.toml", "include = [\"b.toml\", \"job.toml\"]\n[a]\nx = 1\n");
  folder.file("b.toml", "include = \"a.toml\"\n[b]\nx = 2\n");
  const auto job = folder.file("job.toml", "include = [\"a.toml\", \"./b.toml\"]\n");
  TomlFile file(job);
  EXPECT_EQ(integer(file, "a.x") + integer(file, "b.x"), 3);
  EXPECT_EQ(file.texts().size(), 3U);
}

// The same value twice is one value; 3 and 3.0 are.
TEST(TomlAssembly, OneKeyHasOneValue) {
  const Folder folder;
  folder.file("lobes.toml",
              "[tool]\nteeth = 3\npitch_deg = [120, 120.0, 120]\nkind = \"flat-end\"\n[[cuts]]\nfile = \"a\"\n");
  const auto with = [&](const std::string& more) {
    return folder.file("job.toml", "[job]\nlobes = \"lobes.toml\"\n" + more);
  };
  TomlFile same(
      with("[tool]\nteeth = 3.0\npitch_deg = [120, 120, 120]\nkind = \"flat-end\"\n[[cuts]]\nfile = \"a\"\n"));
  EXPECT_EQ(integer(same, "tool.teeth"), 3);
  const auto rejected = [&](const std::string& more) {
    const auto path = with(more);
    return rejection([&] { TomlFile file(path); });
  };
  const std::string teeth = rejected("[tool]\nteeth = 4\n");
  EXPECT_NE(teeth.find("lobes.toml:2: tool.teeth = 3; must have one value in what is read together; "),
            std::string::npos);
  EXPECT_NE(teeth.find("job.toml:4 has 4"), std::string::npos) << "both lines: " << teeth;
  for (const char* more : {"[tool]\npitch_deg = [100, 120, 140]\n", "[tool]\npitch_deg = 120\n", "[tool]\nkind = 3\n",
                           "[tool]\nkind = \"ball-end\"\n", "[[cuts]]\nfile = \"b\"\n"}) {
    EXPECT_NE(rejected(more).find("must have one value"), std::string::npos) << more;
  }
}

TEST(TomlAssembly, RejectsWhatNamesNoFile) {
  const Folder folder;
  const auto rejected = [&](const std::string& text) {
    const auto path = folder.file("job.toml", text);
    return rejection([&] { TomlFile file(path); });
  };
  EXPECT_NE(rejected("\ninclude = [\"gone.toml\"]\n").find("job.toml:2: include = \"gone.toml\"; names no file"),
            std::string::npos);
  for (const char* text : {"include = 3\n", "include = [3]\n", "include = \"\"\n", "include = [[\"a.toml\"]]\n"}) {
    EXPECT_NE(rejected(text).find("must be a list of names of files"), std::string::npos) << text;
  }
  folder.file("broken.toml", "[tool\n");
  EXPECT_NE(rejected("include = \"broken.toml\"\n").find("broken.toml:1: is no TOML"), std::string::npos);
  // What a job names is left to the reader that needs it.
  EXPECT_EQ(rejected("[job]\nlobes = \"gone.toml\"\ncell = 3\n"), "");
}

// A chain of files has an end, and none leaves the folder that is served.
TEST(TomlAssembly, IsBounded) {
  const Folder folder;
  for (int i = 0; i < 40; ++i) {
    folder.file(std::to_string(i) + ".toml", "include = \"" + std::to_string(i + 1) + ".toml\"\n");
  }
  folder.file("40.toml", "[a]\nx = 1\n");
  EXPECT_NE(rejection([&] { TomlFile file(folder.at("0.toml")); }).find("includes more than 32 files"),
            std::string::npos);
  std::filesystem::create_directory(folder.at("served"));
  const auto inside = folder.file("served/job.toml", "include = \"../40.toml\"\n");
  const Confinement confinement(inside.parent_path());
  EXPECT_NE(rejection([&] { TomlFile file(inside); }), "");
}

// One document serves several readers: a table, or a key of a shared one, that another reads is no mistake.
TEST(TomlTables, AReaderLeavesThoseOfOthersAlone) {
  const auto rejected = [](const std::string& more) {
    TomlFile file(TomlSource("job.toml", "[tool]\nteeth = 3\n" + more));
    static_cast<void>(integer(file, "tool.teeth"));
    return rejection([&] { static_cast<void>(file.done()); });
  };
  EXPECT_EQ(rejected("length_mm = 80\n[spindle]\nmax_speed_rpm = 9000\n[decide]\nfree = 3\n"), "");
  EXPECT_NE(rejected("lenght_mm = 80\n").find("tool.lenght_mm: is not known here"), std::string::npos);
  EXPECT_NE(rejected("[spindel]\nmax_speed_rpm = 9000\n").find("spindel.max_speed_rpm: is not known here"),
            std::string::npos);
  EXPECT_TRUE(shared_key("robot.joint_max_jerk") && !shared_key("robot.jont_max_jerk"));
  // Whoever reads some of the keys of a joint reads all.
  TomlFile cell(TomlSource("cell.toml", "[robot]\njoint_stifness = [1]\njoint_max_jerk = [2]\n"));
  std::vector<double> jerk;
  cell.numbers("robot.joint_max_jerk", "jerk", 1.0, jerk);
  EXPECT_NE(rejection([&] { static_cast<void>(cell.done()); }).find("robot.joint_stifness: is not known here"),
            std::string::npos);
}

TEST(TomlTables, SampleValuesAreThoseThatWereRead) {
  const Folder folder;
  folder.file("cell.toml", "[robot]\nmodel = \"kr-6\"   # sample kr-6:\n");
  const auto job = folder.file("job.toml", "[job]\ncell = \"cell.toml\"\n[tool]\nteeth = 3   # sample 3:\n");
  TomlFile file(job);
  static_cast<void>(integer(file, "tool.teeth"));
  ASSERT_EQ(sample_values(file).size(), 1U);
  EXPECT_EQ(sample_values(file).front().key, "tool.teeth");
  std::string model;
  file.text("robot.model", model);
  ASSERT_EQ(sample_values(file).size(), 2U);
  EXPECT_EQ(sample_values(file).back().file, "cell.toml");
}

}  // namespace toml_assembly_test
}  // namespace robomill::io
