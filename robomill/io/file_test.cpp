#include "robomill/io/file.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "robomill/io/system/pending_names.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace file_test {

namespace fs = std::filesystem;
using test::Folder;
using test::rejection;

TEST(File, KeepsEveryByte) {
  const Folder folder;
  std::string content;
  for (int i = 0; i < 200000; ++i) content += static_cast<char>(i * 31 % 256);
  write_file(folder.at("bytes.bin"), content);
  EXPECT_EQ(read_file(folder.at("bytes.bin")), content);
  write_file(folder.at("bytes.bin"), "short");
  EXPECT_EQ(read_file(folder.at("bytes.bin")), "short");
  EXPECT_EQ(folder.count(), 1u);
}

TEST(File, SaysWhatIsWrong) {
  const Folder folder;
  EXPECT_EQ(rejection([&] { (void)read_file(folder.at("none")); }),
            folder.at("none").string() + ": there is no such file");
  EXPECT_EQ(rejection([&] { (void)read_file(folder.path()); }), folder.path().string() + ": is a folder, not a file");
  EXPECT_EQ(rejection([&] { (void)read_file(folder.file("empty", "")); }), folder.at("empty").string() + ": is empty");
  EXPECT_NE(rejection([&] { (void)read_file(folder.file("long", "12345"), 4); }).find("more than 4 bytes"),
            std::string::npos);
  EXPECT_NE(rejection([&] { (void)read_file("/dev/zero", 1000); }).find("more than 1000 bytes"), std::string::npos);
  EXPECT_NE(rejection([&] { write_file(folder.at("no/where.csv"), "x"); }).find("There is no folder"),
            std::string::npos);
  EXPECT_NE(rejection([&] { write_file(folder.path(), "x"); }).find("is a folder"), std::string::npos);
}

TEST(File, LeavesNothingHalfWritten) {
  const Folder folder;
  const fs::path path = folder.file("kept.csv", "old");
  {
    const PendingFile pending(path);
    (void)folder.file(pending.temporary().filename().string(), "half");
    EXPECT_EQ(pending.temporary().extension(), ".csv");
    EXPECT_EQ(folder.count(), 2u);
  }
  EXPECT_EQ(read_file(path), "old");
  EXPECT_EQ(folder.count(), 1u);
}

TEST(File, IsWrittenInPartsAndAnywhere) {
  const Folder folder;
  PendingFile pending(folder.at("parts.bin"));
  pending.write("0123");
  pending.write("4567");
  EXPECT_TRUE(pending.write_at(6, "abc"));
  EXPECT_EQ(pending.size(), 9u);
  std::string back(5, '-');
  EXPECT_EQ(pending.read_at(5, back), 4u);
  EXPECT_EQ(back, "5abc-");
  EXPECT_TRUE(pending.resize(3));
  pending.write("!");
  pending.commit();
  EXPECT_EQ(read_file(folder.at("parts.bin")), "012!");
}

// A full disk: whatever fits or does not, the old file or the new one is there, and nothing beside it.
TEST(File, ThatCannotBeWrittenLeavesTheOldOne) {
  const Folder folder;
  const std::string content(1000, 'n');
  for (const std::size_t room : {0u, 1u, 512u, 999u}) {
    const fs::path path = folder.file("kept.csv", "old");
    const test::FileSizeLimit full(room);
    EXPECT_EQ(rejection([&] { write_file(path, content); }), path.string() + ": cannot be written. File too large");
    PendingFile pending(path);
    EXPECT_FALSE(pending.write_at(0, content));
    EXPECT_TRUE(pending.failed());
    EXPECT_FALSE(pending.write_at(0, "n"));  // a part that fits does not make it whole
    EXPECT_NE(rejection([&] { pending.commit(); }).find("File too large"), std::string::npos);
    EXPECT_EQ(read_file(path), "old");
  }
  EXPECT_EQ(folder.count(), 1u);
  const test::FileSizeLimit just_enough(content.size());
  write_file(folder.at("kept.csv"), content);
  EXPECT_EQ(read_file(folder.at("kept.csv")), content);
}

