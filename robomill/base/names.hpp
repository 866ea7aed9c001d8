#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

// Method: robomill/base/README.md, "Method"

namespace robomill {

/// A value with its word in files and on the command line. Of an enum that is read and written one table stands beside
/// it: `inline constexpr Name<Beam> beam_names[] = {{"timoshenko", Beam::timoshenko}, …}`.
template <class Value>
using Name = std::pair<std::string_view, Value>;

/// The word for a value; empty where the table has none.
template <class Value, std::size_t n>
[[nodiscard]] constexpr std::string_view name_in(const Name<Value> (&names)[n], Value value) noexcept {
  for (const auto& [name, known] : names) {
    if (known == value) return name;
  }
  return {};
}

/// The value that a word names, where there is one.
template <class Value, std::size_t n>
[[nodiscard]] constexpr std::optional<Value> value_in(const Name<Value> (&names)[n], std::string_view word) noexcept {
  for (const auto& [name, value] : names) {
    if (name == word) return value;
  }
  return std::nullopt;
}

/// A rule for messages: `must be one of "timoshenko", "euler-bernoulli"`.
template <class Value, std::size_t n>
[[nodiscard]] std::string one_of(const Name<Value> (&names)[n]) {
  std::string rule = "must be one of ";
  for (const auto& [name, value] : names) rule.append(&name == &names[0].first ? "\"" : ", \"").append(name) += '"';
  return rule;
}

}  // namespace robomill
