#include "robomill/live/session.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <limits>
#include <mutex>
#include <numbers>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/live/inputs.hpp"
#include "robomill/monitor/files/stream_block.hpp"
#include "testing/monitor/signal.hpp"
#include "testing/support.hpp"

namespace robomill::live {
namespace session_test {

using monitor::BlindReason;
using monitor::MonitorEvent;
using monitor::State;

/// Of the published detector, which has nothing to learn: what is reported is the session's own.
monitor::MonitorFile some_file() {
  monitor::MonitorFile file;
  file.columns.channels = {"ax"};
  file.options.kind = monitor::Kind::energy_entropy;
  file.options.threshold = 1e300;
  file.options.sample_rate_hz = 10'240.0;
  return file;
}

Hop noise(Random& random, std::size_t frames = 256) {
  Hop hop;
  for (std::size_t i = 0; i < frames; ++i) hop.samples.push_back(static_cast<float>(random.normal()));
  return hop;
}

/// Keeps the events of a session.
struct Kept {
  std::vector<MonitorEvent> events;
  SessionOutputs outputs() {
    SessionOutputs out;
    out.event = [this](const MonitorEvent& event, const std::string& line) {
      EXPECT_EQ(line.back(), '\n');
      events.push_back(event);
      return true;
    };
    return out;
  }
};

TEST(Session, TimeRunsOnOverWhatIsMissing) {
  Kept kept;
  Session session(some_file(), {.every_window = true}, kept.outputs());
  Random random(1);
  session.process(noise(random));
  Hop after_gap = noise(random);
  after_gap.frames_before = 1024;
  session.process(std::move(after_gap));
  Hop anew = noise(random);
  anew.restarted = true;
  session.process(std::move(anew));
  session.process(noise(random, 100));  // no hop of the detector's yet
  ASSERT_EQ(kept.events.size(), 3U);
  EXPECT_NEAR(kept.events[0].time_s, 256 / 10'240.0, 1.1e-4);
  EXPECT_NEAR(kept.events[1].time_s, (512 + 1024) / 10'240.0, 1.1e-4);
  EXPECT_NEAR(kept.events[2].time_s, (768 + 1024) / 10'240.0, 1.1e-4);
  EXPECT_EQ(kept.events[2].decision.hop, 1U);
  EXPECT_NEAR(session.time_s(), (868 + 1024) / 10'240.0, 1e-9);
}

TEST(Session, EmitsNoticesAsEvents) {
  Kept kept;
  Session session(some_file(), {}, kept.outputs());
  session.notices().add("lost-blocks", "gone", 3);
  session.emit_notices();
  session.notices().add("alarm-recorded", "alarms/a.wav");
  session.emit_notices();
  ASSERT_EQ(kept.events.size(), 2U);
  EXPECT_EQ(kept.events[0].kind, MonitorEvent::Kind::stream);
  EXPECT_EQ(kept.events[0].count, 3U);
  EXPECT_EQ(kept.events[1].kind, MonitorEvent::Kind::recording);
  EXPECT_EQ(kept.events[1].file, "alarms/a.wav");
}

TEST(Session, RunsToTheEndOfItsQueue) {
  Kept kept;
  const std::atomic<bool> stop{false};
  Session session(some_file(), {.every_window = true}, kept.outputs());
  Random random(1);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(session.queue().push(noise(random)));
  session.queue().close();
  session.run(stop);
  EXPECT_EQ(kept.events.size(), 20U);
  EXPECT_EQ(session.metrics().decisions, 20U);
}

TEST(Session, EndsWhereItIsAskedTo) {
  Random random(1);
  const auto decisions_made = [&](SessionOptions options, SessionOutputs outputs, bool stopped) {
    const std::atomic<bool> stop{stopped};
    Session session(some_file(), options, std::move(outputs));
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(session.queue().push(noise(random)));
    session.run(stop);
    Hop more = noise(random);
    EXPECT_FALSE(session.queue().offer(more));  // whoever still reads is let go
    return session.metrics().decisions.load();
  };
  EXPECT_EQ(decisions_made({.seconds = 0.1}, {}, false), 4U);
  EXPECT_EQ(decisions_made({}, {}, true), 0U);
  SessionOutputs nobody;
  nobody.event = [](const MonitorEvent&, const std::string&) { return false; };
  EXPECT_EQ(decisions_made({.every_window = true}, nobody, false), 1U);
}

// In the order of the stream, so that a recording of them has its length.
TEST(Session, DeliversSamplesAndGapsInOrder) {
  std::vector<std::uint64_t> frames;
  std::vector<double> times_s;
  SessionOutputs outputs;
  outputs.samples = [&](std::span<const float> samples) { frames.push_back(samples.size()); };
  outputs.skipped = [&](std::uint64_t count, BlindReason) { frames.push_back(count); };
  outputs.decision = [&](const monitor::Decision&, double time_s, double compute_s) {
    EXPECT_GT(compute_s, 0.0);
    times_s.push_back(time_s);
  };
  Session session(some_file(), {}, std::move(outputs));
  Random random(1);
  session.process(noise(random));
  Hop after_gap = noise(random);
  after_gap.frames_before = 100;
  session.process(std::move(after_gap));
  EXPECT_EQ(frames, (std::vector<std::uint64_t>{256, 100, 256}));
  ASSERT_EQ(times_s.size(), 2U);
  EXPECT_NEAR(times_s[1] - times_s[0], 356 / 10'240.0, 1.1e-4);
}

/// A session that runs on a thread of its own, and the states it reported.
class Running {
 public:
  Running(const monitor::MonitorFile& file, bool live) : session_(file, {.live = live}, outputs()) {}
  ~Running() { end(); }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  void start() {
    thread_ = std::jthread([this] { session_.run(stop_); });
  }
  [[nodiscard]] Session& session() { return session_; }
  [[nodiscard]] std::vector<MonitorEvent> states() {
    const std::scoped_lock lock(mutex_);
    return states_;
  }
  /// Of a session that has ended.
  [[nodiscard]] double silent_s() const { return silent_s_; }
  void end() {
    session_.queue().close();
    if (thread_.joinable()) thread_.join();
  }

 private:
  SessionOutputs outputs() {
    SessionOutputs out;
    out.event = [this](const MonitorEvent& event, const std::string&) {
      const std::scoped_lock lock(mutex_);
      if (event.kind == MonitorEvent::Kind::state) states_.push_back(event);
      return true;
    };
    out.silent = [this](double seconds) { silent_s_ += seconds; };
    return out;
  }

  std::mutex mutex_;
  std::vector<MonitorEvent> states_;
  double silent_s_ = 0.0;
  std::atomic<bool> stop_{false};
  Session session_;
  std::jthread thread_;
};

/// Waits for something to be so; false where it is not within a minute, which only a fault takes.
template <class Condition>
bool wait_for(Condition&& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

TEST(Session, IsBlindWhereNoSamplesCome) {
  Random random(1);
  for (const bool had_samples : {false, true}) {
    monitor::MonitorFile file = some_file();
    file.timeout_s = 0.05;
    Running running(file, true);
    const MetricValues& metrics = running.session().metrics();
    Hop first = noise(random);
    EXPECT_EQ(had_samples && running.session().queue().offer(first), had_samples);
    running.start();
    // Six times as long as it takes: still one event.
    ASSERT_TRUE(wait_for([&] { return metrics.blind_for_s(BlindReason::no_signal) > 0.3; }));
    ASSERT_EQ(running.states().size(), 1U);
    const MonitorEvent silent = running.states()[0];
    EXPECT_EQ(silent.decision.state, State::blind);
    EXPECT_EQ(silent.decision.reason, BlindReason::no_signal);
    EXPECT_NEAR(silent.time_s, had_samples ? 0.025 : 0.0, 1e-9);
    EXPECT_EQ(metrics.state, 3);
    EXPECT_EQ(metrics.decisions, had_samples ? 1U : 0U);
    const double counted_s = metrics.blind_for_s(BlindReason::no_signal);
    const auto counted_at = std::chrono::steady_clock::now();
    Hop next = noise(random);
    next.frames_before = 1024;  // 0.1 s of what was counted already
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::chrono::duration<double> more = std::chrono::steady_clock::now() - counted_at;
    ASSERT_TRUE(running.session().queue().push(std::move(next)));
    ASSERT_TRUE(wait_for([&] { return running.states().size() >= 2; }));
    EXPECT_EQ(metrics.blind_for_s(BlindReason::gap), 0.0);
    EXPECT_NE(running.states()[1].decision.state, State::blind);
    EXPECT_TRUE(running.states()[1].decision.changed);
    running.end();
    EXPECT_GE(running.silent_s(), counted_s + more.count());  // up to the samples that end it
    EXPECT_NEAR(running.silent_s(), metrics.blind_for_s(BlindReason::no_signal), 1e-9);
  }
}

// Whether or not samples come by the clock, and long before the time-out.
TEST(Session, SaysThatItIsIdle) {
  for (const bool live : {false, true}) {
    monitor::MonitorFile file = some_file();
    file.timeout_s = 3600.0;
    std::atomic<int> idle{0}, decisions{0};
    std::atomic<bool> stop{false};
    SessionOutputs outputs;
    outputs.idle = [&] { ++idle; };
    outputs.decision = [&](const monitor::Decision&, double, double) { ++decisions; };
    Session session(file, {.live = live}, std::move(outputs));
    std::jthread thread([&] { session.run(stop); });
    ASSERT_TRUE(wait_for([&] { return idle >= 2; }));
    Random random(1);
    ASSERT_TRUE(session.queue().push(noise(random)));
    ASSERT_TRUE(wait_for([&] { return decisions == 1; }));
    const int before = idle;
    EXPECT_TRUE(wait_for([&] { return idle > before; }));
    session.queue().close();
  }
}

// A file that is slow to read, or is kept waiting, has no clock.
TEST(Session, AwaitsNoSamplesOfARecording) {
  Random random(1);
  monitor::MonitorFile file = some_file();
  file.timeout_s = 0.001;
  Running running(file, false);
  running.start();
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  ASSERT_TRUE(running.session().queue().push(noise(random)));
  running.end();
  EXPECT_EQ(running.session().metrics().decisions, 1U);
  EXPECT_TRUE(running.states().empty());
}

TEST(Session, IsBlindForTheTimeOfALongGap) {
  Kept kept;
  Session session(some_file(), {}, kept.outputs());
  Random random(1);
  session.process(noise(random));
  Hop after_hop = noise(random);
  after_hop.frames_before = 256;  // one that was left out is counted, and no event
  session.process(std::move(after_hop));
  EXPECT_TRUE(kept.events.empty());
  Hop after_gap = noise(random);
  after_gap.frames_before = 20'480;
  session.process(std::move(after_gap));
  ASSERT_EQ(kept.events.size(), 2U);
  EXPECT_EQ(kept.events[0].decision.state, State::blind);
  EXPECT_EQ(kept.events[0].decision.reason, BlindReason::gap);
  EXPECT_NEAR(kept.events[0].time_s, 768 / 10'240.0, 1e-9);
  EXPECT_NE(kept.events[1].decision.state, State::blind);
  EXPECT_NEAR(kept.events[1].time_s, (1024 + 20'480) / 10'240.0, 1.1e-4);
  EXPECT_NEAR(session.metrics().blind_for_s(BlindReason::gap), 2.025, 1e-9);
}

TEST(Session, IsBlindWhileTheStreamSaysThatTheSpindleStandsStill) {
  monitor::MonitorFile file = some_file();
  file.options.spindle_speed_rad_per_s = 300.0;
  Kept kept;
  Session session(file, {}, kept.outputs());
  Random random(1);
  for (const double speed : {0.0, 0.005, 600.0}) {
    for (int i = 0; i < 3; ++i) {
      Hop hop = noise(random);
      hop.spindle_speed_rad_per_s = speed;
      session.process(std::move(hop));
    }
  }
  ASSERT_EQ(kept.events.size(), 2U);
  EXPECT_EQ(kept.events[0].decision.reason, BlindReason::standstill);
  EXPECT_NEAR(kept.events[0].time_s, 0.025, 1.1e-4);
  EXPECT_NE(kept.events[1].decision.state, State::blind);
  EXPECT_NEAR(kept.events[1].time_s, 0.175, 1.1e-4);
  EXPECT_NEAR(session.metrics().blind_for_s(BlindReason::standstill), 6 * 0.025, 1e-9);
}

// A stream that no longer knows the speed does not say that the spindle still stands: then the file's hint holds, or
// none. Where it turned, it is taken to turn as before.
TEST(Session, AnUnknownSpeedEndsAStandstill) {
  for (const double hint : {300.0, 0.0}) {
    for (const double unknown : {std::nan(""), -1.0}) {
      monitor::MonitorFile file = some_file();
      file.options.spindle_speed_rad_per_s = hint;
      std::vector<monitor::Decision> decisions;
      SessionOutputs outputs;
      outputs.decision = [&](const monitor::Decision& decision, double, double) { decisions.push_back(decision); };
      Session session(file, {}, std::move(outputs));
      Random random(1);
      for (const double speed : {600.0, unknown, 0.0, unknown, unknown}) {
        Hop hop = noise(random);
        hop.spindle_speed_rad_per_s = speed;
        session.process(std::move(hop));
      }
      ASSERT_EQ(decisions.size(), 5U);
      EXPECT_NEAR(decisions[1].spindle_speed_rad_per_s, 600.0, 60.0);
      EXPECT_EQ(decisions[2].reason, BlindReason::standstill);
      for (const std::size_t i : {3U, 4U}) {
        EXPECT_NE(decisions[i].reason, BlindReason::standstill);
        EXPECT_NEAR(decisions[i].spindle_speed_rad_per_s, hint, 0.15 * hint);
      }
    }
  }
}

// That there was no room for a hop says nothing of the cut: until the detector's window holds no hole.
TEST(Session, IsBlindWhereHopsWereLeftOut) {
  Kept kept;
  std::vector<BlindReason> skipped;
  SessionOutputs outputs = kept.outputs();
  outputs.skipped = [&](std::uint64_t frames, BlindReason reason) {
    EXPECT_EQ(frames, 512U);
    skipped.push_back(reason);
  };
  Session session(some_file(), {}, std::move(outputs));
  Random random(1);
  for (int i = 0; i < 5; ++i) session.process(noise(random));
  ASSERT_TRUE(kept.events.empty());
  Hop after = noise(random);
  after.frames_before = 512;
  after.dropped = true;
  session.process(std::move(after));
  ASSERT_EQ(kept.events.size(), 1U);
  EXPECT_EQ(kept.events[0].decision.state, State::blind);
  EXPECT_EQ(kept.events[0].decision.reason, BlindReason::overloaded);
  EXPECT_EQ(session.metrics().state, 3);
  for (int i = 0; i < 20; ++i) session.process(noise(random));
  ASSERT_EQ(kept.events.size(), 2U);
  EXPECT_NE(kept.events[1].decision.state, State::blind);
  EXPECT_TRUE(kept.events[1].decision.changed);
  EXPECT_NEAR(kept.events[1].time_s - kept.events[0].time_s, 0.325, 0.03);
  EXPECT_EQ(skipped, std::vector<BlindReason>{BlindReason::overloaded});
  EXPECT_EQ(session.metrics().blind_for_s(BlindReason::gap), 0.0);
  EXPECT_NEAR(session.metrics().blind_for_s(BlindReason::overloaded), 0.05 + 0.3, 0.03);
  const std::string text = session.metrics().text();
  EXPECT_NE(text.find("\nrobomill_blind_seconds_total{reason=\"overloaded\"} 0.3"), std::string::npos) << text;
}

// The thread of the decisions is stuck: another one says so, once, and the next decision that is in time ends it.
TEST(Session, AnotherThreadSaysThatDecisionsAreStuck) {
  monitor::MonitorFile file = some_file();
  file.timeout_s = 3600.0;
  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  std::mutex mutex;
  std::vector<MonitorEvent> said, states;
  SessionOutputs outputs;
  outputs.decision = [&](const monitor::Decision& decision, double, double) {
    if (decision.hop == 3) released.wait_for(std::chrono::minutes(1));
  };
  outputs.event = [&](const MonitorEvent& event, const std::string&) {
    const std::scoped_lock lock(mutex);
    if (event.kind == MonitorEvent::Kind::state) states.push_back(event);
    return true;
  };
  outputs.overloaded = [&](const MonitorEvent& event, const std::string& line) {
    const std::scoped_lock lock(mutex);
    EXPECT_NE(line.find("\"reason\":\"overloaded\""), std::string::npos) << line;
    said.push_back(event);
  };
  const auto count = [&](const std::vector<MonitorEvent>& events) {
    const std::scoped_lock lock(mutex);
    return events.size();
  };
  std::atomic<bool> stop{false};
  Session session(file, {.live = true}, std::move(outputs));
  std::jthread thread([&] { session.run(stop); });
  Random random(1);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(session.queue().push(noise(random)));
  const MetricValues& metrics = session.metrics();
  ASSERT_TRUE(wait_for([&] { return count(said) == 1; }));
  EXPECT_EQ(metrics.state, 3);
  EXPECT_EQ(said[0].decision.reason, BlindReason::overloaded);
  EXPECT_GE(metrics.blind_for_s(BlindReason::overloaded), Load::longest_s);
  EXPECT_GE(metrics.behind_s, Load::longest_s);
  ASSERT_TRUE(wait_for([&] { return metrics.blind_for_s(BlindReason::overloaded) >= Load::longest_s + 0.3; }));
  EXPECT_EQ(count(said), 1U);
  EXPECT_EQ(count(states), 0U);
  release.set_value();
  ASSERT_TRUE(wait_for([&] { return metrics.decisions == 5; }));
  EXPECT_EQ(metrics.state, 3);  // of these it was said too late
  ASSERT_TRUE(session.queue().push(noise(random)));
  ASSERT_TRUE(wait_for([&] { return count(states) == 1; }));
  EXPECT_NE(states[0].decision.state, State::blind);
  EXPECT_TRUE(states[0].decision.changed);
  session.queue().close();
}

// The default detector has seen nothing calm yet: an event at once, and another one where it knows, or begins anew.
TEST(Session, IsBlindWhileItLearns) {
  monitor::MonitorFile file = some_file();
  file.options.kind = monitor::Kind::comb_cusum;
  file.options.spindle_speed_rad_per_s = 300.0;
  Kept kept;
  Session session(file, {}, kept.outputs());
  Random random(1);
  for (int i = 0; i < 125; ++i) session.process(noise(random));
  Hop anew = noise(random);
  anew.restarted = true;
  session.process(std::move(anew));
  std::vector<MonitorEvent> states;
  for (const MonitorEvent& event : kept.events) {
    if (event.kind == MonitorEvent::Kind::state) states.push_back(event);
  }
  ASSERT_EQ(states.size(), 3U);
  EXPECT_EQ(states[0].decision.reason, BlindReason::learning);
  EXPECT_NEAR(states[0].time_s, 0.025, 1.1e-4);
  EXPECT_EQ(states[1].decision.state, State::stable);
  EXPECT_NEAR(states[1].time_s, 3.0, 1.1e-4);
  EXPECT_EQ(states[2].decision.reason, BlindReason::learning);
  EXPECT_NEAR(states[2].time_s, 3.15, 1.1e-4);
  EXPECT_NEAR(session.metrics().blind_for_s(BlindReason::learning), 2.975 + 0.025, 1e-9);
  EXPECT_EQ(session.metrics().state, 3);
  const std::string text = session.metrics().text();
  EXPECT_NE(text.find("\nrobomill_blind_seconds_total{reason=\"learning\"} "), std::string::npos) << text;
}

// What the monitor itself cannot judge: a gap that was filled, then a sensor that is dead.
TEST(Session, ReportsEveryReasonToBeBlind) {
  Kept kept;
  Session session(some_file(), {}, kept.outputs());
  Random random(1);
  session.process(noise(random));
  const auto constant = [](float value) { return Hop{.samples = std::vector<float>(256, value)}; };
  session.process(constant(std::numeric_limits<float>::quiet_NaN()));
  for (int i = 0; i < 3; ++i) session.process(constant(0.0F));
  std::vector<BlindReason> reasons;
  for (const MonitorEvent& event : kept.events) {
    if (event.kind == MonitorEvent::Kind::state) reasons.push_back(event.decision.reason);
  }
  EXPECT_EQ(reasons, (std::vector<BlindReason>{BlindReason::gap, BlindReason::no_signal}));
  EXPECT_NEAR(session.metrics().blind_for_s(BlindReason::gap), 0.025, 1e-9);
  EXPECT_NEAR(session.metrics().blind_for_s(BlindReason::no_signal), 0.075, 1e-9);
  const std::string text = session.metrics().text();
  EXPECT_NE(text.find("\nrobomill_blind_seconds_total{reason=\"gap\"} 0.025\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\nrobomill_blind_seconds_total{reason=\"clipped\"} 0\n"), std::string::npos) << text;
}

std::string message(std::uint64_t number, double rate_hz = 10'240.0, int channels = 1) {
  monitor::StreamBlock block;
  block.sequence = number;
  block.sample_rate_hz = rate_hz;
  block.channels = channels;
  block.samples.assign(256 * static_cast<std::size_t>(channels), static_cast<float>(number));
  return monitor::encode_stream_block(block);
}

TEST(StreamIntake, RejectsWhatIsNotWanted) {
  HopQueue queue(100);
  Notices notices;
  MetricValues metrics;
  StreamIntake intake(some_file(), queue, notices, metrics);
  const auto take = [&](const std::string& payload) {
    intake.message(std::as_bytes(std::span(payload.data(), payload.size())));
  };
  const auto reported = [&] {
    const std::vector<Notice> all = notices.take(Notices::Clock::now(), true);
    return all.empty() ? std::string() : all.front().message;
  };
  take("x");
  EXPECT_EQ(reported(), "a message is shorter than its header");
  take(message(0, 5000.0));
  EXPECT_NE(reported().find("was sampled at 5000 Hz"), std::string::npos);
  take(message(0, 10'240.0, 3));
  EXPECT_NE(reported().find("has no column ax"), std::string::npos);
  EXPECT_EQ(queue.size(), 0U);
  EXPECT_EQ(metrics.rejected_messages, 3U);
  take(message(0, 10'245.0));
  EXPECT_EQ(reported(), "");
  EXPECT_EQ(queue.size(), 1U);
}

// Hops leave in order with NaN in the place of what was lost.
TEST(StreamIntake, FillsWhatWasLost) {
  HopQueue queue(100);
  Notices notices;
  MetricValues metrics;
  StreamIntake intake(some_file(), queue, notices, metrics);
  for (const std::uint64_t number : std::vector<std::uint64_t>{0, 1, 3, 2, 6, 7}) {
    const std::string payload = message(number);
    intake.message(std::as_bytes(std::span(payload.data(), payload.size())));
  }
  EXPECT_EQ(queue.size(), 4U);
  intake.give_up();
  std::vector<float> firsts;
  Hop hop;
  while (queue.pop(hop, std::chrono::milliseconds(0)) == HopQueue::Taken::hop) firsts.push_back(hop.samples.front());
  ASSERT_EQ(firsts.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    if (i == 4 || i == 5) {
      EXPECT_TRUE(std::isnan(firsts[i])) << i;
    } else {
      EXPECT_EQ(firsts[i], static_cast<float>(i));
    }
  }
  EXPECT_EQ(metrics.lost_blocks, 2U);
  const std::vector<Notice> reported = notices.take(Notices::Clock::now(), true);
  ASSERT_EQ(reported.size(), 2U);
  EXPECT_EQ(reported[0].what, "lost-blocks");
  EXPECT_EQ(reported[0].count, 2U);
  EXPECT_EQ(reported[1].what, "reordered-blocks");
}

TEST(Session, AHintThatTheSignalContradictsIsReportedOnce) {
  const monitor::testing::SyntheticCut cut{.rotation_hz = 75.0, .seconds = 5.0};
  const std::vector<float> x = monitor::testing::vibration(cut);
  for (const double share : {1.0, 1.1}) {
    Kept kept;
    monitor::MonitorFile file = some_file();
    file.options.kind = monitor::Kind::comb_cusum;
    file.options.teeth = cut.teeth;
    file.options.spindle_speed_rad_per_s = share * cut.rotation_hz * 2.0 * std::numbers::pi;
    Session session(file, {}, kept.outputs());
    for (std::size_t at = 0; at + 256 <= x.size(); at += 256) {
      session.process({.samples = {x.begin() + static_cast<std::ptrdiff_t>(at),
                                   x.begin() + static_cast<std::ptrdiff_t>(at + 256)}});
      session.emit_notices(true);
    }
    std::vector<std::string> said;
    for (const MonitorEvent& event : kept.events) {
      if (event.what == "spindle-speed") said.push_back(event.message);
    }
    if (share == 1.0) {
      EXPECT_TRUE(said.empty());
    } else {
      EXPECT_EQ(said, std::vector<std::string>{"the signal says 4500 rpm, 4950 rpm was given"});
    }
  }
}

}  // namespace session_test
}  // namespace robomill::live
