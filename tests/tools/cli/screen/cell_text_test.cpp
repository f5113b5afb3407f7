#include "tools/cli/text/cell_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fieldcast::cli {
namespace {

using testing::ElementsAre;

TEST(CellText, WideCharactersTakeTwoColumns) {
  EXPECT_EQ(columns_of("温度 °C"), 7u);
  EXPECT_EQ(cut("温度", 3), "温");
  EXPECT_EQ(fitted("温度", 3), "温~");
  EXPECT_EQ(fitted("温度", 2), "~ ");
  EXPECT_EQ(fitted("ab", 4, Align::kRight), "  ab");
  EXPECT_EQ(fitted("abcdef", 4), "abc~");
  EXPECT_EQ(fitted("abc", 0), "");
}

TEST(CellText, NothingMovesTheCursorOrTurnsTheDirection) {
  EXPECT_EQ(shown("\x1b[2J\r\n\x07"), "\\x1B[2J\\x0D\\x0A\\x07");
  EXPECT_EQ(shown("a\u202Eb"), "a\\u{202E}b");  // right-to-left override
  EXPECT_EQ(shown("\u05D0"), "\\u{5D0}");       // a Hebrew letter
  EXPECT_EQ(shown("a\u200Bb"), "a\\u{200B}b");  // without a width
  EXPECT_EQ(shown("\xFF"), "\\xFF");
  for (const char* mark : {"\u202A", "\u202B", "\u202C", "\u202D", "\u202E", "\u2066", "\u2067",
                           "\u2068", "\u2069", "\u200E", "\u200F", "\u061C"})
    EXPECT_TRUE(shown(mark).starts_with("\\u{")) << shown(mark);
}

TEST(CellText, MarksAreKeptOnTheirLetterAsLongAsTheyAreFew) {
  const std::string e = "e\u0301";
  EXPECT_EQ(shown(e), e);
  EXPECT_EQ(columns_of(e), 1u);
  EXPECT_EQ(columns_of(shown("e\u0301\u0301\u0301")), 1u + 7u);  // the third as \u{301}
  EXPECT_EQ(shown("\u0301"), "\\u{301}");
}

TEST(CellText, WhatIsShownNeverTakesMoreColumnsThanItIsFittedTo) {
  std::string hostile;
  for (const char* part : {"温", "\u0301", "a", "\x1b", "\u202E", "𝔘", "\xC2", " ", "ش"})
    hostile += part;
  for (std::size_t columns = 0; columns < 60; ++columns) {
    EXPECT_EQ(columns_of(fitted(shown(hostile), columns)), columns);
    if (columns < 2) continue;
    for (const auto& line : wrapped(shown(hostile), columns, 2))
      EXPECT_LE(columns_of(line), columns);
  }
}

TEST(CellText, LinesAreBrokenAtSpaces) {
  EXPECT_THAT(wrapped("the wire is too busy", 9, 2), ElementsAre("the wire", "  is too", "  busy"));
  EXPECT_THAT(wrapped("abcdefghij", 4), ElementsAre("abcd", "efgh", "ij"));
  EXPECT_THAT(wrapped("", 4), ElementsAre(""));
}

}  // namespace
}  // namespace fieldcast::cli
