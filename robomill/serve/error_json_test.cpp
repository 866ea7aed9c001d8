#include "robomill/serve/error_json.hpp"

#include <gtest/gtest.h>

#include <string>

namespace robomill::serve {
namespace error_json_test {

TEST(ErrorJson, SaysNoWayToTheFolder) {
  const auto said = [](const std::string& text) { return without_root(text, "/srv/mill"); };
  EXPECT_EQ(said("/srv/mill/a.toml:3: wrong"), "a.toml:3: wrong");
  // Nor to the folder itself.
  EXPECT_EQ(said("cannot write into /srv/mill"), "cannot write into mill");
  EXPECT_EQ(said("\"/srv/mill\": is full. /srv/mill. /srv/mill/a and /srv/mill/b"), "\"mill\": is full. mill. a and b");
  // Another one's is none of it.
  for (const char* other : {"/srv/mill2", "/srv/mill-old/a", "/srv/mill.bak", "/srv/mill_", "/srv/other"}) {
    EXPECT_EQ(said(other), other);
  }
  EXPECT_EQ(without_root("/a", "/"), "/a");
}

}  // namespace error_json_test
}  // namespace robomill::serve
