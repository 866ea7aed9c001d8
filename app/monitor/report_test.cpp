#include "report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/live/recorder.hpp"
#include "robomill/live/session.hpp"

namespace robomill::app {
namespace report_test {

live::Hop noise(Random& random) {
  live::Hop hop;
  for (std::size_t i = 0; i < 256; ++i) hop.samples.push_back(static_cast<float>(random.normal()));
  return hop;
}

TEST(MonitorPage, TakesTheUnitOfTheChannels) {
  EXPECT_EQ(unit_of({"ax_m_per_s2", "ay_m_per_s2"}, -1), "m/s²");
  EXPECT_EQ(unit_of({"ax_g", "pulses"}, 1), "g");
  EXPECT_EQ(unit_of({"ax_g", "ay_m_per_s2"}, -1), "");
  EXPECT_EQ(unit_of({"1", "2"}, -1), "");
}

TEST(MonitorPage, ShowsWhatASessionDelivers) {
  monitor::MonitorFile file;
  file.columns.channels = {"ax"};
  file.options.sample_rate_hz = 10'240.0;
  live::Recorder recorder(file.options, file.columns.channels, "");
  live::SessionOutputs outputs;
  outputs.samples = [&](std::span<const float> samples) { recorder.add(samples); };
  outputs.skipped = [&](std::uint64_t frames, monitor::BlindReason reason) { recorder.skip(frames, reason); };
  outputs.decision = [&](monitor::Decision decision, double time_s, double compute_s) {
    decision.time_s = time_s;
    recorder.add(decision, compute_s);
  };
  outputs.event = [&](const monitor::MonitorEvent& event, const std::string&) {
    recorder.add(event);
    return true;
  };
  live::Session session(file, {}, std::move(outputs));
  Random random(1);
  session.process(noise(random));
  live::Hop after_gap = noise(random);
  after_gap.frames_before = 100;
  session.process(std::move(after_gap));
  session.notices().add("lost-blocks", "gone");
  session.emit_notices();
  const live::RecordedRun run = recorder.run();
  EXPECT_EQ(run.decisions, 2U);
  ASSERT_EQ(run.channels[0].wave.low.size(), 612);
  EXPECT_TRUE(std::isnan(run.channels[0].wave.low[300]));
  EXPECT_TRUE(std::isfinite(run.channels[0].wave.low[356]));
  ASSERT_EQ(run.events.size(), 2U);
  EXPECT_NE(run.events[0].find("\"reason\":\"learning\""), std::string::npos) << run.events[0];
  EXPECT_NE(run.events[1].find("\"message\":\"gone\""), std::string::npos) << run.events[1];
  EXPECT_NEAR(run.stays.back().to_s, session.time_s(), 1e-3);
  const std::string page = page::report_json(monitor_page(run, file, "cut.wav"));
  for (const char* part :
       {"cut.wav, 10240 Hz", "comb-cusum, every 25 ms", "\"reason\":\"gap\"", "\"message\":\"gone\""}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_NE(run_summary(run).find("Cannot tell: gap, for 0.03 s."), std::string::npos) << run_summary(run);
  EXPECT_EQ(run_summary(run).find("alias"), std::string::npos) << run_summary(run);
}

TEST(MonitorPage, SaysInTheSummaryWhatALineMayBe) {
  live::RecordedRun run;
  run.alarms = {
      {.chatter_frequency_hz = 661.0, .line_hz = {661.0, 989.0}, .no_speed = monitor::NoSpeed::ambiguous_alias}};
  EXPECT_EQ(run_summary(run),
            "Chatter at 661.0 Hz: signal.anti_alias_filter is not stated, and the line may be 661.0 or 989.0 Hz. No "
            "mode, no speed.\n");
}

}  // namespace report_test
}  // namespace robomill::app
