#include "robomill/live/inputs.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/live/session.hpp"
#include "testing/support.hpp"

namespace robomill::live {
namespace inputs_test {

// A byte lost on the way: the rest is no vibration, and whoever runs the monitor learns why.
TEST(SourceInput, ReportsMisalignedSamples) {
  const test::Folder folder;
  Random random(1);
  std::vector<float> samples;
  for (int i = 0; i < 10'240; ++i) samples.push_back(static_cast<float>(random.normal()));
  std::string bytes(reinterpret_cast<const char*>(samples.data()), 4 * samples.size());
  bytes.erase(4 * 5120 + 2, 1);
  monitor::MonitorFile file;
  file.columns.channels = {"ax"};
  file.options.sample_rate_hz = 10'240.0;
  std::vector<monitor::MonitorEvent> events;
  SessionOutputs outputs;
  outputs.event = [&](const monitor::MonitorEvent& event, const std::string&) {
    events.push_back(event);
    return true;
  };
  Session session(file, {}, std::move(outputs));
  const std::atomic<bool> stop{false};
  {
    const SourceInput input(io::open_samples(folder.file("lost.raw", bytes), file.columns, io::RawFormat::float32),
                            file, session.queue(), session.notices(), session.metrics(), true);
    session.run(stop);
  }
  std::uint64_t misaligned = 0;
  std::vector<monitor::MonitorEvent> states;
  for (const monitor::MonitorEvent& event : events) {
    if (event.what == "misaligned") misaligned += event.count;
    const bool learns = event.decision.reason == monitor::BlindReason::learning;
    if (event.kind == monitor::MonitorEvent::Kind::state && !learns) states.push_back(event);
  }
  EXPECT_EQ(misaligned, 5119U);
  ASSERT_EQ(states.size(), 1U);
  EXPECT_EQ(states[0].decision.state, monitor::State::blind);
  EXPECT_EQ(states[0].decision.reason, monitor::BlindReason::no_signal);
  EXPECT_NEAR(states[0].time_s, 0.525, 1e-3);
}

}  // namespace inputs_test
}  // namespace robomill::live
