#include "robomill/io/system/output_places.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robomill/io/file.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace output_places_test {

namespace fs = std::filesystem;
using test::Folder;
using test::rejection;

TEST(OutputPlaces, AreReadByNoPath) {
  const Folder folder;
  const fs::path file = folder.file("hit.csv", "1");
  const fs::path other = folder.file("other.csv", "1");
  fs::create_symlink(file, folder.at("soft.csv"));
  fs::create_hard_link(file, folder.at("hard.csv"));
  const fs::path ways[] = {file, folder.at("soft.csv"), folder.at("hard.csv"), folder.path() / "." / "hit.csv"};
  for (const fs::path& output : ways) {
    const OutputPlaces places({output, fs::path()});
    for (const fs::path& input : ways) {
      EXPECT_NE(rejection([&] {
                  static_cast<void>(read_file(input));
                }).find("is read by this job and would be replaced by its output. Write the output to another file"),
                std::string::npos)
          << input << ' ' << output;
    }
    EXPECT_EQ(read_file(other), "1");
  }
  EXPECT_EQ(read_file(file), "1");
}

TEST(OutputPlaces, OfAFolderAreAllThatIsInIt) {
  const Folder folder;
  fs::create_directories(folder.at("out/deeper"));
  static_cast<void>(folder.file("out/job.toml", "1"));
  static_cast<void>(folder.file("out/deeper/hit.csv", "1"));
  static_cast<void>(folder.file("outer.toml", "1"));
  const OutputPlaces places({folder.at("out")});
  for (const char* name : {"out/job.toml", "out/deeper/hit.csv"}) {
    EXPECT_NE(rejection([&] { static_cast<void>(read_file(folder.at(name))); }).find("stands in the folder that it"),
              std::string::npos)
        << name;
  }
  EXPECT_EQ(read_file(folder.at("outer.toml")), "1");
  // What the job itself makes and reads again.
  PendingFile own(folder.at("out/program.ngc"));
  own.write("G1");
  EXPECT_EQ(read_file(own.temporary()), "G1");
}

TEST(ReadBack, IsOfItsFolderAlone) {
  const Folder folder;
  for (const char* name : {"one", "two"}) fs::create_directory(folder.at(name));
  static_cast<void>(folder.file("one/chunk", "1"));
  static_cast<void>(folder.file("two/chunk", "1"));
  const OutputPlaces places({folder.at("one"), folder.at("two")});
  {
    const ReadBack own(folder.at("one"));
    EXPECT_EQ(read_file(folder.at("one/chunk")), "1");
    EXPECT_THROW(static_cast<void>(read_file(folder.at("two/chunk"))), InvalidInput);
  }
  EXPECT_THROW(static_cast<void>(read_file(folder.at("one/chunk"))), InvalidInput);
}

TEST(OutputPlaces, DifferFromEachOther) {
  const Folder folder;
  EXPECT_NE(rejection([&] {
              const OutputPlaces two({folder.at("a.json"), folder.at("./a.json")});
            }).find("is where two outputs would be written"),
            std::string::npos);
  const OutputPlaces devices({"/dev/null", "/dev/null"});
}

}  // namespace output_places_test
}  // namespace robomill::io
