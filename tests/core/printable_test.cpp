#include <gtest/gtest.h>

#include "core/base/message_text.hpp"

namespace fieldcast {
namespace {

TEST(Printable, PlainTextStaysAsItIs) {
  EXPECT_EQ(printable("Halle 3, Öl °C 温度 \\x1B"), "Halle 3, Öl °C 温度 \\x1B");
}

TEST(Printable, ControlCharactersAreSpelled) {
  EXPECT_EQ(printable("a\nb\r\tc"), "a\\nb\\r\\tc");
  EXPECT_EQ(printable("\x1b[2J\x7f"), "\\x1B[2J\\x7F");
  EXPECT_EQ(printable(std::string_view("\0x", 2)), "\\x00x");
  EXPECT_EQ(printable("\xC2\x9B"
                      "31m"),
            "\\u009B31m");  // CSI as one character
}

TEST(Printable, MarksThatTurnOrBreakALineAreSpelled) {
  EXPECT_EQ(printable("\u206A\u206F"), "\\u206A\\u206F");
  EXPECT_EQ(printable("\u202Eabc\u2028\u200B\uFEFF"), "\\u202Eabc\\u2028\\u200B\\uFEFF");
}

TEST(Printable, BytesThatAreNoUtf8AreSpelled) {
  EXPECT_EQ(printable("\xFF\xC0\xAF"), "\\xFF\\xC0\\xAF");  // invalid in UTF-8; an overlong '/'
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xED\\xA0\\x80");  // half of a surrogate pair
  EXPECT_EQ(printable("\xE6\xB8"), "\\xE6\\xB8");           // truncated
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80");  // beyond U+10FFFF
}

TEST(Printable, LongTextIsCutBetweenCharacters) {
  EXPECT_EQ(printable("123456789", 9), "123456789");
  EXPECT_EQ(printable("1234567890", 9), "123456...");
  EXPECT_EQ(printable("ÖÖÖÖÖ", 9), "ÖÖÖ...");
  EXPECT_EQ(printable("12345\n\n\n", 9), "12345...");
  EXPECT_EQ(printable(std::string(1'000'000, '\x1b')).size() <= kMaxPrintable, true);
}

TEST(Printable, NothingItReturnsIsObeyed) {
  for (int first = 0; first < 256; ++first) {
    for (int second = 0; second < 256; ++second) {
      const std::string two{static_cast<char>(first), static_cast<char>(second)};
      const std::string out = printable(two);
      EXPECT_EQ(printable(out), out) << first << ' ' << second;
      for (std::size_t i = 0; i < out.size(); ++i) {
        const auto byte = static_cast<unsigned char>(out[i]);
        ASSERT_TRUE(byte >= 0x20 && byte != 0x7F) << first << ' ' << second;
        ASSERT_FALSE(byte == 0xC2 && static_cast<unsigned char>(out[i + 1]) < 0xA0);
      }
    }
  }
}

}  // namespace
}  // namespace fieldcast
