#include "robomill/base/digest.hpp"

#include <gtest/gtest.h>

#include <string>

namespace robomill {
namespace digest_test {

// FIPS 180-2, appendix B.1 to B.3; of the empty text: NIST's CAVP, SHA256ShortMsg.rsp, Len = 0.
TEST(Digest, IsSha256) {
  EXPECT_EQ(digest_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(digest_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(digest_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(digest_of(std::string(1'000'000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Digest, TellsWhereATextEndsAndNumbersByTheirBits) {
  const auto of_texts = [](std::string_view one, std::string_view other) {
    Digest digest;
    digest.text(one);
    digest.text(other);
    return digest.hex();
  };
  EXPECT_NE(of_texts("ab", "c"), of_texts("a", "bc"));
  const auto of_number = [](double value) {
    Digest digest;
    digest.number(value);
    return digest.hex();
  };
  EXPECT_NE(of_number(0.1), of_number(0.1 + 1e-17 * 8.0));
  EXPECT_NE(of_number(0.0), of_number(-0.0));
}

}  // namespace digest_test
}  // namespace robomill
