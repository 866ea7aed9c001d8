#include "robomill/io/records/samples/sample_alignment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/io/sample_source.hpp"
#include "testing/support.hpp"

namespace robomill::io {
namespace sample_alignment_test {

template <class Number>
std::string bytes_of(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), sizeof(Number) * numbers.size()};
}

/// A comb of tooth passing with noise, as many frames of one column or two; rms 1.
std::vector<double> cut(Random& random, std::size_t count, double noise) {
  std::vector<double> out(count);
  const double phase = random.uniform(0.0, 6.0);
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = noise * random.normal();
    for (int k = 1; k <= 5; ++k) {
      out[i] += std::sqrt((1.0 - noise * noise) * 0.4) *
                std::sin(2.0 * std::numbers::pi * 0.013 * k * static_cast<double>(i) + k * phase);
    }
  }
  return out;
}

std::vector<std::int16_t> counts(const std::vector<double>& of, double rms_counts, double step = 1.0) {
  std::vector<std::int16_t> out;
  for (const double x : of) {
    const double rounded = step * std::round(rms_counts * x / step);
    out.push_back(static_cast<std::int16_t>(std::clamp(rounded, -32'768.0, 32'767.0)));
  }
  return out;
}

std::vector<float> floats(const std::vector<double>& of, double scale) {
  std::vector<float> out;
  for (const double x : of) out.push_back(static_cast<float>(scale * x));
  return out;
}

/// Of all windows, in blocks of a hop.
std::size_t misaligned_blocks(std::string_view bytes, std::size_t columns, bool is_int16) {
  SampleAlignment alignment(columns, is_int16);
  const std::size_t block = 256 * columns * (is_int16 ? 2 : 4);
  std::size_t found = 0;
  for (std::size_t at = 0; at + block <= bytes.size(); at += block) {
    if (alignment.take(bytes.substr(at, block))) ++found;
  }
  return found;
}

constexpr std::size_t blocks = 20;

