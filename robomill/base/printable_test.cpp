#include "robomill/base/printable.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"

namespace robomill {
namespace printable_test {

TEST(Printable, LeavesTextAlone) {
  for (const char* text : {"", "tip.csv:3", "ÅΩµ — “ä” 刀具 😀", "C:\\new\\x"}) EXPECT_EQ(printable(text), text);
}

TEST(Printable, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(printable("\x1b[2J"), "\\x1b[2J");
  EXPECT_EQ(printable("a\r\n\tb\x7f"), "a\\x0d\\n\\tb\\x7f");
  EXPECT_EQ(printable_lines("a\nb\n  c\n\n  d\r"), "a\\nb\n  c\\n\n  d\\x0d");
  EXPECT_EQ(printable_lines(""), "");
  EXPECT_EQ(printable(std::string("\0", 1)), "\\x00");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\xc2\\x9b2J");  // CSI in one character
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "txt.exe"),
            "\\xe2\\x80\\xaetxt.exe");                      // right to left from here
  EXPECT_EQ(printable("\xe2\x80\xa8"), "\\xe2\\x80\\xa8");  // a line's end
}

TEST(Printable, ShowsBytesThatAreNoText) {
  EXPECT_EQ(printable("m/s\xb2"), "m/s\\xb2");              // Latin-1
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");           // cut off
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");           // overlong
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // half a pair
  EXPECT_EQ(printable("\xf5\x80\x80\x80"), "\\xf5\\x80\\x80\\x80");
}

// Whatever comes in, what comes out is text without controls, and stays as it is.
TEST(Printable, HoldsForAnyBytes) {
  Random random(11);
  for (int i = 0; i < 2000; ++i) {
    std::string text(1 + random.index(40), '\0');
    for (char& byte : text) byte = static_cast<char>(random.index(256));
    const std::string shown = printable(text);
    EXPECT_EQ(printable(shown), shown);
    for (const char byte : shown) {
      EXPECT_GE(static_cast<unsigned char>(byte), 0x20);
      EXPECT_NE(byte, 0x7f);
    }
  }
}

TEST(Printable, IsWhatAnErrorSays) {
  const InvalidInput error(InvalidInput::Parts{
      .where = "a\x1b.csv:1", .field = "x\n", .value = "\"\xff\"", .rule = "must be a number", .hint = "Not \a"});
  EXPECT_STREQ(error.what(), "a\\x1b.csv:1: x\\n = \"\\xff\"; must be a number. Not \\x07");
  EXPECT_EQ(error.parts().value, "\"\xff\"") << "what came in is kept";
}

}  // namespace printable_test
}  // namespace robomill
