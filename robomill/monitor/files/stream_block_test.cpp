#include "robomill/monitor/files/stream_block.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::monitor {
namespace stream_block_test {

std::span<const std::byte> bytes(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::uint64_t any_bits(Random& random) {
  return random.index(std::numeric_limits<std::uint64_t>::max());
}

StreamBlock some_block() {
  StreamBlock block;
  block.sequence = 0x0102030405060708ULL;
  block.sample_rate_hz = 10240.0;
  block.spindle_speed_rad_per_s = 3000.0 * units::rpm;
  block.channels = 2;
  block.samples = {1.0F, -2.0F, 0.5F, 0.25F, 3.0F, 4.0F};
  return block;
}

// The layout of docs/formats.md, byte by byte.
TEST(StreamBlock, HasTheDocumentedLayout) {
  const std::string message = encode_stream_block(some_block());
  ASSERT_EQ(message.size(), 40U + 24U);
  EXPECT_EQ(message.substr(0, 8), std::string("RMSB\x01\x00\x02\x00", 8));
  EXPECT_EQ(message.substr(8, 8), std::string("\x08\x07\x06\x05\x04\x03\x02\x01"));
  const double rate_hz = 10240.0, rpm = 3000.0;
  const float first = 1.0F;
  static_assert(std::endian::native == std::endian::little, "the comparison below takes the machine's own order");
  EXPECT_EQ(std::memcmp(message.data() + 16, &rate_hz, 8), 0);
  EXPECT_EQ(std::memcmp(message.data() + 24, &rpm, 8), 0);
  EXPECT_EQ(message.substr(32, 8), std::string("\x03\0\0\0\0\0\0\0", 8));
  EXPECT_EQ(std::memcmp(message.data() + 40, &first, 4), 0);
}

TEST(StreamBlock, ComesBackBitForBit) {
  Random random(7);
  for (int round = 0; round < 200; ++round) {
    StreamBlock block;
    block.sequence = any_bits(random);
    block.sample_rate_hz = random.uniform(1.0, 1e5);
    if (round % 2 == 0) block.spindle_speed_rad_per_s = random.uniform(0.0, 3000.0);
    block.channels = 1 + static_cast<int>(random.uniform(0.0, 8.0));
    const auto frames = 1 + static_cast<std::size_t>(random.uniform(0.0, 300.0));
    for (std::size_t i = 0; i < frames * static_cast<std::size_t>(block.channels); ++i) {
      block.samples.push_back(
          std::bit_cast<float>(static_cast<std::uint32_t>(any_bits(random))));  // also NaN, infinities
    }
    const DecodedBlock back = decode_stream_block(bytes(encode_stream_block(block)));
    ASSERT_TRUE(back.block) << back.rejection;
    EXPECT_EQ(back.block->sequence, block.sequence);
    EXPECT_EQ(back.block->sample_rate_hz, block.sample_rate_hz);
    EXPECT_EQ(back.block->channels, block.channels);
    EXPECT_EQ(std::isnan(back.block->spindle_speed_rad_per_s), round % 2 != 0);
    if (round % 2 == 0) {
      EXPECT_NEAR(back.block->spindle_speed_rad_per_s, block.spindle_speed_rad_per_s, 1e-12 * 3000.0);
    }
    ASSERT_EQ(back.block->samples.size(), block.samples.size());
    EXPECT_EQ(std::memcmp(back.block->samples.data(), block.samples.data(), 4 * block.samples.size()), 0);
  }
}

TEST(StreamBlock, ReportsWhatIsWrong) {
  const std::string good = encode_stream_block(some_block());
  const auto rejection = [](const std::string& message) {
    return std::string(decode_stream_block(bytes(message)).rejection);
  };
  const auto with = [&](std::size_t at, std::string_view other) {
    std::string message = good;
    message.replace(at, other.size(), other);
    return message;
  };
  EXPECT_EQ(rejection(""), "is shorter than its header");
  EXPECT_EQ(rejection(good.substr(0, 39)), "is shorter than its header");
  EXPECT_EQ(rejection(good.substr(0, good.size() - 1)), "is cut off");
  EXPECT_EQ(rejection(good + "x"), "is longer than its count says");
  EXPECT_EQ(rejection(good + "xxxx"), "is longer than its count says");
  EXPECT_EQ(rejection(with(0, "{")), "does not begin with RMSB");
  EXPECT_EQ(rejection(with(4, "\x02")), "is of an unknown version");
  EXPECT_EQ(rejection(with(6, std::string_view("\0\0", 2))), "has no channel or more than 256");
  EXPECT_EQ(rejection(with(6, "\xFF\xFF")), "has no channel or more than 256");
  EXPECT_EQ(rejection(with(32, std::string_view("\0\0\0\0", 4))), "holds no frame");
  EXPECT_EQ(rejection(with(32, "\xFF\xFF\xFF\xFF")), "is cut off");
  EXPECT_EQ(rejection(with(16, std::string_view("\0\0\0\0\0\0\0\0", 8))), "has no sample rate between 0 and 10 MHz");
  EXPECT_EQ(rejection(with(16, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF")), "has no sample rate between 0 and 10 MHz");
  EXPECT_EQ(rejection(std::string(max_stream_block_bytes + 1, 'R')), "is larger than 1 MiB");
  const DecodedBlock fast = decode_stream_block(bytes(with(24, "\xFF\xFF\xFF\xFF\xFF\xFF\xEF\x7F")));  // 1.8e308 rpm
  ASSERT_TRUE(fast.block);
  EXPECT_TRUE(std::isnan(fast.block->spindle_speed_rad_per_s));
}

TEST(StreamBlock, RejectsToWriteWhatCannotBeRead) {
  StreamBlock block = some_block();
  block.channels = 4;
  EXPECT_EQ(test::field_of([&] { (void)encode_stream_block(block); }), "samples");
  block.channels = 0;
  EXPECT_EQ(test::field_of([&] { (void)encode_stream_block(block); }), "channels");
  block.channels = 1;
  block.samples.assign(max_stream_block_bytes / 4, 0.0F);
  EXPECT_EQ(test::field_of([&] { (void)encode_stream_block(block); }), "samples");
}

// Hostile bytes: whatever is accepted holds exactly what its header says and would be written so again.
TEST(StreamBlock, SurvivesAnyBytes) {
  Random random(11);
  const std::string good = encode_stream_block(some_block());
  int accepted = 0;
  for (int round = 0; round < test::seeds(200'000); ++round) {
    std::string message = good;
    if (round % 4 == 0) {
      message.resize(static_cast<std::size_t>(random.uniform(0.0, 200.0)));
      for (char& letter : message) letter = static_cast<char>(any_bits(random));
      if (round % 8 == 0 && message.size() >= 4) message.replace(0, 4, "RMSB");
    } else {
      const int changes = 1 + static_cast<int>(random.uniform(0.0, 4.0));
      for (int i = 0; i < changes; ++i) {
        message[static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(message.size())))] =
            static_cast<char>(any_bits(random));
      }
      if (round % 4 == 1) message.resize(static_cast<std::size_t>(random.uniform(0.0, 80.0)), 'x');
    }
    // A copy of its own size on the heap, so that a sanitizer sees any byte read beyond it.
    const std::vector<char> exact(message.begin(), message.end());
    const DecodedBlock read = decode_stream_block(std::as_bytes(std::span(exact)));
    if (!read.block) {
      EXPECT_STRNE(read.rejection, "");
      continue;
    }
    ++accepted;
    ASSERT_EQ(read.block->samples.size(), read.block->frames() * static_cast<std::size_t>(read.block->channels));
    ASSERT_EQ(encode_stream_block(*read.block).size(), message.size());
  }
  EXPECT_GT(accepted, 0);
}

}  // namespace stream_block_test
}  // namespace robomill::monitor
