#pragma once
// What tests do to the text of a good file.
#include <gtest/gtest.h>

#include <string>

#include "robomill/base/random.hpp"

namespace robomill::test_support {

/// One part put for another; fails the test where that part is not there.
inline std::string replaced(std::string text, const std::string& part, const std::string& other) {
  EXPECT_NE(text.find(part), std::string::npos) << part;
  return text.replace(text.find(part), part.size(), other);
}

/// Slips of a hand: by turns one letter becomes another of the text's, or up to ten are gone.
inline std::string damaged(std::string text, int turn, Random& random) {
  const std::size_t at = random.index(text.size());
  if (turn % 2 == 0) {
    text[at] = text[random.index(text.size())];
  } else {
    text.erase(at, 1 + random.index(10));
  }
  return text;
}

/// By turns cut off, or one byte changed to any.
inline std::string mutated(std::string text, int turn, Random& random) {
  if (turn % 2 == 0) {
    text.resize(1 + random.index(text.size() - 1));
  } else {
    text[random.index(text.size())] = static_cast<char>(random.index(256));
  }
  return text;
}

}  // namespace robomill::test_support
