#include "robomill/serve/tap/folder.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <vector>

#include "testing/support.hpp"

namespace robomill::serve {
namespace tap_folder_test {

using namespace std::chrono_literals;
using Paths = std::vector<std::filesystem::path>;

// However often it is looked at: a writer who pauses is not done.
TEST(TapFolder, TakesWhatHasSettled) {
  const test::Folder place;
  TapFolder folder(place.path(), {});
  const TapFolder::Clock::time_point begin = TapFolder::Clock::now();
  const auto look = [&](std::chrono::milliseconds after) { return folder.look(10, begin + after); };
  const std::filesystem::path record = place.file("x_1.csv", "time_s,force_n\n");
  for (const auto after : {0ms, 1ms, 2ms, 400ms, 499ms}) EXPECT_TRUE(look(after).empty()) << after.count();
  std::ofstream(record, std::ios::app) << "0,1\n";
  for (const auto after : {600ms, 700ms, 1099ms}) EXPECT_TRUE(look(after).empty()) << after.count();
  // The same size, written again.
  std::filesystem::last_write_time(record, std::filesystem::last_write_time(record) + 1s);
  for (const auto after : {1100ms, 1599ms}) EXPECT_TRUE(look(after).empty()) << after.count();
  EXPECT_EQ(look(1600ms), Paths{record});
  EXPECT_TRUE(look(9000ms).empty());
}

TEST(TapFolder, LeavesOthersAlone) {
  const test::Folder place;
  place.file("before.csv", "1\n");
  std::filesystem::create_directory(place.at("other"));
  const std::filesystem::path old = place.file("old.csv", "1\n"), named = place.at("other/named.csv");
  TapFolder folder(place.path(), {old, named, place.at("missing.csv")});
  place.file("other/named.csv", "1\n");
  place.file(".hidden.csv", "1\n");
  place.file("notes.md", "1\n");
  place.file("empty.csv", "");
  place.file("own.csv", "1\n");
  folder.ignore(place.at("own.csv"));
  const std::filesystem::path first = place.file("a.csv", "1\n");
  const TapFolder::Clock::time_point now = TapFolder::Clock::now();
  EXPECT_TRUE(folder.look(10, now).empty());
  EXPECT_EQ(folder.look(1, now + 1s), Paths{first});  // at most so many
  EXPECT_EQ(folder.look(10, now + 1s), Paths{named}) << "and none that its rows name and that was there";
  const std::filesystem::path unread = place.file("hit.mf4", "MDF");
  EXPECT_TRUE(folder.look(10, now + 2s).empty());
  EXPECT_EQ(folder.look(10, now + 4s), Paths{unread}) << "to be named";
  std::filesystem::remove_all(place.path());  // a share that is gone
  EXPECT_TRUE(folder.look(10, now + 6s).empty());
}

}  // namespace tap_folder_test
}  // namespace robomill::serve
