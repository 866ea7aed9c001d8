#include "robomill/io/system/program.hpp"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <unistd.h>

#include <string>

namespace robomill::io {
namespace program_test {

TEST(Programs, SayWhatTheySayAndHowTheyEnd) {
  const ProgramEnd end = run_program({"sh", "-c", "echo out; echo error >&2; exit 7"});
  EXPECT_TRUE(end.started);
  EXPECT_EQ(end.code, 7);
  EXPECT_EQ(end.said, "out\n");
  EXPECT_EQ(end.complaint, "error\n");
  EXPECT_EQ(run_program({"sh", "-c", "kill -9 $$"}).code, 128 + 9);
}

TEST(Programs, GetTheirWordsAsTheyAre) {
  const std::string word = "a b 'c' \"d\" $HOME \\ * ;";
  EXPECT_EQ(run_program({"printf", "%s|", word, ""}).said, word + "||");
}

TEST(Programs, ThatAreNotThereAreReported) {
  const ProgramEnd end = run_program({"no-program-of-this-name"});
  EXPECT_FALSE(end.started);
  EXPECT_EQ(end.complaint, "No such file or directory");
}

// More than a pipe holds on both outputs at once: none waits for the other.
TEST(Programs, SayMuch) {
  const ProgramEnd end =
      run_program({"sh", "-c", "head -c 300000 /dev/zero; head -c 300000 /dev/zero >&2"}, {.output_bytes = 200'000});
  EXPECT_EQ(end.code, 0);
  EXPECT_EQ(end.said.size(), 200'000U);
  EXPECT_EQ(end.complaint.size(), 200'000U);
}

TEST(Programs, EndInTime) {
  EXPECT_EQ(run_program({"sleep", "60"}, {.time = std::chrono::milliseconds(50)}).code, 128 + 9);
}

TEST(Programs, HaveNoInputAndNoneOfTheFilesThatAreOpenHere) {
  const int file = ::open("/dev/null", O_RDONLY);
  ASSERT_GE(file, 0);
  const ProgramEnd end = run_program({"sh", "-c", "cat; test ! -e /proc/$$/fd/" + std::to_string(file)});
  ::close(file);
  EXPECT_EQ(end.code, 0);
}

}  // namespace program_test
}  // namespace robomill::io
