#pragma once
#include <initializer_list>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/jobs/verbs.hpp"

namespace robomill::jobs {

[[nodiscard]] inline VerbOption flag_option(std::string_view name, std::string_view meaning) {
  return {.name = name, .meaning = meaning};
}
[[nodiscard]] inline VerbOption plain_option(std::string_view name, std::string_view meaning,
                                             Takes takes = Takes::text) {
  return {.name = name, .meaning = meaning, .takes = takes};
}
[[nodiscard]] inline VerbOption word_option(std::string_view name, std::string_view meaning,
                                            std::vector<std::string_view> words, bool required = false) {
  return {.name = name, .meaning = meaning, .takes = Takes::word, .required = required, .words = std::move(words)};
}
[[nodiscard]] inline VerbOption whole_option(std::string_view name, std::string_view meaning, double low,
                                             double high = std::numeric_limits<double>::infinity()) {
  return {.name = name, .meaning = meaning, .takes = Takes::whole, .at_least = low, .at_most = high};
}
/// A number > 0.
[[nodiscard]] inline VerbOption positive_option(std::string_view name, std::string_view meaning,
                                                std::string_view unit) {
  return {.name = name, .meaning = meaning, .takes = Takes::number, .unit = unit, .above = 0};
}
/// @param kinds  that the page proposes
[[nodiscard]] inline VerbOption file_option(std::string_view name, std::string_view meaning,
                                            std::initializer_list<std::string_view> kinds, bool required = false) {
  return {.name = name, .meaning = meaning, .takes = Takes::file, .required = required, .kinds = kinds};
}

}  // namespace robomill::jobs
