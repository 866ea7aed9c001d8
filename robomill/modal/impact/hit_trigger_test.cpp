#include "robomill/modal/impact/hit_trigger.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/modal/impact/hits_check.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace hit_trigger_test {

using test::rejection;

constexpr double rate_hz = 10'240.0;
constexpr std::size_t channels = 3;

/// A stream with noise and an offset; the force is channel 1.
struct Stream {
  std::vector<float> samples;
  std::vector<std::size_t> hits;  ///< first frames of pulses
  std::vector<std::size_t> peaks;

  Stream(double seconds, double noise_n, double offset_n, Random& random) {
    const auto frames = static_cast<std::size_t>(seconds * rate_hz);
    for (std::size_t i = 0; i < frames; ++i) {
      samples.push_back(static_cast<float>(random.normal()));
      samples.push_back(static_cast<float>(offset_n + noise_n * random.normal()));
      samples.push_back(static_cast<float>(i % 1024));
    }
  }
  [[nodiscard]] std::size_t frames() const { return samples.size() / channels; }
  [[nodiscard]] double force(std::size_t frame) const { return samples[channels * frame + 1]; }
  void push(double at_s, double peak_n, std::size_t length) {
    const auto first = static_cast<std::size_t>(at_s * rate_hz);
    for (std::size_t i = 1; i < length; ++i) {
      const double way = static_cast<double>(i) / static_cast<double>(length);
      samples[channels * (first + i) + 1] += static_cast<float>(peak_n * std::sin(std::numbers::pi * way));
    }
    hits.push_back(first);
    peaks.push_back(first + length / 2);
  }
};

struct Cut {
  std::vector<HitRecord> records;
  std::vector<std::uint64_t> discarded;
  std::size_t triggered = 0;
};

HitTriggerOptions options_of(double level_n = 0.0) {
  return {.sample_rate_hz = rate_hz, .channels = channels, .force_channel = 1, .level_n = level_n, .record_s = 0.4};
}

HitTrigger::Calls into(Cut& cut) {
  return {.triggered = [&cut] { ++cut.triggered; },
          .record = [&cut](const HitRecord& record) { cut.records.push_back(record); },
          .discarded = [&cut](const HitRecord& record) { cut.discarded.push_back(record.trigger_frame); }};
}

/// @param most  frames a block; each block has a random length up to that
Cut cut(const Stream& stream, const HitTriggerOptions& options, std::size_t most, Random& random) {
  Cut out;
  HitTrigger trigger(options, into(out));
  for (std::size_t at = 0; at < stream.frames();) {
    const std::size_t count = std::min(stream.frames() - at, 1 + random.index(most));
    trigger.add(std::span(stream.samples).subspan(channels * at, channels * count));
    at += count;
  }
  return out;
}

/// A record as a hit with its force alone, for the rules that reject it.
HitVerdict judged(const HitRecord& record, double factor = 1.0) {
  const auto frames = static_cast<Eigen::Index>(record.samples.size() / channels);
  Hit hit{.file = "hit", .excitation = {.axis = Axis::x}, .sample_rate_hz = rate_hz, .force_n = {}, .responses = {}};
  hit.force_n.resize(frames);
  for (Eigen::Index i = 0; i < frames; ++i) {
    hit.force_n(i) = factor * static_cast<double>(record.samples[channels * static_cast<std::size_t>(i) + 1]);
  }
  return judge_hit(hit, find_pulse(hit.force_n), {});
}

