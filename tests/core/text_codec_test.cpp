#include "core/codec/text_codec.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/base/message_text.hpp"
#include "core/codec/value_codec.hpp"

namespace fieldcast {
namespace {

TEST(Escaped, KeepsWhatIsPrintableUtf8) {
  for (const auto* text : {"", "plain", "22 °C", "温度", "😀", "C:\\temp", "a\"b,c"}) {
    EXPECT_EQ(escaped(text), text);
    EXPECT_TRUE(is_utf8(text));
  }
}

TEST(Escaped, ShowsEveryByteThatIsNotACharacter) {
  EXPECT_EQ(escaped("K\xFChl"), "K\\xFChl");
  EXPECT_EQ(escaped("\xE6\xB8"), "\\xE6\\xB8") << "cut inside a character";
  EXPECT_EQ(escaped("\xC0\x80"), "\\xC0\\x80") << "overlong";
  EXPECT_EQ(escaped("\xE0\x80\x80"), "\\xE0\\x80\\x80");
  EXPECT_EQ(escaped("\xED\xA0\x80"), "\\xED\\xA0\\x80") << "a surrogate";
  EXPECT_EQ(escaped("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80") << "above U+10FFFF";
  EXPECT_EQ(escaped("\x80"), "\\x80");
}

TEST(Escaped, ShowsControlCharacters) {
  EXPECT_EQ(escaped("a\nb\r\t\x7F"), "a\\x0Ab\\x0D\\x09\\x7F");
  EXPECT_EQ(escaped("\x1B[2J"), "\\x1B[2J");
  EXPECT_EQ(escaped("\xC2\x9B"
                    "31m"),
            "\\xC2\\x9B31m")
      << "a control that some terminals obey";
  EXPECT_EQ(escaped(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST(Escaped, IsPrintableUtf8WhateverComes) {
  std::mt19937 random{3};
  for (int round = 0; round < 20'000; ++round) {
    std::string bytes(random() % 12, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    const std::string text = escaped(bytes);
    ASSERT_TRUE(is_utf8(text));
    ASSERT_EQ(escaped(text), text) << "nothing is left to escape";
  }
}

TEST(PlainTextCodec, KnowsUtf8AndLatinOneBothWays) {
  TextCodec& codec = plain_text_codec();
  EXPECT_EQ(codec.to_utf8(Charset::kUtf8, "\xC3\xA4"), "ä");
  EXPECT_EQ(codec.to_utf8(Charset::kUtf8, "\xE4"), "\\xE4");
  EXPECT_EQ(codec.to_utf8(Charset::kLatin1, "\xE4 \xB0\x85"), "ä °\\x85");
  EXPECT_EQ(codec.from_utf8(Charset::kLatin1, "ä °ÿ"), "\xE4 \xB0\xFF");
  EXPECT_EQ(codec.from_utf8(Charset::kUtf8, "温"), "温");
  EXPECT_EQ(codec.from_utf8(Charset::kLatin1, "5 €"), std::nullopt);
  EXPECT_EQ(codec.from_utf8(Charset::kLatin1, "\xE4"), std::nullopt) << "no UTF-8";
  EXPECT_EQ(codec.from_utf8(Charset::kUtf8, "\xE4"), std::nullopt);
  EXPECT_EQ(codec.from_utf8(Charset::kLatin1, "\u0100"), std::nullopt) << "beyond U+00FF";
}

TEST(PlainTextCodec, OfSetsWithTablesKnowsAsciiAlone) {
  TextCodec& codec = plain_text_codec();
  EXPECT_EQ(codec.to_utf8(Charset::kGbk, "T \xCE\xC2"), "T \\xCE\\xC2");
  EXPECT_EQ(codec.from_utf8(Charset::kShiftJis, "T"), "T");
  EXPECT_EQ(codec.from_utf8(Charset::kGbk, "温"), std::nullopt);
}

TEST(PlainTextCodec, EachSetHasTheNameOfItsKey) {
  const std::pair<Charset, std::string_view> kRows[] = {{Charset::kUtf8, "utf-8"},
                                                        {Charset::kLatin1, "latin-1"},
                                                        {Charset::kGbk, "gbk"},
                                                        {Charset::kShiftJis, "shift-jis"}};
  for (const auto& [charset, name] : kRows) EXPECT_EQ(to_text(charset), name);
  EXPECT_EQ(to_text(static_cast<Charset>(99)), "?");
}

TEST(StringChannel, IsTranscodedBothWaysAndItsBytesAreCounted) {
  const Encoding latin{.type = ValueType::kString, .string_bytes = 4, .charset = Charset::kLatin1};
  const Bytes items{0x4B, 0xFC, 0x68, 0x6C};
  EXPECT_EQ(decode_value(latin, 16, items), Value{std::string("Kühl")});
  EXPECT_EQ(encode_value(latin, 16, Value{std::string("Kühl")}), items) << "5 bytes of UTF-8";
  EXPECT_EQ(encode_value(latin, 16, Value{std::string("€")}), tl::unexpected(Cause::kRange));
  const Encoding plain{.type = ValueType::kString, .string_bytes = 4};
  EXPECT_EQ(decode_value(plain, 16, items), Value{std::string("K\\xFChl")});
  EXPECT_EQ(encode_value(plain, 16, Value{std::string("\xFC")}), tl::unexpected(Cause::kRange));
}

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
