#include "core/base/message_text.hpp"

#include <gtest/gtest.h>

#include "core/base/csv_field.hpp"

namespace fieldcast {
namespace {

// RFC 3629, 4: the first and the last sequence of each row, and their neighbours.
TEST(Utf8, HasTheLengthsOfTheStandard) {
  for (const std::string_view one : {"\x01", "\x7F"}) EXPECT_EQ(utf8_length(one), 1u);
  for (const std::string_view two : {"\xC2\x80", "\xDF\xBF"}) EXPECT_EQ(utf8_length(two), 2u);
  for (const std::string_view three :
       {"\xE0\xA0\x80", "\xE1\x80\x80", "\xED\x9F\xBF", "\xEE\x80\x80", "\xEF\xBF\xBF"})
    EXPECT_EQ(utf8_length(three), 3u);
  for (const std::string_view four : {"\xF0\x90\x80\x80", "\xF1\x80\x80\x80", "\xF4\x8F\xBF\xBF"})
    EXPECT_EQ(utf8_length(four), 4u);
  for (const std::string_view invalid :
       {"\x80", "\xBF", "\xC0\x80", "\xC1\xBF", "\xC2", "\xC2\x7F", "\xC2\xC0", "\xE0\x9F\xBF",
        "\xE1\x80", "\xE1\x80\xC0", "\xED\xA0\x80", "\xF0\x8F\xBF\xBF", "\xF1\x80\x80",
        "\xF1\x80\x7F\x80", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"}) {
    EXPECT_EQ(utf8_length(invalid), 0u) << escaped(invalid);
    EXPECT_FALSE(is_utf8(std::string("a").append(invalid)));
  }
  EXPECT_TRUE(is_utf8("a\xC2\xB0\xE2\x82\xAC\xF0\x9F\x98\x80z"));
  EXPECT_TRUE(is_utf8(""));
}

TEST(Utf8, CodePointsAreThoseOfUnicode) {
  EXPECT_EQ(code_point("A"), U'A');
  EXPECT_EQ(code_point("\xC2\xB0"), U'\u00B0');
  EXPECT_EQ(code_point("\xE2\x82\xAC"), U'\u20AC');
  EXPECT_EQ(code_point("\xF0\x9F\x98\x80"), U'\U0001F600');
}

TEST(Escaped, ReplacesControlsAndInvalidBytesOnly) {
  EXPECT_EQ(escaped("a b~\xC2\xA0"), "a b~\xC2\xA0");
  EXPECT_EQ(escaped("\x01\x1F\x7F"), "\\x01\\x1F\\x7F");
  EXPECT_EQ(escaped("\xC2\x80\xC2\x9F"), "\\xC2\\x80\\xC2\\x9F");
  EXPECT_EQ(escaped("K\xFChl\xE2\x82"), "K\\xFChl\\xE2\\x82");
}

TEST(Printable, ExcludesEachRangeUpToItsEnds) {
  for (const std::string_view character :
       {" ", "~", "\u00A0", "\u061B", "\u061D", "\u200A", "\u2010", "\u2027", "\u202F", "\u205F",
        "\u2070", "\uFEFE", "\uFF00", "\U0001F600"})
    EXPECT_EQ(printable(character), character);
  EXPECT_EQ(printable("\x1F\x7F\n\r\t"), "\\x1F\\x7F\\n\\r\\t");
  EXPECT_EQ(printable("\u0080\u009F"), "\\u0080\\u009F");
  EXPECT_EQ(printable("\u061C\uFEFF"), "\\u061C\\uFEFF");
  EXPECT_EQ(printable("\u200B\u200F\u2028\u202E\u2060\u206F"),
            "\\u200B\\u200F\\u2028\\u202E\\u2060\\u206F");
  EXPECT_EQ(printable("\xFF"
                      "a"),
            "\\xFFa");
}

TEST(Printable, CutsBetweenTwoCharacters) {
  EXPECT_EQ(printable("12345678", 8), "12345678");
  EXPECT_EQ(printable("123456789", 8), "12345...");
  EXPECT_EQ(printable("1234\u20AC789", 8), "1234...") << "half a character does not fit";
  EXPECT_EQ(printable("123456\u20AC", 8), "12345...");
  EXPECT_EQ(printable("12\u20AC6789", 8), "12\u20AC...");
  EXPECT_EQ(printable(std::string(kMaxPrintable + 1, 'a')).size(), kMaxPrintable);
}

TEST(Counted, OneIsSingular) {
  EXPECT_EQ(counted(0, "bus", "buses"), "0 buses");
  EXPECT_EQ(counted(1, "bus", "buses"), "1 bus");
  EXPECT_EQ(counted(2, "bus", "buses"), "2 buses");
}

// The limits of a hint: one edit up to five characters, two up to eight, and 64 characters.
TEST(NearMiss, AcceptsAThirdOfTheWord) {
  const auto hint = [](std::string_view word, std::string_view candidate) {
    return !near_miss(word, std::vector{std::string(candidate)}).empty();
  };
  EXPECT_TRUE(hint("a", "b"));
  EXPECT_FALSE(hint("ab", "cd"));
  EXPECT_TRUE(hint("abcde", "abcdx"));
  EXPECT_FALSE(hint("abcde", "abcxy"));
  EXPECT_TRUE(hint("abcdef", "abcdxy"));
  EXPECT_FALSE(hint("abcdef", "abcxyz"));
  EXPECT_TRUE(hint("ab", "ba")) << "neighbours are swapped";
  EXPECT_TRUE(hint(std::string(64, 'a'), std::string(64, 'a')));
  EXPECT_FALSE(hint(std::string(64, 'a'), std::string(65, 'a')));
  EXPECT_FALSE(hint(std::string(65, 'a'), std::string(64, 'a')));
  const auto best = [](std::string_view word, std::vector<std::string> candidates) {
    return near_miss(word, candidates);
  };
  EXPECT_EQ(best("abcx", {"abcy", "abcz"}), "abcy") << "the first of two";
  EXPECT_EQ(best("A", {"b", "a"}), "a");
  EXPECT_EQ(best("Z", {"y", "z"}), "z");
  EXPECT_EQ(best("@", {"x", "`"}), "x") << "the neighbours of the letters have no case";
  EXPECT_EQ(best("[", {"x", "{"}), "x");
}

TEST(CsvField, QuotesAndDisarmsFormulas) {
  EXPECT_EQ(csv_field(""), "");
  EXPECT_EQ(csv_field("25.5"), "25.5");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("a\"b"), "\"a\"\"b\"");
  EXPECT_EQ(csv_field("a\nb"), "a\\nb");
  for (const char start : std::string_view("=+-@"))
    EXPECT_EQ(csv_field(std::string(1, start) + "1"), "'" + std::string(1, start) + "1");
  EXPECT_EQ(csv_field("\t=1"), "'\\t=1");
}

}  // namespace
}  // namespace fieldcast
