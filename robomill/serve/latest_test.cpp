#include "robomill/serve/latest.hpp"

#include <gtest/gtest.h>

#include <array>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace latest_test {

using Kind = Latest::Outcome::Kind;
using Compute = std::function<std::string(Progress&)>;

/// Submits a request; what comes of it.
std::future<Latest::Outcome> submit(Latest& latest, const std::string& channel, std::uint64_t sequence,
                                    Compute compute) {
  const auto outcome = std::make_shared<std::promise<Latest::Outcome>>();
  latest.submit({.client = "client",
                 .channel = channel,
                 .sequence = sequence,
                 .compute = std::move(compute),
                 .done = [outcome](Latest::Outcome ended) { outcome->set_value(std::move(ended)); }});
  return outcome->get_future();
}

Compute says(const std::string& word) {
  return [word](Progress&) { return word; };
}

/// Computes until it is told to stop, or until `release` is set.
struct Endless {
  std::promise<void> begun = {};
  std::shared_ptr<std::atomic<bool>> release = std::make_shared<std::atomic<bool>>(false);
  Compute compute() {
    return [this, let_go = release](Progress& progress) {
      begun.set_value();
      while (!*let_go) {
        progress.check();
        std::this_thread::yield();
      }
      return std::string("released");
    };
  }
};

TEST(Latest, AnswersWhatIsComputed) {
  Latest latest;
  Latest::Outcome outcome = submit(latest, "a", 1, says("one")).get();
  EXPECT_EQ(outcome.kind, Kind::answered);
  EXPECT_EQ(outcome.answer, "one");
  EXPECT_EQ(submit(latest, "a", 2, says("two")).get().answer, "two");
  EXPECT_EQ(latest.channels(), 1U);
}

TEST(Latest, StopsTheOlderOneThatIsComputed) {
  Latest latest;
  Endless first;
  auto older = submit(latest, "a", 1, first.compute());
  first.begun.get_future().wait();
  auto newer = submit(latest, "a", 2, says("newer"));
  EXPECT_EQ(older.get().kind, Kind::superseded);
  EXPECT_EQ(newer.get().answer, "newer");
}

TEST(Latest, LeavesOtherChannelsAlone) {
  Latest latest;
  Endless first;
  auto one = submit(latest, "a", 1, first.compute());
  first.begun.get_future().wait();
  auto other = submit(latest, "b", 2, says("other"));
  EXPECT_EQ(other.wait_for(std::chrono::seconds(0)), std::future_status::timeout);  // it waits for its turn
  *first.release = true;
  EXPECT_EQ(one.get().answer, "released");
  EXPECT_EQ(other.get().answer, "other");
}

TEST(Latest, ComputesOnlyTheNewestOfThoseThatWait) {
  Latest latest;
  Endless first;
  auto running = submit(latest, "a", 1, first.compute());
  first.begun.get_future().wait();
  std::vector<std::future<Latest::Outcome>> waiting;
  for (std::uint64_t i = 1; i <= 3; ++i) waiting.push_back(submit(latest, "b", i, says(std::to_string(i))));
  EXPECT_EQ(waiting[0].get().kind, Kind::superseded);
  EXPECT_EQ(waiting[1].get().kind, Kind::superseded);
  // One that comes late, or twice, is no newer one.
  EXPECT_EQ(submit(latest, "b", 2, says("late")).get().kind, Kind::superseded);
  EXPECT_EQ(submit(latest, "b", 3, says("twice")).get().kind, Kind::superseded);
  *first.release = true;
  EXPECT_EQ(running.get().answer, "released");
  EXPECT_EQ(waiting[2].get().answer, "3");
}

TEST(Latest, GivesTheErrorOfAComputation) {
  Latest latest;
  const Latest::Outcome outcome =
      submit(latest, "a", 1, [](Progress&) -> std::string { throw InvalidInput("teeth", "must be >= 1"); }).get();
  EXPECT_EQ(outcome.kind, Kind::failed);
  EXPECT_NE(test::rejection([&] { std::rethrow_exception(outcome.error); }).find("teeth"), std::string::npos);
  EXPECT_EQ(submit(latest, "a", 2, says("next")).get().answer, "next");
}

TEST(Latest, TakesNoMoreChannelsThanItMay) {
  Latest latest(2);
  Endless first;
  auto running = submit(latest, "a", 1, first.compute());
  first.begun.get_future().wait();
  auto waiting = submit(latest, "b", 1, says("b"));
  EXPECT_EQ(submit(latest, "c", 1, says("c")).get().kind, Kind::full);
  *first.release = true;
  EXPECT_EQ(running.get().kind, Kind::answered);
  EXPECT_EQ(waiting.get().kind, Kind::answered);
}

TEST(Latest, ForgetsIdleChannels) {
  Latest latest(4);
  int answered = 0;
  for (int i = 0; i < 1000; ++i) {
    answered += submit(latest, std::to_string(i), 0, says("x")).get().kind == Kind::answered ? 1 : 0;
    EXPECT_LE(latest.channels(), 4U);
  }
  EXPECT_EQ(answered, 1000);
}

TEST(Latest, EndsWhatIsLeftWhenItGoes) {
  Endless first;
  std::future<Latest::Outcome> running, waiting;
  {
    Latest latest;
    running = submit(latest, "a", 1, first.compute());
    first.begun.get_future().wait();
    waiting = submit(latest, "b", 1, says("b"));
  }
  EXPECT_EQ(running.get().kind, Kind::superseded);
  EXPECT_EQ(waiting.get().kind, Kind::superseded);
}

// Four threads that drag at once: every request ends once, and the newest of each channel is answered.
TEST(Latest, AnswersTheNewestOfEachChannelUnderLoad) {
  constexpr int channels = 6, threads = 4, requests = 400;
  std::array<std::atomic<std::uint64_t>, channels> newest{};
  std::array<std::atomic<std::uint64_t>, channels> answered{};
  std::atomic<int> ended{0}, wrong{0};
  {
    Latest latest(channels);
    std::vector<std::jthread> clients;
    for (int t = 0; t < threads; ++t) {
      clients.emplace_back([&, t] {
        Random random(17, static_cast<std::uint64_t>(t));
        for (int i = 0; i < requests; ++i) {
          const std::size_t c = random.index(channels);
          const std::uint64_t sequence = ++newest[c];
          const int steps = static_cast<int>(random.index(200));
          latest.submit({.client = std::to_string(c / 2),
                         .channel = std::to_string(c % 2),
                         .sequence = sequence,
                         .compute =
                             [steps, sequence](Progress& progress) {
                               for (int k = 0; k < steps; ++k) progress.check();
                               return std::to_string(sequence);
                             },
                         .done =
                             [&, c, sequence](const Latest::Outcome& outcome) {
                               ++ended;
                               if (outcome.kind == Kind::failed || outcome.kind == Kind::full) ++wrong;
                               if (outcome.kind != Kind::answered) return;
                               if (outcome.answer != std::to_string(sequence)) ++wrong;
                               if (answered[c].exchange(sequence) >= sequence) ++wrong;  // in their order
                             }});
        }
      });
    }
    clients.clear();  // joins
    while (ended < threads * requests) std::this_thread::yield();
    EXPECT_EQ(latest.channels(), static_cast<std::size_t>(channels));
  }
  EXPECT_EQ(ended, threads * requests);
  EXPECT_EQ(wrong, 0);
  for (std::size_t c = 0; c < channels; ++c) EXPECT_EQ(answered[c], newest[c]) << c;
}

}  // namespace latest_test
}  // namespace robomill::serve
