#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <random>

#include "core/base/value.hpp"

namespace fieldcast {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(NumberText, HasNoExponentWherePeopleExpectNone) {
  EXPECT_EQ(number_text(100000.0), "100000");
  EXPECT_EQ(number_text(0.0001), "0.0001");
  EXPECT_EQ(number_text(9999999999999998.0), "9999999999999998");
  EXPECT_EQ(number_text(1e16), "1e+16");
  EXPECT_EQ(number_text(0.00001), "1e-05");
  EXPECT_EQ(number_text(-2.5e-7), "-2.5e-07");
  EXPECT_EQ(number_text(25.0), "25");
  EXPECT_EQ(number_text(0.0), "0");
}

TEST(NumberText, NoNumberAndInfinitiesHaveOneSpelling) {
  EXPECT_EQ(number_text(std::nan("")), "nan");
  EXPECT_EQ(number_text(-std::nan("")), "nan");
  EXPECT_EQ(number_text(kInfinity), "inf");
  EXPECT_EQ(float32_text(-kInfinity), "-inf");
  EXPECT_EQ(float32_text(std::nan("")), "nan");
}

TEST(NumberText, OfAFloatHasTheDigitsOfAFloat) {
  EXPECT_EQ(float32_text(static_cast<double>(0.1F)), "0.1");
  EXPECT_EQ(number_text(static_cast<double>(0.1F)), "0.10000000149011612");
  EXPECT_EQ(float32_text(0.1), "0.1") << "scaled: no float any more, every digit of the double";
  EXPECT_EQ(float32_text(1.0 / 3.0), "0.3333333333333333");
  EXPECT_EQ(float32_text(1e300), "1e+300");
}

TEST(NumberText, ReadsBackAsTheSameNumber) {
  std::mt19937_64 random{7};
  unsigned seen = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto number = std::bit_cast<double>(random());
    if (!std::isfinite(number)) continue;
    ++seen;
    const std::string text = number_text(number);
    double back = 0;
    std::from_chars(text.data(), text.data() + text.size(), back);
    ASSERT_EQ(back, number) << text;
    ASSERT_EQ(to_text(Value{number}), text);
    const auto single = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (!std::isfinite(single)) continue;
    const std::string short_text = float32_text(static_cast<double>(single));
    float again = 0;
    std::from_chars(short_text.data(), short_text.data() + short_text.size(), again);
    ASSERT_EQ(again, single) << short_text;
  }
  EXPECT_GT(seen, 190'000u);
}

}  // namespace
}  // namespace fieldcast
