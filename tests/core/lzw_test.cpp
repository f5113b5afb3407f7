#include "core/codec/lzw.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/core/lzw_reference.hpp"
#include "tests/support/vectors.hpp"

namespace fieldcast {
namespace {

using test::packed;
using test::reference_codes;
using test::reference_decode;

Bytes encoded(ByteView original) {
  static LzwEncoder encoder;  // the dictionary is used repeatedly, as on a line
  Bytes out(3 * original.size() + 16);
  const auto size = encoder.encode(original, out);
  EXPECT_TRUE(size.has_value());
  out.resize(size.value_or(0));
  return out;
}

tl::expected<Bytes, LzwFault> decoded(ByteView codes, std::size_t length) {
  Bytes out;
  return lzw_decode(codes, length, out).map([&] { return out; });
}

// From a constant to white noise: values repeat with probability `keep`/16.
Bytes data(std::mt19937& random, std::size_t length, unsigned symbols, unsigned keep) {
  Bytes bytes;
  std::uint8_t last = 0;
  for (std::size_t i = 0; i < length; ++i) {
    if (random() % 16 >= keep) last = static_cast<std::uint8_t>(random() % symbols);
    bytes.push_back(last);
  }
  return bytes;
}

TEST(LzwVectors, BothDirectionsAreAsPrinted) {
  int seen = 0;
  for (const auto& vector : test::load_vectors("dtc")) {
    if (vector.kind != "ok" || !vector.has("codes_hex")) continue;
    SCOPED_TRACE(vector.name);
    ++seen;
    const Bytes original = vector.hex("original_hex"), codes = vector.hex("codes_hex");
    EXPECT_EQ(to_hex(encoded(original)), to_hex(codes));
    EXPECT_EQ(to_hex(packed(reference_codes(original))), to_hex(codes));
    const auto back = decoded(codes, original.size());
    ASSERT_TRUE(back.has_value()) << to_text(back.error());
    EXPECT_EQ(to_hex(*back), to_hex(original));
  }
  EXPECT_GE(seen, 8);
}

TEST(LzwVectors, WhatIsMalformedIsAFault) {
  int seen = 0;
  for (const auto& vector : test::load_vectors("dtc")) {
    if (vector.kind != "malformed" || !vector.has("codes_hex")) continue;
    ++seen;
    const auto back =
        decoded(vector.hex("codes_hex"), std::stoul(vector.texts.at("original_length")));
    ASSERT_FALSE(back.has_value()) << vector.name;
    if (vector.name == "lzw_truncated") { EXPECT_EQ(back.error(), LzwFault::kTruncated); }
    if (vector.name == "lzw_code_too_high") { EXPECT_EQ(back.error(), LzwFault::kCode); }
  }
  EXPECT_GE(seen, 2);
}

TEST(Lzw, AgreesWithADictionaryOfStringsOnAnyData) {
  std::mt19937 random(7);
  for (int round = 0; round < 600; ++round) {
    const std::size_t length = round % 10 == 0 ? 4096 - random() % 3 : 1 + random() % 700;
    const Bytes original = data(random, length, 1u + static_cast<unsigned>(random() % 256),
                                static_cast<unsigned>(random() % 17));
    const Bytes codes = encoded(original);
    ASSERT_EQ(to_hex(codes), to_hex(packed(reference_codes(original)))) << "round " << round;
    const auto back = decoded(codes, length);
    ASSERT_TRUE(back.has_value()) << "round " << round << ": " << to_text(back.error());
    ASSERT_EQ(to_hex(*back), to_hex(original)) << "round " << round;
  }
}

TEST(Lzw, TheDictionaryStopsAt4096Entries) {
  std::mt19937 random(3);
  const Bytes original = data(random, 20000, 256, 0);  // four times the capacity
  const auto codes = reference_codes(original);
  ASSERT_GT(codes.size(), 8000u);
  EXPECT_EQ(to_hex(encoded(original)), to_hex(packed(codes)));
  const Bytes longest(original.begin(), original.begin() + 4096);
  EXPECT_GT(reference_codes(longest).size(), 2500u);
  EXPECT_EQ(decoded(encoded(longest), 4096), longest);
}

TEST(Lzw, NothingIsNothing) {
  EXPECT_TRUE(encoded({}).empty());
  EXPECT_EQ(decoded({}, 0), Bytes{});
}

TEST(Lzw, TheEncoderStopsWhereThereIsNoRoom) {
  std::mt19937 random(5);
  LzwEncoder encoder;
  const Bytes original = data(random, 300, 40, 8);
  const Bytes codes = encoded(original);
  for (std::size_t room = 0; room <= codes.size(); ++room) {
    Bytes out(codes.size() + 1, 0xEE);
    const auto size = encoder.encode(original, std::span(out).first(room));
    EXPECT_EQ(size.has_value(), room == codes.size());
    EXPECT_EQ(out[room], 0xEE) << "written behind the room";
  }
}

TEST(Lzw, EveryTruncationIsAFault) {
  std::mt19937 random(11);
  const Bytes original = data(random, 200, 9, 9);
  const Bytes codes = encoded(original);
  for (std::size_t size = 0; size < codes.size(); ++size) {
    const auto back = decoded(ByteView(codes).first(size), original.size());
    ASSERT_FALSE(back.has_value()) << size;
    EXPECT_EQ(back.error(), LzwFault::kTruncated);
  }
}

TEST(Lzw, MoreThanTheCodesIsAFault) {
  Bytes codes = encoded(*from_hex("AB"));
  ASSERT_EQ(to_hex(codes, '\0'), "A580");
  EXPECT_EQ(decoded(*from_hex("A581"), 1).error(), LzwFault::kTail);
  EXPECT_EQ(decoded(*from_hex("A58000"), 1).error(), LzwFault::kTail);
  EXPECT_EQ(decoded(*from_hex("0840"), 1).error(), LzwFault::kOverrun);  // 0, then 00
  EXPECT_EQ(decoded(codes, 4097).error(), LzwFault::kTooLong);
}

// The CRC of the message detects other data. Both decoders must give the same result.
TEST(Lzw, EveryFlippedBitIsJudgedAsTheReferenceDoes) {
  std::mt19937 random(13);
  const Bytes original = data(random, 150, 7, 10);
  const Bytes codes = encoded(original);
  for (std::size_t bit = 0; bit < codes.size() * 8; ++bit) {
    Bytes flipped = codes;
    flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    const auto back = decoded(flipped, original.size());
    const auto expected = reference_decode(flipped, original.size());
    if (back) {
      EXPECT_EQ(*back, expected);
    } else if (back.error() != LzwFault::kTail) {
      EXPECT_FALSE(expected.has_value()) << bit;
    }
  }
}

TEST(Lzw, RandomCodesAreBounded) {
  std::mt19937 random(17);
  for (int round = 0; round < 20000; ++round) {
    const Bytes codes = data(random, random() % 120, 256, static_cast<unsigned>(random() % 16));
    const std::size_t length = random() % 5000;
    Bytes out{0x55};
    const auto result = lzw_decode(codes, length, out);
    ASSERT_EQ(out.size(), result ? 1 + length : 1)
        << "what stood before stays, and no more comes than was said";
    if (result) { ASSERT_EQ(Bytes(out.begin() + 1, out.end()), reference_decode(codes, length)); }
  }
}

// The longest expansion: each code is one nibble longer. 103 bytes give exactly 4096.
TEST(Lzw, ABombGivesWhatItSaysOrAFault) {
  const Bytes zeros(4096, 0);
  const Bytes bomb = encoded(zeros);
  EXPECT_LT(bomb.size(), 120u);
  EXPECT_EQ(decoded(bomb, 4096), zeros);
  EXPECT_FALSE(decoded(bomb, 4095).has_value());
  EXPECT_FALSE(decoded(bomb, 100).has_value());
  Bytes endless = encoded(Bytes(60000, 0));
  EXPECT_FALSE(decoded(endless, 4096).has_value());
}

TEST(Lzw, EachFaultHasItsText) {
  EXPECT_EQ(to_text(LzwFault::kTooLong), "the original is longer than 4096 bytes");
  EXPECT_EQ(to_text(LzwFault::kTail), "bytes or bits behind the last code");
  EXPECT_EQ(to_text(static_cast<LzwFault>(99)), "unknown");
}

// An encoder never writes so many codes for 4096 bytes, but the codes are valid.
TEST(Lzw, CodesBehindTheLastEntryHaveTheWidthOfTheLast) {
  const std::vector<unsigned> alone(2 * kLzwMaxOriginal, 5);
  EXPECT_EQ(decoded(packed(alone), kLzwMaxOriginal), Bytes(kLzwMaxOriginal, 0x55));
}

}  // namespace
}  // namespace fieldcast
