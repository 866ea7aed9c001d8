#pragma once
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/monitor/files/monitor_events.hpp"

namespace robomill::monitor {

/// A line of events.jsonl of the kinds of MonitorEvent.
[[nodiscard]] const io::Schema<MonitorEvent>& event_table();

/// The words of an enumeration.
template <class List>
[[nodiscard]] std::vector<std::string> words_of(const List& values) {
  std::vector<std::string> out;
  out.reserve(std::size(values));
  for (const auto value : values) out.emplace_back(to_string(value));
  return out;
}

/// A word, or none: where the function gives an empty text.
template <class F>
[[nodiscard]] auto word_key(const std::string& name, F value, std::vector<std::string> words,
                            const std::string& meaning) {
  return io::key(name, std::move(value), meaning).words(std::move(words)).nullable();
}

/// "state", and "reason" why the monitor is blind. @param of  (const T&) -> State and BlindReason
template <class T, class F>
[[nodiscard]] std::vector<io::Row<T>> state_keys(F of) {
  return {io::key(
              "state", [of](const T& object) { return to_string(of(object).first); }, "of the cut")
              .words(words_of(std::vector{State::stable, State::transition, State::chatter, State::blind})),
          word_key(
              "reason",
              [of](const T& object) {
                const auto [state, reason] = of(object);
                return state == State::blind ? to_string(reason) : std::string_view();
              },
              words_of(blind_reasons), "why the state is blind; none: it is not")};
}

/// "hidden": how chatter hides in what repeats with the spindle.
template <class T, class F>
[[nodiscard]] io::Row<T> hidden_key(F of) {
  return word_key(
      "hidden",
      [of](const T& object) {
        return of(object) == SynchronousChatter::none ? std::string_view() : to_string(of(object));
      },
      words_of(std::vector{SynchronousChatter::locked, SynchronousChatter::period_doubling}),
      "how chatter repeats with the spindle; none: it does not");
}

}  // namespace robomill::monitor
