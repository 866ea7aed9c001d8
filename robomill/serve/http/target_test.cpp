#include "robomill/serve/http/target.hpp"

#include <gtest/gtest.h>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace target_test {

using Query = std::map<std::string, std::string, std::less<>>;

TEST(Target, PathAndQuery) {
  std::string path;
  Query query;
  ASSERT_TRUE(split_target("/api/file?path=a%2Fb+c%2b&x=&y", path, query));
  EXPECT_EQ(path, "/api/file");
  EXPECT_EQ(query, (Query{{"path", "a/b c+"}, {"x", ""}, {"y", ""}}));
  ASSERT_TRUE(split_target("/a+b%20c#d?e=f", path, query));
  EXPECT_EQ(path, "/a+b c");
  EXPECT_TRUE(query.empty());
}

TEST(Target, RejectsWhatIsMalformed) {
  std::string path;
  Query query;
  for (const char* target : {"", "x", "http://evil.example/", "*", "/%", "/%4", "/%zz", "/%00", "/a%0d%0aSet-Cookie",
                             "/?a=1&a=2", "/?%", "/?a=%0a"}) {
    EXPECT_FALSE(split_target(target, path, query)) << target;
  }
}

TEST(Target, NumberAtItsEnd) {
  EXPECT_EQ(number_of("/api/jobs/12", "/api/jobs/"), 12);
  EXPECT_EQ(number_of("/api/jobs/2147483647", "/api/jobs/"), 2147483647);
  for (const char* path : {"", "/api/jobs", "/api/jobs/", "/api/jobs/0", "/api/jobs/-1", "/api/jobs/+1", "/api/jobs/01",
                           "/api/jobs/1x", "/api/jobs/ 1", "/api/jobs/1 ", "/api/jobs/1/", "/api/jobs/x/1",
                           "/api/jobs//1", "/api/jobs/1/report", "/api/job/1", "/api/jobs/2147483648"}) {
    EXPECT_EQ(number_of(path, "/api/jobs/"), 0) << path;
  }
}

/// Any bytes are taken or rejected, and what is taken holds no control character.
TEST(Target, SurvivesAnything) {
  Random random(3);
  std::string path;
  Query query;
  for (int i = 0; i < test::seeds(200000); ++i) {
    std::string target = "/";
    for (std::uint64_t n = random.index(24); n > 0; --n) {
      target += random.index(3) == 0 ? "%&=?+/#"[random.index(7)] : static_cast<char>(random.index(256));
    }
    if (!split_target(target, path, query)) continue;
    for (const char letter : path) ASSERT_GE(static_cast<unsigned char>(letter), 0x20);
  }
}

}  // namespace target_test
}  // namespace robomill::serve
