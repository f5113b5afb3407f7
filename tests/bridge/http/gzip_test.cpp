#include <gtest/gtest.h>

#include "bridge/http/http_message.hpp"

namespace fieldcast::web {
namespace {

TEST(Gzip, WhatIsPackedIsUnpacked) {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i * 7919 % 1013);
  EXPECT_LT(packed(text).size(), text.size() / 2);
  EXPECT_EQ(unpacked(packed(text)), text);
  EXPECT_EQ(unpacked(packed("")), "");
}

TEST(Gzip, PiecesJoinToOneStream) {
  GzipPieces pieces;
  std::string all, text;
  for (int i = 0; i < 1000; ++i) {
    const std::string piece = std::to_string(i) + ",";
    text += piece;
    all += pieces.put(piece);
  }
  all += pieces.finish();
  EXPECT_EQ(unpacked(all), text);
}

TEST(Gzip, WhatIsCutIsNotAnEndlessLoop) {
  const std::string all = packed("some text that is long enough");
  for (std::size_t size = 0; size < all.size(); ++size)
    EXPECT_NE(unpacked(std::string_view(all).substr(0, size)), all);
}

}  // namespace
}  // namespace fieldcast::web
