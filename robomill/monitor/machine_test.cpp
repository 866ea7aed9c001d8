#include "robomill/monitor/machine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "testing/allocations.hpp"
#include "testing/support.hpp"

namespace robomill::monitor {
namespace machine_test {

using std::numbers::pi;

constexpr double rate_hz = 8192.0, rotation_hz = 50.0;

struct Signal {
  double tone_hz = 0.0, tone = 0.0, from_s = 0.0;  // a tone, and when it begins
  double cut = 0.0;                                // of tooth passing
  double knocks_s = 0.0;                           // between two; 0: none
  double runout = 0.0;                             // of each multiple of rotation up to the ninth
  double noise = 0.02;
};

std::vector<float> signal(const Signal& s, double seconds, std::uint64_t seed = 1) {
  Random random(seed);
  std::vector<float> out;
  for (int i = 0; i < static_cast<int>(seconds * rate_hz); ++i) {
    const double t = i / rate_hz;
    double x = s.noise * random.normal();
    for (const int k : {3, 6, 9}) x += s.cut / k * 3.0 * std::sin(2.0 * pi * k * rotation_hz * t + k);
    if (s.cut > 0.0) x += 0.05 * s.cut * std::sin(2.0 * pi * rotation_hz * t);
    for (int k = 1; k <= 9; ++k) x += s.runout * std::sin(2.0 * pi * k * rotation_hz * t + k * k);
    if (t >= s.from_s) x += s.tone * std::min(1.0, 20.0 * (t - s.from_s)) * std::sin(2.0 * pi * s.tone_hz * t);
    if (s.knocks_s > 0.0) {
      const double since = std::fmod(t, s.knocks_s) - 0.5 * s.knocks_s;
      if (since >= 0.0) x += 2.0 * std::exp(-40.0 * since) * std::sin(2.0 * pi * 900.0 * since);
    }
    out.push_back(static_cast<float>(x));
  }
  return out;
}

MonitorOptions options() {
  return {.sample_rate_hz = rate_hz, .spindle_speed_rad_per_s = rotation_hz * units::revolution, .teeth = 3};
}

Machine learnt(const std::vector<Signal>& calm, double seconds = 8.0) {
  std::vector<CalmRecording> recordings;
  for (const Signal& one : calm) recordings.push_back({.name = "calm", .samples = signal(one, seconds)});
  return learn_machine(recordings, options());
}

std::vector<Decision> decisions(const std::vector<float>& samples, const MonitorOptions& with) {
  ChatterMonitor monitor(with);
  std::vector<Decision> out;
  std::span<const float> rest = samples;
  while (!rest.empty()) {
    const std::size_t count = std::min(rest.size(), monitor.frames_to_next_decision());
    out.push_back(monitor.push(rest.first(count)));
    rest = rest.subspan(count);
  }
  return out;
}

int alarms(const std::vector<Decision>& all) {
  return static_cast<int>(
      std::ranges::count_if(all, [](const Decision& d) { return d.state == State::chatter && d.changed; }));
}

const LearntRow& row_near(const Machine& machine, double hz) {
  return *std::ranges::min_element(machine.rows, {},
                                   [&](const LearntRow& row) { return std::abs(row.rotation_hz - hz); });
}

TEST(Machine, LearnsTones) {
  const Machine machine = learnt({{.tone_hz = 733.0, .tone = 0.2}});
  ASSERT_FALSE(machine.tones.empty());
  EXPECT_NEAR(machine.tones.front().frequency_hz, 733.0, 0.5);
  EXPECT_NEAR(machine.tones.front().level, 0.2 / std::sqrt(2.0), 0.01);
  EXPECT_GT(machine.tones.front().share, 0.95);
  EXPECT_EQ(machine.tones.size(), 1U);
  EXPECT_EQ(machine.knocks.per_minute, 0.0);
  // In air no speed is seen. The tone's energy is the square of its amplitude, known to half an octave.
  EXPECT_TRUE(machine.rows.empty());
  EXPECT_NEAR(machine.air.all[72] + machine.air.all[73] + machine.air.all[74], 0.048, 0.011);
  EXPECT_LT(machine.air.all[90], 0.001);
  EXPECT_NEAR(machine.quietest_energy, 0.04, 0.005);
  EXPECT_NEAR(machine.seconds, 7.7, 0.1);
}

TEST(Machine, LearnsKnocks) {
  const Machine machine = learnt({{.knocks_s = 1.0}}, 12.0);
  EXPECT_NEAR(machine.knocks.per_minute, 60.0, 12.0);
  EXPECT_NEAR(machine.knocks.frequency_hz, 900.0, 5.0);
  EXPECT_NEAR(machine.knocks.decay_per_s, 40.0, 8.0);
  // Rings for a third of the hops: it is in the map.
  EXPECT_GT(machine.air.all[90], 0.01);
}

TEST(Machine, LearnsWhatStandsBesideTheOrdersAtASpeed) {
  const Machine machine = learnt({{.tone_hz = 733.0, .tone = 0.1, .cut = 1.0, .runout = 0.1}});
  const LearntRow& row = row_near(machine, rotation_hz);
  EXPECT_NEAR(row.rotation_hz, rotation_hz, 0.1);
  EXPECT_GT(row.hops, 200) << machine.rows.front().rotation_hz << " Hz to " << machine.rows.back().rotation_hz << " Hz";
  EXPECT_GT(row.all[15] + row.all[14], 0.5);
  EXPECT_LT(row.beside[15] + row.beside[14], 0.01) << "tooth passing";
  EXPECT_NEAR(row.beside[72] + row.beside[73] + row.beside[74], 0.01, 0.005);
}

TEST(Machine, ThatRunsUpHasRowsByRisingSpeed) {
  std::vector<float> samples;
  double angle = 0.0;
  Random random(3);
  for (int i = 0; i < static_cast<int>(10.0 * rate_hz); ++i) {
    const double f = 30.0 + 8.0 * std::floor(i / rate_hz / 2.0);
    angle += 2.0 * pi * f / rate_hz;
    double x = 0.01 * random.normal();
    for (int k = 1; k <= 9; ++k) x += (k % 3 == 0 ? 0.5 : 0.1) * std::sin(k * angle + k);
    samples.push_back(static_cast<float>(x));
  }
  MachineLearner learner(options());
  learner.begin(30.0 * units::revolution);
  const std::size_t hop = options().hop_samples();
  for (std::size_t at = 0; at + hop <= samples.size(); at += hop) {
    if (at % (2 * 8192) < hop) {
      learner.set_spindle_speed((30.0 + 8.0 * std::floor(static_cast<double>(at) / rate_hz / 2.0)) * units::revolution);
    }
    ASSERT_FALSE(learner.push(std::span(samples).subspan(at, hop)));
  }
  const Machine machine = learner.finish();
  EXPECT_NO_THROW(machine.validate());
  ASSERT_GE(machine.rows.size(), 4U);
  EXPECT_NEAR(machine.rows.front().rotation_hz, 30.0, 2.0);
  EXPECT_NEAR(machine.rows.back().rotation_hz, 62.0, 2.0);
}

// Without the machine the tone that begins in the cut is an alarm, and so it stays where it is ten times stronger.
TEST(Machine, KnowsItsTones) {
  const Signal tone{.tone_hz = 733.0, .tone = 0.3, .from_s = 2.0, .cut = 0.5};
  MonitorOptions with = options();
  EXPECT_GT(alarms(decisions(signal(tone, 5.0), with)), 0);
  with.machine = std::make_shared<const Machine>(learnt({{.tone_hz = 733.0, .tone = 0.3}}));
  EXPECT_EQ(alarms(decisions(signal(tone, 5.0, 2), with)), 0);
  Signal chatter = tone;
  chatter.tone *= 10.0;
  chatter.cut *= 3.0;
  EXPECT_GT(alarms(decisions(signal(chatter, 5.0, 2), with)), 0);
  Signal elsewhere = tone;
  elsewhere.tone_hz = 1133.0;
  EXPECT_GT(alarms(decisions(signal(elsewhere, 5.0, 2), with)), 0);
}

TEST(Machine, ExplainsWhatIsNew) {
  MonitorOptions with = options();
  with.machine = std::make_shared<const Machine>(learnt({{.tone_hz = 733.0, .tone = 0.3}}));
  int asked = 0;
  for (const Decision& d : decisions(signal({.tone_hz = 733.0, .tone = 0.3, .from_s = 2.0, .cut = 0.5}, 4.0), with)) {
    for (int i = 0; i < d.why.conditions; ++i)
      asked += d.why.condition[static_cast<std::size_t>(i)].quantity == Quantity::line_new;
  }
  EXPECT_GT(asked, 50);
}

TEST(Machine, IsNotLearntFromChatter) {
  const std::vector<CalmRecording> recordings = {
      {.name = "air.wav", .samples = signal({}, 3.0)},
      {.name = "bad.wav", .samples = signal({.tone_hz = 733.0, .tone = 3.0, .from_s = 2.0, .cut = 1.0}, 5.0)}};
  const std::string error = test::rejection([&] { (void)learn_machine(recordings, options()); });
  EXPECT_NE(error.find("bad.wav"), std::string::npos) << error;
  EXPECT_NE(error.find(" at 2."), std::string::npos) << error;
  EXPECT_EQ(test::field_of([&] { (void)learn_machine({}, options()); }), "recordings");
}

TEST(Machine, MustMatchTheSignal) {
  MonitorOptions with = options();
  with.machine = std::make_shared<const Machine>(learnt({{}}));
  EXPECT_NO_THROW(with.validate());
  with.sample_rate_hz = 1.005 * rate_hz;
  EXPECT_NO_THROW(with.validate());
  with.sample_rate_hz = 1.02 * rate_hz;
  EXPECT_EQ(test::field_of([&] { with.validate(); }), "machine");
  with.sample_rate_hz = rate_hz;
  with.channels = 2;
  EXPECT_EQ(test::field_of([&] { with.validate(); }), "machine");
  with.tachometer_channel = 1;
  EXPECT_NO_THROW(with.validate());
}

TEST(Machine, AllocatesNothingInAHop) {
  MonitorOptions with = options();
  with.machine = std::make_shared<const Machine>(learnt({{.tone_hz = 733.0, .tone = 0.3}, {.cut = 1.0}}));
  ChatterMonitor monitor(with);
  const std::vector<float> samples = signal({.tone_hz = 1133.0, .tone = 2.0, .from_s = 1.0, .cut = 1.0}, 3.0);
  EXPECT_EQ(test::allocations([&] { monitor.push(samples); }), 0U);
}

}  // namespace machine_test
}  // namespace robomill::monitor