TEST(File, PendingFilesCanAllBeRemovedAtOnce) {
  const Folder folder;
  const auto written = [&](const PendingFile& pending) {
    return folder.file(pending.temporary().filename().string(), "half");
  };
  PendingFile first(folder.at("first.csv")), second(folder.at("second.csv"));
  const fs::path first_temporary = written(first), second_temporary = written(second);
  second.commit();
  // One whose name was given back is not another's.
  { const PendingFile gone(folder.at("gone.csv")); }
  const fs::path other = folder.file("other.csv", "kept");
  remove_pending_files();
  EXPECT_FALSE(fs::exists(first_temporary));
  EXPECT_EQ(read_file(folder.at("second.csv")), "half");
  EXPECT_EQ(read_file(other), "kept");
  EXPECT_EQ(folder.count(), 2u);
  // More than are kept in view are still written as ever.
  std::vector<std::unique_ptr<PendingFile>> many;
  for (int i = 0; i < 200; ++i) {
    many.push_back(std::make_unique<PendingFile>(folder.at(std::to_string(i) + ".csv")));
    (void)written(*many.back());
  }
  remove_pending_files();
  EXPECT_LT(folder.count(), 2u + 200u);
  many.clear();
  EXPECT_EQ(folder.count(), 2u);
}

TEST(File, TakesRegularFilesAwayAlone) {
  const Folder folder;
  const fs::path target = folder.file("target.csv", "old");
  fs::create_symlink(target, folder.at("link.csv"));
  EXPECT_FALSE(remove_file(folder.at("none")));
  EXPECT_FALSE(remove_file(folder.path()));
  EXPECT_FALSE(remove_file("/dev/null"));
  EXPECT_TRUE(remove_file(folder.at("link.csv")));
  EXPECT_FALSE(fs::exists(target));
  EXPECT_TRUE(fs::is_symlink(folder.at("link.csv")));
}

TEST(File, WritesThroughLinksAndIntoDevices) {
  const Folder folder;
  const fs::path target = folder.file("target.csv", "old");
  fs::create_symlink(target, folder.at("link.csv"));
  write_file(folder.at("link.csv"), "new");
  EXPECT_TRUE(fs::is_symlink(folder.at("link.csv")));
  EXPECT_EQ(read_file(target), "new");
  write_file("/dev/null", "gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(LineFile, IsWholeAtTheEnd) {
  const Folder folder;
  const fs::path path = folder.file("lines.jsonl", "old");
  {
    LineFile file(path);
    EXPECT_TRUE(file.write("1\n"));
    EXPECT_EQ(read_file(path), "old");
    EXPECT_TRUE(file.write("2\n"));
    file.close();
    EXPECT_EQ(read_file(path), "1\n2\n");
    EXPECT_EQ(folder.count(), 1u);
  }
  { EXPECT_TRUE(LineFile(path).write("half")); }
  EXPECT_EQ(read_file(path), "1\n2\n");
  EXPECT_EQ(folder.count(), 1u);
  EXPECT_NE(rejection([&] { LineFile(folder.at("no/where")); }).find("There is no folder"), std::string::npos);
  LineFile full("/dev/full");
  EXPECT_TRUE(full.write("lost\n"));
  EXPECT_EQ(rejection([&] { full.close(); }), "/dev/full: could not be written to its end. Is the disk full?");
}

TEST(File, KnowsFormatsByTheirEnding) {
  EXPECT_EQ(format_of("a/b.UFF"), Format::uff);
  EXPECT_EQ(format_of("b.unv"), Format::uff);
  EXPECT_EQ(format_of("b.tar.csv"), Format::csv);
  EXPECT_EQ(format_of("b.mat"), Format::mat);
  EXPECT_EQ(format_of("b"), Format::unknown);
  EXPECT_EQ(format_of("b.xlsx"), Format::unknown);
}

}  // namespace file_test
}  // namespace robomill::io
