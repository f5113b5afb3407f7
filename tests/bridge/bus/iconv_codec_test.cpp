#include "bridge/bus/iconv_codec.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

TEST(IconvCodec, TranscodesGbkAndShiftJisBothWays) {
  IconvCodec codec;
  EXPECT_EQ(codec.to_utf8(Charset::kGbk, "\xCE\xC2\xB6\xC8 25"), "温度 25");
  EXPECT_EQ(codec.from_utf8(Charset::kGbk, "温度 25"), "\xCE\xC2\xB6\xC8 25");
  EXPECT_EQ(codec.to_utf8(Charset::kShiftJis, "\x89\xB7\x93\x78 \xB1\\"), "温度 ｱ\\");
  EXPECT_EQ(codec.from_utf8(Charset::kShiftJis, "温度 ｱ\\"), "\x89\xB7\x93\x78 \xB1\\");
}

TEST(IconvCodec, ShowsWhatIsNotACharacterAndGoesOnBehindIt) {
  IconvCodec codec;
  EXPECT_EQ(codec.to_utf8(Charset::kGbk, "a\xCE\xC2\xB6"), "a温\\xB6") << "cut inside a character";
  EXPECT_EQ(codec.to_utf8(Charset::kGbk, "\xFFx\xCE\xC2"), "\\xFFx温");
  EXPECT_EQ(codec.to_utf8(Charset::kShiftJis, "\x1B[2J\n"), "\\x1B[2J\\x0A");
}

TEST(IconvCodec, HasNothingForWhatTheSetLacks) {
  IconvCodec codec;
  EXPECT_EQ(codec.from_utf8(Charset::kGbk, "25 😀"), std::nullopt);
  EXPECT_EQ(codec.from_utf8(Charset::kShiftJis, "ä"), std::nullopt);
  EXPECT_EQ(codec.from_utf8(Charset::kGbk, "\xE4"), std::nullopt) << "no UTF-8";
  EXPECT_EQ(codec.from_utf8(Charset::kGbk, "温\xE6\xB8"), std::nullopt);
  EXPECT_EQ(codec.from_utf8(Charset::kGbk, "温"), "\xCE\xC2") << "nothing is left of those before";
}

TEST(IconvCodec, LeavesTheOthersToCore) {
  IconvCodec codec;
  EXPECT_EQ(codec.to_utf8(Charset::kLatin1, "\xE4"), "ä");
  EXPECT_EQ(codec.to_utf8(Charset::kUtf8, "\xE4"), "\\xE4");
}

}  // namespace
}  // namespace fieldcast
