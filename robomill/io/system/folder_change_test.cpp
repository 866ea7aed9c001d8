#include "robomill/io/system/folder_change.hpp"

#include <gtest/gtest.h>

#include <string>

#include "testing/support.hpp"

namespace robomill::io {
namespace folder_change_test {

namespace fs = std::filesystem;
using test::Folder;
using test::rejection;

TEST(FolderChange, ReplacesAddsAndRemovesTogether) {
  const Folder folder;
  const fs::path out = folder.at("made/out");
  {
    FolderChange first(out);
    first.write("a.json", "1");
    first.write("b.json", "1");
    EXPECT_FALSE(fs::exists(out / "a.json"));
    first.commit();
  }
  PendingFile other(out / "c.csv");
  other.write("2");
  {
    FolderChange second(out);
    second.write("a.json", "2");
    second.add("c.csv", other);
    second.remove("b.json");
    second.remove("none.json");
    EXPECT_EQ(read_file(out / "a.json"), "1");
    EXPECT_TRUE(fs::exists(out / "b.json"));
    second.commit();
  }
  EXPECT_EQ(read_file(out / "a.json"), "2");
  EXPECT_EQ(read_file(out / "c.csv"), "2");
  EXPECT_EQ(std::distance(fs::directory_iterator(out), fs::directory_iterator()), 2);
}

// One of them cannot take its place: those before it give theirs back.
TEST(FolderChange, ThatFailsHasChangedNothing) {
  for (int failing = 0; failing < 3; ++failing) {
    const Folder folder;
    static_cast<void>(folder.file("b", "old"));
    static_cast<void>(folder.file("gone", "old"));
    {
      FolderChange change(folder.path());
      PendingFile a(folder.at("a")), b(folder.at("b")), c(folder.at("c"));
      PendingFile* const files[] = {&a, &b, &c};
      change.remove("gone");
      for (PendingFile* file : files) {
        file->write("new");
        change.add(file->path().filename().string(), *file);
      }
      fs::remove(files[failing]->temporary());
      EXPECT_NE(rejection([&] { change.commit(); }).find("cannot be written"), std::string::npos);
    }
    EXPECT_EQ(read_file(folder.at("b")), "old");
    EXPECT_EQ(read_file(folder.at("gone")), "old");
    EXPECT_EQ(folder.count(), 2u) << failing;
  }
}

TEST(FolderChange, ThatWasKilledIsReportedUntilAnotherIsCompleted) {
  const Folder folder;
  const fs::path a = folder.file("a.json", "new"), b = folder.file("b.json", "old"), job = folder.file("job.toml", "1");
  static_cast<void>(folder.file(".b.12-1.json", "new"));
  static_cast<void>(folder.file(".robomill-unfinished", "a.json\t.a.12-0.json\nb.json\t.b.12-1.json\n"));
  for (const fs::path& file : {a, b}) {
    EXPECT_EQ(rejection([&] { static_cast<void>(read_file(file)); }),
              file.string() +
                  ": belongs to files that were being replaced when the program was ended. Some are of the "
                  "last run and some of the one before. Run it again");
  }
  EXPECT_EQ(read_file(job), "1");
  {
    FolderChange again(folder.path());
    again.write("a.json", "newer");
    again.write("b.json", "newer");
    again.commit();
  }
  EXPECT_EQ(read_file(a), "newer");
  EXPECT_EQ(read_file(b), "newer");
  EXPECT_EQ(folder.count(), 3u);
}

// What the run that was killed wrote and this one does not write is of no run.
TEST(FolderChange, TakesAwayWhatOneThatWasKilledLeft) {
  const Folder folder;
  static_cast<void>(folder.file("blocks.csv", "new"));
  static_cast<void>(folder.file("other.csv", "mine"));
  static_cast<void>(folder.file(".robomill-unfinished", "blocks.csv\t.blocks.12-0.csv\n"));
  FolderChange again(folder.path());
  again.write("a.json", "1");
  again.commit();
  EXPECT_FALSE(fs::exists(folder.at("blocks.csv")));
  EXPECT_EQ(read_file(folder.at("a.json")), "1");
  EXPECT_EQ(folder.count(), 2u);
}

// Who may write into a folder must not have others take away what he could not.
TEST(FolderChange, TakesNothingElseAwayForAMarker) {
  const Folder folder;
  fs::create_directories(folder.at("out"));
  static_cast<void>(folder.file("mine.txt", "1"));
  static_cast<void>(folder.file(".profile", "1"));
  static_cast<void>(folder.file("out/.robomill-unfinished",
                                "../mine.txt\t.a.1-1.json\na.json\t../mine.txt\nb.json\t../.profile\nc.json\n\t\n"));
  FolderChange again(folder.at("out"));
  again.write("a.json", "1");
  again.commit();
  EXPECT_EQ(read_file(folder.at("mine.txt")), "1");
  EXPECT_EQ(read_file(folder.at(".profile")), "1");
  EXPECT_EQ(read_file(folder.at("out/a.json")), "1");
}

// A document that is a link stays one, and what it leads to is marked by both its names.
TEST(FolderChange, GoesBehindLinks) {
  const Folder folder;
  fs::create_directories(folder.at("out"));
  fs::create_directories(folder.at("other"));
  fs::create_symlink("../other/m.json", folder.at("out/modes.json"));
  for (const char* content : {"1", "2"}) {  // the first time it leads to nothing
    FolderChange change(folder.at("out"));
    change.write("modes.json", content);
    change.commit();
    EXPECT_TRUE(fs::is_symlink(folder.at("out/modes.json")));
    EXPECT_EQ(read_file(folder.at("other/m.json")), content);
  }
  static_cast<void>(folder.file("out/.robomill-unfinished", "modes.json\t.m.12-0.json\n"));
  fs::create_symlink("out/modes.json", folder.at("link.json"));
  for (const char* name : {"out/modes.json", "link.json"}) {
    EXPECT_NE(rejection([&] { static_cast<void>(read_file(folder.at(name))); }).find("were being replaced"),
              std::string::npos)
        << name;
  }
}

}  // namespace folder_change_test
}  // namespace robomill::io
