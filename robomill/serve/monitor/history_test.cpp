#include "robomill/serve/monitor/history.hpp"

#include <gtest/gtest.h>

#include <cstddef>

namespace robomill::serve {
namespace monitor_history_test {

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