// Property: planted hits are all found, between the pulse's begin and its peak, and nothing else is; how the stream is
// cut into blocks changes no bit.
TEST(HitTrigger, FindsEveryHit) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const double noise_n = random.uniform(0.01, 1.0);
    Stream stream(12.0, noise_n, random.uniform(-50.0, 50.0), random);
    for (double at_s = random.uniform(0.2, 0.6); at_s < 11.0; at_s += random.uniform(0.8, 2.0)) {
      stream.push(at_s, noise_n * random.uniform(40.0, 400.0), 5 + random.index(30));
    }
    const HitTriggerOptions options = options_of();
    const Cut whole = cut(stream, options, stream.frames(), random);
    ASSERT_EQ(whole.records.size(), stream.hits.size()) << seed;
    EXPECT_TRUE(whole.discarded.empty());
    for (std::size_t i = 0; i < stream.hits.size(); ++i) {
      const HitRecord& record = whole.records[i];
      EXPECT_GT(record.trigger_frame, stream.hits[i]) << seed;
      EXPECT_LE(record.trigger_frame, stream.peaks[i] + 1) << seed;
      EXPECT_EQ(record.trigger_frame - record.first_frame, options.pre_frames());
      ASSERT_EQ(record.samples.size(), channels * options.record_frames());
      const auto first = stream.samples.begin() + static_cast<std::ptrdiff_t>(channels * record.first_frame);
      EXPECT_TRUE(std::equal(record.samples.begin(), record.samples.end(), first)) << seed;
      for (const std::string& reason : judged(record).reasons) {  // of hits just above the noise
        EXPECT_EQ(reason.find("trigger"), std::string::npos) << seed << ": " << reason;
      }
    }
    const Cut parted = cut(stream, options, 1 + random.index(3000), random);
    ASSERT_EQ(parted.records.size(), whole.records.size()) << seed;
    for (std::size_t i = 0; i < whole.records.size(); ++i) {
      EXPECT_EQ(parted.records[i].trigger_frame, whole.records[i].trigger_frame) << seed;
      EXPECT_EQ(parted.records[i].samples, whole.records[i].samples) << seed;
    }
  }
}

// With a level the sample is known: the first one beyond it.
TEST(HitTrigger, TriggersAtTheFirstSampleBeyondALevel) {
  Random random(7);
  Stream stream(3.0, 0.0, 0.0, random);
  stream.push(1.0, 100.0, 40);
  const Cut found = cut(stream, options_of(30.0), 777, random);
  ASSERT_EQ(found.records.size(), 1u);
  std::size_t expected = stream.hits[0];
  while (stream.force(expected) <= 30.0) ++expected;
  EXPECT_EQ(found.records[0].trigger_frame, expected);
  EXPECT_TRUE(cut(stream, options_of(101.0), 777, random).records.empty());
}

// A sensor wired the other way round, or a hit against the axis whose push reads negative: the factor turns it. Without
// the factor it is cut out too, and rejected with a reason that says what is wrong.
TEST(HitTrigger, TakesPushesOfEitherSign) {
  Random random(8);
  Stream stream(3.0, 0.1, 3.0, random);
  stream.push(1.0, -80.0, 20);
  HitTriggerOptions options = options_of();
  for (const double factor : {1.0, -1.0, -0.02}) {
    options.force_factor = factor;
    const Cut found = cut(stream, options, 100, random);
    ASSERT_EQ(found.records.size(), 1u) << factor;
    EXPECT_LE(found.records[0].trigger_frame, stream.peaks[0]);
    const HitVerdict verdict = judged(found.records[0], factor);
    EXPECT_EQ(verdict.accepted, factor < 0.0);
    if (factor > 0.0) {
      EXPECT_NE(verdict.reasons[0].find("turn the sign"), std::string::npos);
    }
  }
}

TEST(HitTrigger, HoldsADoubleHitInOneRecord) {
  Random random(9);
  Stream stream(4.0, 0.1, 0.0, random);
  stream.push(1.0, 100.0, 20);
  stream.push(1.06, 40.0, 20);
  stream.push(2.5, 90.0, 20);
  Cut found = cut(stream, options_of(), 256, random);
  ASSERT_EQ(found.records.size(), 2u);
  ASSERT_FALSE(judged(found.records[0]).accepted);
  EXPECT_NE(judged(found.records[0]).reasons[0].find("double hit"), std::string::npos);
  EXPECT_TRUE(judged(found.records[1]).accepted);
  // A bounce behind the end of a short record is no hit either: the structure still moves.
  HitTriggerOptions brief = options_of();
  brief.record_s = 0.05;
  found = cut(stream, brief, 256, random);
  ASSERT_EQ(found.records.size(), 2u);
  EXPECT_GE(found.records[1].trigger_frame, stream.hits[2]);
}

