#include "robomill/serve/http/places.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>

namespace robomill::serve {
namespace places_test {

using Place = Places::Place;

/// How many places an address is given.
std::size_t given(Places& places, const std::string& address, Place place) {
  std::size_t count = 0;
  while (count < 1000 && places.take(address) == place) ++count;
  return count;
}

TEST(Places, OneAddressDoesNotHaveAll) {
  Places places(128);
  EXPECT_EQ(given(places, "a", Place::usual), 96U);
  // Some of the last ones are left to it, of which the first was given by the last of these calls.
  EXPECT_EQ(given(places, "a", Place::reserved), 3U);
  EXPECT_EQ(places.take("a"), Place::none);
  EXPECT_EQ(given(places, "b", Place::usual), 16U);  // 112 are taken
}

TEST(Places, TheLastOnesAreReserved) {
  Places places(128);
  for (const char* address : {"a", "b"}) {
    for (int i = 0; i < 56; ++i) EXPECT_EQ(places.take(address), Place::usual) << address << i;
  }
  for (const char* address : {"b", "c", "d", "e"}) EXPECT_EQ(given(places, address, Place::reserved), 4U) << address;
  EXPECT_EQ(places.take("f"), Place::none);
  places.leave("c", Place::reserved);
  EXPECT_EQ(places.take("f"), Place::reserved);
  places.leave("a", Place::usual);
  EXPECT_EQ(places.take("f"), Place::usual);
}

TEST(Places, OfAFewConnectionsNoneIsReserved) {
  Places places(1);
  EXPECT_EQ(places.take("a"), Place::usual);
  EXPECT_EQ(places.take("b"), Place::none);
  places.leave("a", Place::usual);
  places.leave("a", Place::usual);  // not held: nothing is freed twice
  EXPECT_EQ(places.take("b"), Place::usual);
  EXPECT_EQ(places.take("a"), Place::none);
  EXPECT_EQ(places.take("b"), Place::none);
}

}  // namespace places_test
}  // namespace robomill::serve
