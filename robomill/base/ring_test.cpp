#include "robomill/base/ring.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

#include "robomill/base/random.hpp"

namespace robomill {
namespace ring_test {

TEST(Ring, RoundsItsRoomUpAndCountsIt) {
  Ring<int> ring(5);
  EXPECT_EQ(ring.capacity(), 8U);
  EXPECT_EQ(ring.room(), 8U);
  for (int i = 0; i < 8; ++i) ring.put(i);
  EXPECT_EQ(ring.room(), 0U);
  EXPECT_EQ(ring.end(), 0U);  // not yet handed over
  ring.publish();
  EXPECT_EQ(ring.end(), 8U);
  ring.drop_before(3);
  EXPECT_EQ(ring.room(), 3U);
  EXPECT_EQ(ring[3], 3);
  EXPECT_EQ(ring.put_at(7), 7);
}

// An entry that is torn or seen before it was published would not fit its number.
TEST(Ring, HandsEntriesOverWholeAndInOrder) {
  using Entry = std::array<std::uint64_t, 9>;
  constexpr std::size_t count = 200'000;
  Ring<Entry> ring(64);
  std::thread writer([&] {
    Random random(1);
    for (std::size_t i = 0; i < count;) {
      std::size_t some = 1 + random.index(20);
      for (; some > 0 && i < count && ring.room() > 0; --some, ++i) {
        Entry entry;
        entry.fill(i * 0x9e3779b97f4a7c15ULL);
        ring.put(entry);
      }
      ring.publish();
      if (ring.room() == 0) std::this_thread::yield();
    }
  });
  std::size_t read = 0, wrong = 0;
  while (read < count) {
    const std::size_t end = ring.end();
    if (end == read) std::this_thread::yield();
    for (; read < end; ++read) {
      for (const std::uint64_t word : ring[read]) wrong += word != read * 0x9e3779b97f4a7c15ULL ? 1 : 0;
    }
    ring.drop_before(read);
  }
  writer.join();
  EXPECT_EQ(wrong, 0U);
}

}  // namespace ring_test
}  // namespace robomill
