#include "robomill/monitor/explanation.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <string_view>

namespace robomill::monitor {
namespace explanation_test {

Explanation by_ratio(double ratio) {
  Explanation why{.test = Test::ratio, .hops = 6, .enough_hops = 6, .speed_belief = 0.41F};
  why.ask(Quantity::asynchronous_ratio, ratio, 0.2);
  why.ask(Quantity::order_change, 0.001, 0.005, true);
  why.ask(Quantity::entered, 1.25, 0.4);
  return why;
}

TEST(Explanation, NamesEveryTestAndQuantity) {
  std::set<std::string_view> names, meanings;
  for (const QuantityWords& words : quantity_words()) {
    EXPECT_EQ(to_string(words.quantity), words.name);
    EXPECT_EQ(&words_for(words.quantity), &words);
    EXPECT_FALSE(words.meaning.empty());
    names.insert(words.name);
    meanings.insert(words.meaning);
  }
  EXPECT_EQ(names.size(), quantity_words().size());
  EXPECT_EQ(meanings.size(), quantity_words().size());
  EXPECT_EQ(to_string(monitor::Test::runaway), "runaway");
}

TEST(Explanation, OfAnAlarmHasAllConditions) {
  EXPECT_EQ(why_text(by_ratio(0.31), State::chatter),
            "chatter by ratio (6 of 6 hops): energy beside the orders, to theirs: 0.31 (at least 0.2); movement of "
            "the order beside it in 0.3 s, in widths of a line: 0.001 (at most 0.005); time since the tool entered: "
            "1.25 s (at least 0.4 s)");
}

TEST(Explanation, OfNoAlarmHasWhatIsLacking) {
  Explanation why = by_ratio(0.1);
  why.hops = 2;
  EXPECT_EQ(why_text(why, State::stable),
            "no alarm; closest is ratio (2 of 6 hops), which lacks energy beside the orders, to theirs: 0.1 (at least "
            "0.2)");
  why = by_ratio(0.31);
  why.hops = 3;
  EXPECT_EQ(why_text(why, State::transition), "no alarm; closest is ratio (3 of 6 hops), which lacks hops alone");
  EXPECT_EQ(why_text({}, State::stable), "");
}

TEST(Explanation, ShowsWhatRisesInDecibels) {
  EXPECT_EQ(condition_text({Quantity::line_rise, false, 100.0F, 12.6F}),
            "rise of that line in 1.7 s: 20.0 dB (at least 11.0 dB)");
  EXPECT_EQ(condition_text({Quantity::line_growth, false, 0.0F, 1.0F}).find("inf"), std::string::npos);
}

}  // namespace explanation_test
}  // namespace robomill::monitor
