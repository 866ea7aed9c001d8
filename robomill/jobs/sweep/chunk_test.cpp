#include "robomill/jobs/sweep/chunk.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "robomill/base/digest.hpp"
#include "robomill/base/random.hpp"

namespace robomill::jobs {
namespace chunk_test {

Chunk example() {
  constexpr double inf = std::numeric_limits<double>::infinity();
  return {.fingerprint = "abc",
          .processor = "a processor",
          .first = 70,
          .points = {{.values = {1.5, inf}},
                     {.state = PointState::rejected, .values = {std::nan(""), std::nan("")}, .reason = "is too deep"}}};
}

TEST(Chunk, IsReadAsItWasWritten) {
  const std::optional<Chunk> read = read_chunk(chunk_bytes(example()));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->fingerprint, "abc");
  EXPECT_EQ(read->processor, "a processor");
  EXPECT_EQ(read->first, 70U);
  ASSERT_EQ(read->points.size(), 2U);
  EXPECT_EQ(read->points[0].values, example().points[0].values);
  EXPECT_EQ(read->points[1].state, PointState::rejected);
  EXPECT_EQ(read->points[1].reason, "is too deep");
  EXPECT_TRUE(std::isnan(read->points[1].values[1]));
  EXPECT_EQ(chunk_bytes(*read), chunk_bytes(example()));
}

TEST(Chunk, IsRejectedWhereAByteIsMissingOrWrong) {
  const std::string bytes = chunk_bytes(example());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(read_chunk(bytes.substr(0, length))) << length;
  }
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string wrong = bytes;
    wrong[at] = static_cast<char>(wrong[at] ^ 0x10);
    EXPECT_FALSE(read_chunk(wrong)) << at;
  }
}

// Counts that lie, under a digest that does not.
TEST(Chunk, TakesNoMemoryForCountsThatLie) {
  const std::string bytes = chunk_bytes(example());
  const std::string content = bytes.substr(0, bytes.size() - 64);
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    std::string wrong = content;
    const std::size_t at = 16 + random.index(wrong.size() - 16);
    wrong[at] = static_cast<char>(random.index(256));
    wrong[16 + random.index(wrong.size() - 16)] = '\xff';
    static_cast<void>(read_chunk(wrong + digest_of(wrong)));
  }
}

}  // namespace chunk_test
}  // namespace robomill::jobs