TEST(HitTrigger, DiscardsWhatSamplesAreMissingFrom) {
  Random random(10);
  Stream stream(6.0, 0.1, 0.0, random);
  stream.push(1.0, 100.0, 20);
  stream.push(2.5, 100.0, 20);
  stream.push(4.5, 100.0, 20);
  const float missing = std::numeric_limits<float>::quiet_NaN();
  stream.samples[channels * (stream.hits[0] + 2000) + 2] = missing;  // of a response, in the record
  stream.samples[channels * (stream.hits[1] - 100)] = missing;       // right before one
  const Cut found = cut(stream, options_of(), 512, random);
  EXPECT_EQ(found.triggered, 3u);
  EXPECT_EQ(found.discarded.size(), 2u);
  ASSERT_EQ(found.records.size(), 1u);
  EXPECT_GT(found.records[0].trigger_frame, stream.hits[2]);
  // The same where the frames did not come at all.
  Cut jumped;
  HitTrigger trigger(options_of(), into(jumped));
  const std::size_t at = channels * (stream.hits[2] + 1000);
  trigger.add(std::span(stream.samples).first(at));
  EXPECT_TRUE(trigger.recording());
  trigger.gap(5);
  EXPECT_FALSE(trigger.recording());
  trigger.add(std::span(stream.samples).subspan(at));
  EXPECT_EQ(jumped.discarded.size(), 3u);
  EXPECT_TRUE(jumped.records.empty());
}

TEST(HitTrigger, NeverTriggersWithoutAHit) {
  Random random(11);
  for (const double noise_n : {0.0, 0.5}) {
    const Stream stream(20.0, noise_n, 12.0, random);
    const Cut found = cut(stream, options_of(), 4096, random);
    EXPECT_EQ(found.triggered, 0u) << noise_n;
  }
  // Handling the hammer after a hit does not trigger.
  Stream handled(6.0, 0.1, 0.0, random);
  handled.push(1.0, 500.0, 20);
  handled.push(3.0, 10.0, 400);
  EXPECT_EQ(cut(handled, options_of(), 999, random).records.size(), 1u);
}

TEST(HitTrigger, RejectsOptions) {
  const auto said = [](auto&& change) {
    HitTriggerOptions options = options_of();
    change(options);
    return rejection([&] { options.validate(); });
  };
  EXPECT_NO_THROW(options_of().validate());
  EXPECT_NE(said([](HitTriggerOptions& o) { o.sample_rate_hz = 0.0; }).find("sample_rate_hz"), std::string::npos);
  EXPECT_NE(said([](HitTriggerOptions& o) { o.record_s = 0.01; }).find("at least 512"), std::string::npos);
  EXPECT_NE(said([](HitTriggerOptions& o) { o.record_s = 999.0; }).find("at most 2097152 values"), std::string::npos);
  EXPECT_NE(said([](HitTriggerOptions& o) { o.force_channel = 3; }).find("force_channel"), std::string::npos);
  EXPECT_NE(said([](HitTriggerOptions& o) { o.force_factor = 0.0; }).find("force_factor"), std::string::npos);
  EXPECT_NE(said([](HitTriggerOptions& o) { o.level_n = -1.0; }).find("level_n"), std::string::npos);
  EXPECT_NE(said([](HitTriggerOptions& o) { o.channels = 0; }).find("channels"), std::string::npos);
}

}  // namespace hit_trigger_test
}  // namespace robomill::modal