TEST(SampleAlignment, FindsFloatsThatLostAByte) {
  Random random(1);
  // In any unit that a sensor may have, of one column or two, and of converters of 12, 16 and 24 bits, whose numbers
  // end in zeros.
  for (const double scale : {1e-9, 1e-3, 1.0, 9.81, 1e6}) {
    for (const double counts_of_full_scale : {0.0, 2048.0, 32'768.0, 8'388'608.0}) {
      std::vector<double> x = cut(random, 256 * (blocks + 1) + 8, 0.3);
      if (counts_of_full_scale > 0.0) {
        for (double& value : x) value = std::round(0.2 * counts_of_full_scale * value) / counts_of_full_scale;
      }
      const std::string bytes = bytes_of(floats(x, scale));
      for (const std::size_t columns : {std::size_t{1}, std::size_t{2}}) {
        const std::size_t most = blocks / columns;
        const std::size_t size = 4 * 256 * blocks;
        EXPECT_EQ(misaligned_blocks(bytes.substr(0, size), columns, false), 0U) << scale;
        for (std::size_t lost = 1; lost < 4; ++lost) {
          EXPECT_EQ(misaligned_blocks(bytes.substr(lost, size), columns, false), most)
              << scale << ' ' << counts_of_full_scale << ' ' << lost;
        }
      }
    }
  }
}

TEST(SampleAlignment, FindsCountsThatLostAByte) {
  Random random(1);
  for (const double noise : {0.1, 0.5, 1.0}) {
    for (const double rms : {3.0, 30.0, 100.0, 300.0, 3000.0, 6500.0}) {
      for (const double step : {1.0, 16.0}) {  // of 16 bits, or 12 at the upper end
        const std::string bytes = bytes_of(counts(cut(random, 256 * (blocks + 1), noise), std::max(rms, step), step));
        for (const std::size_t columns : {std::size_t{1}, std::size_t{2}}) {
          const std::size_t size = 2 * 256 * blocks;
          EXPECT_EQ(misaligned_blocks(bytes.substr(0, size), columns, true), 0U) << noise << ' ' << rms;
          EXPECT_EQ(misaligned_blocks(bytes.substr(1, size), columns, true), blocks / columns)
              << noise << ' ' << rms << ' ' << step;
        }
      }
    }
  }
}

// What is odd but not misaligned.
TEST(SampleAlignment, LeavesOddSignalsAlone) {
  Random random(1);
  const std::size_t size = 256 * blocks;
  const auto as_counts = [&](auto value) {
    std::vector<double> x(size);
    for (std::size_t i = 0; i < size; ++i) x[i] = value(i);
    return misaligned_blocks(bytes_of(counts(x, 1.0)), 1, true);
  };
  EXPECT_EQ(as_counts([&](std::size_t) { return 0.0; }), 0U);
  EXPECT_EQ(as_counts([&](std::size_t) { return 5000.0; }), 0U);
  EXPECT_EQ(as_counts([&](std::size_t) { return std::round(random.normal()); }), 0U);  // a count of noise
  EXPECT_EQ(as_counts([&](std::size_t) { return 20'000.0 * random.normal(); }), 0U);   // some at full scale
  EXPECT_EQ(as_counts([&](std::size_t) { return 1e6 * random.normal(); }), 0U);        // clipped to squares
  EXPECT_EQ(as_counts([&](std::size_t i) { return 32'700.0 * std::sin(0.1 * static_cast<double>(i)); }), 0U);
  EXPECT_EQ(as_counts([&](std::size_t) { return 256.0 * std::round(20.0 * random.normal()); }), 0U);  // of 8 bits
  EXPECT_EQ(as_counts([&](std::size_t) { return random.uniform(-32'768.0, 32'767.0); }), 0U);
  EXPECT_EQ(as_counts([&](std::size_t i) { return 3.0 * static_cast<double>(i % 10'000); }), 0U);  // a ramp
  const auto as_floats = [&](auto value) {
    std::vector<float> x(size);
    for (std::size_t i = 0; i < size; ++i) x[i] = static_cast<float>(value(i));
    return misaligned_blocks(bytes_of(x), 1, false);
  };
  EXPECT_EQ(as_floats([&](std::size_t) { return 0.0; }), 0U);
  EXPECT_EQ(as_floats([&](std::size_t) { return std::numeric_limits<double>::quiet_NaN(); }), 0U);
  EXPECT_EQ(as_floats([&](std::size_t) { return std::numeric_limits<double>::infinity(); }), 0U);
  EXPECT_EQ(as_floats([&](std::size_t i) { return std::exp(-0.01 * static_cast<double>(i)) * random.normal(); }), 0U);
  // Pulses between two levels beside vibration: a lost byte would shift both.
  const std::vector<std::int16_t> vibration = counts(cut(random, size, 0.3), 1000.0);
  std::vector<std::int16_t> both;
  for (std::size_t i = 0; i < size; ++i) {
    both.push_back(vibration[i]);
    both.push_back(static_cast<std::int16_t>((i % 200 < 20 ? 0x4000 : 0) + static_cast<int>(random.index(3))));
  }
  EXPECT_EQ(misaligned_blocks(bytes_of(both), 2, true), 0U);
}

// As a monitor reads them: what was lost on the way shows, numbers that mean nothing do not.
TEST(SampleAlignment, MisalignedSamplesAreInfinite) {
  const test::Folder folder;
  Random random(1);
  const std::vector<float> x = floats(cut(random, 2048, 0.3), 9.81);
  std::string bytes = bytes_of(x);
  bytes.erase(4 * 1024, 1);
  const auto source = open_samples(folder.file("lost.raw", bytes), {.channels = {"1"}}, RawFormat::float32);
  SampleBlock block;
  std::vector<float> read;
  while (source->next(256, block)) read.insert(read.end(), block.samples.begin(), block.samples.end());
  ASSERT_EQ(read.size(), 2047U);
  EXPECT_TRUE(std::equal(x.begin(), x.begin() + 1024, read.begin()));
  // The last block is shorter than a window and a half: the verdict on the one before stands.
  EXPECT_TRUE(std::all_of(read.begin() + 1024, read.end(), [](float value) { return std::isinf(value); }));
  EXPECT_EQ(source->misaligned_frames(), 1023U);
}

}  // namespace sample_alignment_test
}  // namespace robomill::io
