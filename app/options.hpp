#pragma once
// For main.cpp alone, where CLI11 stands: options that take numbers say what they take in plain words.
#include <CLI/CLI.hpp>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "robomill/io/text.hpp"

namespace robomill::app {

/// @param rule  after "must be", also in the help
template <class Holds>
CLI::Validator must_be(const std::string& rule, Holds holds) {
  return CLI::Validator(
      [rule, holds](std::string& text) {
        return holds(text) ? std::string() : "must be " + rule + ", not \"" + text + "\"";
      },
      {});
}

inline CLI::Validator number() {
  return must_be("a number", [](const std::string& text) {
    const std::optional<double> value = io::parse_number(text);
    return value && std::isfinite(*value);
  });
}

inline CLI::Validator number_above_zero() {
  return must_be("a number > 0", [](const std::string& text) {
    const std::optional<double> value = io::parse_number(text);
    return value && std::isfinite(*value) && *value > 0.0;
  });
}

/// Of an int: without `high` any that it can hold.
inline CLI::Validator whole_number(int low, int high = INT_MAX) {
  const std::string from = std::to_string(low);
  const std::string rule =
      high == INT_MAX ? "a whole number ≥ " + from : "a whole number from " + from + " to " + std::to_string(high);
  return must_be(rule, [low, high](const std::string& text) {
    int value = 0;
    const char* const end = text.data() + text.size();
    const std::from_chars_result read = std::from_chars(text.data(), end, value);
    return read.ec == std::errc() && read.ptr == end && value >= low && value <= high;
  });
}

/// Of a seed.
inline CLI::Validator unsigned_number() {
  return must_be("a whole number ≥ 0", [](const std::string& text) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const std::from_chars_result read = std::from_chars(text.data(), end, value);
    return read.ec == std::errc() && read.ptr == end;
  });
}

}  // namespace robomill::app
