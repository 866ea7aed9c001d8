#include "robomill/serve/monitor/history.hpp"

#include <gtest/gtest.h>

#include <cstddef>

namespace robomill::serve {
namespace monitor_history_test {

TEST(MonitorHistory, SaysWhyAnAlarmBegan) {
  MonitorHistory history({"ax"}, false);
  monitor::Decision decision;
  decision.state = monitor::State::chatter;
  decision.why = {.test = monitor::Test::growth, .hops = 3, .enough_hops = 3};
  history.add(decision, 1.0, 1.0);
  decision.why = {.test = monitor::Test::ratio, .hops = 6, .enough_hops = 6};
  history.add(decision, 1.025, 1.025);
  EXPECT_EQ(history.rows()[0]["why"]["test"], "growth");
  decision.state = monitor::State::blind;
  history.add(decision, 2.0, 2.0);
  EXPECT_TRUE(history.rows()[0]["why"].is_null());
}

TEST(MonitorHistory, KeepsTheLastRows) {
  MonitorHistory history({"ax"}, false);
  monitor::MonitorEvent lost;
  lost.kind = monitor::MonitorEvent::Kind::stream;
  lost.what = "lost-blocks";
  lost.count = 2;
  for (int i = 0; i < 3; ++i) history.add(lost, "gone", 0.0);
  for (int i = 0; i < 3000; ++i) {
    monitor::Decision decision;
    decision.state = i % 3 == 1 ? monitor::State::chatter : monitor::State::stable;
    decision.score = i;
    decision.chatter_frequency_hz = i % 3 == 1 ? 500.0 + i : 0.0;
    history.add(decision, i, 0.5 * i);
    if (i == 1) {
      EXPECT_EQ(history.rows()[1]["count"], 6);  // of one kind: one row
    }
  }
  const io::Json rows = history.rows();
  ASSERT_EQ(rows.size(), MonitorHistory::most_rows);
  EXPECT_EQ(rows[0]["number"], 1001);
  EXPECT_EQ(rows[0]["from_s"], 2998.0);
  EXPECT_EQ(rows[0]["to_s"], 2999.0);
  EXPECT_EQ(rows[0]["clock_s"], 1499.0);
  EXPECT_EQ(rows[0]["channel"], "ax");
  // What is more than a message holds comes with the next ones.
  std::size_t next = 1001;
  for (std::size_t taken = 0; taken < MonitorHistory::most_rows; taken += MonitorHistory::most_changed) {
    const io::Json changed = history.take_changed();
    ASSERT_EQ(changed.size(), MonitorHistory::most_changed);
    for (const io::Json& row : changed) EXPECT_EQ(row["number"], next--);
  }
  EXPECT_TRUE(history.take_changed().empty());
}

}  // namespace monitor_history_test
}  // namespace robomill::serve
