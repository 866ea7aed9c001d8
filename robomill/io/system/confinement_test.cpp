#include "robomill/io/system/confinement.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace confinement_test {

namespace fs = std::filesystem;
using test::Folder;
using test::rejection;

TEST(Confinement, LetsOutNeitherReadersNorWriters) {
  const Folder folder;
  const fs::path outside = folder.at("outside");
  const fs::path inside = folder.at("inside");
  fs::create_directories(outside);
  fs::create_directories(inside);
  const fs::path secret = folder.file("outside/secret.txt", "42");
  const fs::path own = folder.file("inside/own.txt", "own");
  fs::create_symlink(secret, inside / "link.txt");
  fs::create_directory_symlink(outside, inside / "way");
  const fs::path dots = inside / ".." / "outside" / "secret.txt";
  {
    const Confinement confinement(inside);
    EXPECT_EQ(read_file(own), "own");
    for (const fs::path& path :
         {secret, inside / "link.txt", inside / "way" / "secret.txt", dots, fs::path("/etc/passwd")}) {
      EXPECT_NE(rejection([&] { (void)read_file(path); }).find("outside the folder that is served"), std::string::npos)
          << path;
      EXPECT_NE(rejection([&] { write_file(path, "x"); }).find("outside"), std::string::npos) << path;
      EXPECT_NE(rejection([&] { const LineFile file(path); }).find("outside"), std::string::npos) << path;
      EXPECT_NE(rejection([&] { (void)remove_file(path); }).find("outside"), std::string::npos) << path;
    }
    EXPECT_NE(rejection([&] { make_folder(outside / "new"); }).find("outside"), std::string::npos);
    // A folder whose name only begins alike is another one.
    EXPECT_NE(rejection([&] { make_folder(inside.string() + "-2/new"); }).find("outside"), std::string::npos);
    make_folder(inside / "new/deep");
    write_file(inside / "new/deep/file", "x");
  }
  EXPECT_EQ(read_file(secret), "42");
  EXPECT_FALSE(fs::exists(outside / "new"));
}

TEST(Confinement, LinksWithoutATargetLeadNowhere) {
  const Folder folder;
  const fs::path inside = folder.at("inside");
  fs::create_directories(inside);
  fs::create_symlink(folder.at("made.txt"), inside / "link.txt");
  fs::create_symlink(folder.at("made"), inside / "way");
  fs::create_symlink("loop", inside / "loop");
  const Confinement confinement(inside);
  for (const fs::path& path : {inside / "link.txt", inside / "way" / "a.txt", inside / "loop"}) {
    EXPECT_NE(rejection([&] { const LineFile file(path); }), "") << path;
    EXPECT_NE(rejection([&] { write_file(path, "x"); }), "") << path;
    EXPECT_NE(rejection([&] { make_folder(path); }), "") << path;
  }
  EXPECT_FALSE(fs::exists(folder.at("made.txt")));
  EXPECT_FALSE(fs::exists(folder.at("made")));
}

TEST(Confinement, PipesAreNotOpened) {
  const Folder folder;
  const fs::path pipe = folder.at("pipe.csv");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Confinement confinement(folder.path());
  EXPECT_NE(rejection([&] { (void)read_file(pipe); }).find("a device or a pipe"), std::string::npos);
  EXPECT_NE(rejection([&] { write_file(pipe, "x"); }).find("a device or a pipe"), std::string::npos);
  EXPECT_NE(rejection([&] { const LineFile file(pipe); }).find("a device or a pipe"), std::string::npos);
}

TEST(Confinement, ASecondOneLeavesTheFirstAsItIs) {
  const Folder folder;
  const fs::path secret = folder.file("secret.txt", "42");
  fs::create_directories(folder.at("inside"));
  const Confinement confinement(folder.at("inside"));
  EXPECT_NE(rejection([&] { const Confinement second(folder.path()); }).find("at a time"), std::string::npos);
  EXPECT_NE(rejection([&] { (void)read_file(secret); }).find("outside"), std::string::npos);
}

TEST(Confinement, NeedsAFolder) {
  const Folder folder;
  EXPECT_NE(rejection([&] { const Confinement none(folder.at("none")); }).find("no such folder"), std::string::npos);
  EXPECT_NE(rejection([&] { const Confinement none(folder.file("file", "x")); }).find("no such folder"),
            std::string::npos);
}

}  // namespace confinement_test
}  // namespace robomill::io
