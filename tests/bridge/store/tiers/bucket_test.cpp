#include "bridge/store/tiers/bucket.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/bridge/store/tiers/times.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

using test::since_1970;

TEST(Bucket, BeginsWhereUtcHasItsMinutesAndHours) {
  EXPECT_EQ(bucket_start(since_1970(0), 1min), since_1970(0));
  EXPECT_EQ(bucket_start({60'000'000'000 - 1}, 1min), since_1970(0));
  EXPECT_EQ(bucket_start(since_1970(60), 1min), since_1970(60));
  EXPECT_EQ(bucket_start(since_1970(1'700'000'000), 1h), since_1970(1'699'999'200));
  EXPECT_EQ(bucket_start({-1}, 1min), since_1970(-60)) << "a clock before 1970";
  EXPECT_EQ(bucket_start({INT64_MIN}, 1h), UtcTime{INT64_MIN}) << "no hour begins before";
  EXPECT_LE(bucket_start({INT64_MAX}, 1h), UtcTime{INT64_MAX});
}

TEST(Bucket, CountsGoodNumbersAndHowManySamplesWereNot) {
  Bucket bucket;
  EXPECT_TRUE(bucket.empty());
  EXPECT_FALSE(bucket.average());
  bucket.add(Quality::kBadNoResponse, 900.0);
  EXPECT_FALSE(bucket.empty());
  EXPECT_FALSE(bucket.average()) << "no sample is good";
  for (const double value : {3.0, -1.0, 4.0}) bucket.add(Quality::kGood, value);
  bucket.add(Quality::kUncertain, -900.0);
  bucket.add(Quality::kGood, std::nan(""));
  bucket.add(Quality::kGood, std::numeric_limits<double>::infinity());
  EXPECT_EQ(bucket,
            (Bucket{.count = 3, .bad = 4, .min = -1, .max = 4, .sum = 6, .first = 3, .last = 4}));
  EXPECT_EQ(bucket.average(), 2.0);
}

TEST(Bucket, TakesBooleansAndIntegersAsNumbersAndNoTexts) {
  Bucket bucket;
  bucket.add(Quality::kGood, true);
  bucket.add(Quality::kGood, std::int64_t{-5});
  bucket.add(Quality::kGood, std::uint64_t{UINT64_MAX});
  bucket.add(Quality::kGood, std::string("9"));
  bucket.add(Quality::kBadFrame, std::string());
  EXPECT_EQ(bucket.count, 3u);
  EXPECT_EQ(bucket.bad, 0u);
  EXPECT_EQ(bucket.min, -5.0);
  EXPECT_EQ(bucket.max, 18446744073709551616.0);
  EXPECT_EQ(bucket.first, 1.0);
}

TEST(Bucket, OfPartsIsTheBucketOfTheWhole) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Bucket whole, appended, part;
    for (int i = 0; i < 50; ++i) {
      // integers, so that sums are exact
      const auto value = static_cast<std::int64_t>(random() % 100) - 50;
      const Quality quality = random() % 4 == 0 ? Quality::kBadNoResponse : Quality::kGood;
      whole.add(quality, value);
      part.add(quality, value);
      if (random() % 5 != 0) continue;
      appended.append(part);
      part = {};
    }
    appended.append(part);
    EXPECT_EQ(appended, whole);
  }
}

TEST(Tier, IsClosedAFewSecondsAfterItsEnd) {
  EXPECT_EQ(closed_before(since_1970(64), 1min), since_1970(0));
  EXPECT_EQ(closed_before(since_1970(65), 1min), since_1970(60))
      << "the minute that began at 0 is closed";
  EXPECT_EQ(closed_before(since_1970(3604), 1h), since_1970(0));
  EXPECT_EQ(closed_before(since_1970(3605), 1h), since_1970(3600));
}

TEST(Tier, TheCoarsestThatAddsUpIsRead) {
  EXPECT_FALSE(tier_for(1s));
  EXPECT_FALSE(tier_for(90s)) << "one and a half minutes";
  EXPECT_EQ(tier_for(1min), 0u);
  EXPECT_EQ(tier_for(90min), 0u);
  EXPECT_EQ(tier_for(1h), 1u);
  EXPECT_EQ(tier_for(24h), 1u);
}

TEST(Tier, OfSoManyPointsHasNoMoreAndNotFarLess) {
  EXPECT_EQ(width_for(24h * 30, 1000), 44min);
  EXPECT_EQ(width_for(1h, 60), 2min);
  EXPECT_EQ(width_for(10min, 60), 11s);
  EXPECT_EQ(width_for(1ns, 1), 1ms);
  for (const Duration span : {Duration{1s}, Duration{1h}, Duration{24h}, Duration{24h * 3650}}) {
    for (const std::uint32_t points : {1u, 2u, 10u, 1000u, 100'000u}) {
      const Duration width = width_for(span, points);
      const std::int64_t touched = span / width + 1;  // if the span begins within a bucket
      EXPECT_LE(touched, std::max(points, 2u)) << to_seconds(span) << " s in " << points;
      if (width == Duration{1ms}) continue;
      EXPECT_GE(touched, points / 3) << to_seconds(span) << " s in " << points;
    }
  }
}

TEST(OpenBuckets, AreNotedOnceUntilTheyAreWritten) {
  OpenBuckets open(1min);
  EXPECT_EQ(open.touch(7, since_1970(59)), since_1970(0));
  EXPECT_FALSE(open.touch(7, since_1970(1)));
  EXPECT_EQ(open.touch(8, since_1970(59)), since_1970(0)) << "another channel";
  EXPECT_EQ(open.touch(7, since_1970(60)), since_1970(60));
  EXPECT_EQ(open.touch(7, since_1970(2)), since_1970(0)) << "a late sample";
  open.close(7, since_1970(60));
  EXPECT_FALSE(open.touch(7, since_1970(3))) << "another bucket was written";
  open.close(7, since_1970(0));
  EXPECT_EQ(open.touch(7, since_1970(4)), since_1970(0))
      << "it was written, and another sample comes late";
}

}  // namespace
}  // namespace fieldcast
