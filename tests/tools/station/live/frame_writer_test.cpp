#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/tools/station/live/live_support.hpp"
#include "tools/station/live/frames.hpp"

namespace fieldcast::web {
namespace {

template <class Number>
Number at(const std::string& frame, std::size_t offset) {
  Number number;
  std::memcpy(&number, frame.data() + offset, sizeof number);
  return number;
}

struct FrameWriter : ::testing::Test {
  void add(const std::string& name, Value value, std::int64_t acquired_ms,
           Quality quality = Quality::kGood) {
    model.on_channel(channel_of(name));
    model.on_sample(sample_of(name, std::move(value), acquired_ms, quality));
  }
  [[nodiscard]] Channels all() const { return model.changed_since(0, 1000); }

  LiveModel model;
};

TEST_F(FrameWriter, ColumnsStandSideBySide) {
  add("a", 21.5, 5'000);
  add("b", true, 3'000, Quality::kBadNoResponse);
  const std::string frame = binary_frame(all());
  ASSERT_EQ(frame.size(), kFrameHeader + 2 * kFrameRow);
  EXPECT_EQ(at<std::uint32_t>(frame, 0), 1u);      // kind, zeros
  EXPECT_EQ(at<std::uint32_t>(frame, 4), 2u);      // n
  EXPECT_EQ(at<double>(frame, 8), 5'000);          // base_ms
  EXPECT_EQ(at<double>(frame, 16), 21.5);          // value
  EXPECT_EQ(at<double>(frame, 24), 1);             //
  EXPECT_EQ(at<std::uint32_t>(frame, 32), 1u);     // id
  EXPECT_EQ(at<std::uint32_t>(frame, 36), 2u);     //
  EXPECT_EQ(at<std::uint32_t>(frame, 40), 0u);     // age_ms
  EXPECT_EQ(at<std::uint32_t>(frame, 44), 2000u);  //
  EXPECT_EQ(frame[48], 0);                         // quality
  EXPECT_EQ(frame[49], 2);                         //
}

TEST_F(FrameWriter, NobodyChanged) {
  EXPECT_EQ(binary_frame({}), std::string("\1\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 16));
  EXPECT_EQ(values_message({}), "");
}

TEST_F(FrameWriter, WhatWasNeverAcquiredHasNoAgeAndNoValue) {
  add("a", 0.0, 0, Quality::kNotYetRead);
  add("b", 1.0, 5'000'000'000);  // "a" would be older than 49 days as well
  const std::string frame = binary_frame(all());
  EXPECT_TRUE(std::isnan(at<double>(frame, 16)));
  EXPECT_EQ(at<std::uint32_t>(frame, 40), kNoAge);
  EXPECT_EQ(frame[48], 7);
}

TEST_F(FrameWriter, WhatIsOlderThanFortyNineDaysHasNoAge) {
  add("a", 1.0, 1);
  add("b", 1.0, 1 + 0xFFFFFFFFll);
  add("c", 1.0, 2);
  const std::string frame = binary_frame(all());
  const std::size_t age = kFrameHeader + 3 * 12;
  EXPECT_EQ(at<std::uint32_t>(frame, age), kNoAge);
  EXPECT_EQ(at<std::uint32_t>(frame, age + 8), 0xFFFFFFFEu);
}

TEST_F(FrameWriter, TextsAndGreatIntegersGoByTheText) {
  add("name", std::string("M-\"7\""), 2'000);
  add("count", std::uint64_t{9007199254740993}, 3'000);
  add("small", std::int64_t{-5}, 4'000);
  const std::string frame = binary_frame(all());
  EXPECT_TRUE(std::isnan(at<double>(frame, 16)));
  EXPECT_TRUE(std::isnan(at<double>(frame, 24)));
  EXPECT_EQ(at<double>(frame, 32), -5);
  EXPECT_EQ(values_message(all()),
            R"({"kind":"values","id":[1,2],"value":["M-\"7\"","9007199254740993"],)"
            R"("acquired_ms":[2000,3000],"quality":[0,0]})");
}

}  // namespace
}  // namespace fieldcast::web
