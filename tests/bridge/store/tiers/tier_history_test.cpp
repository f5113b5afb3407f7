#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/store/tiers/tier_table.hpp"
#include "bridge/store/tiers/tier_writer.hpp"
#include "tests/bridge/store/older_store.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/tiers/times.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::at_second;
using testing::ElementsAre;

constexpr std::int64_t kSpan = 3 * 3600 + 600;  // seconds of samples, one every ten seconds

class TierHistoryTest : public testing::Test {
 protected:
  TierHistoryTest()
      : connection_(open_store(StoreAddress(scratch_.path("a.db")), IfMissing::kCreate)) {
    SampleTable samples(*connection_);
    const auto id = samples.channel_id("line", "press", "t", "", "float64");
    std::vector<SampleRow> rows;
    for (std::int64_t second = 0; second < kSpan; second += 10) {
      rows.push_back({.channel = id,
                      .published_at = at_second(second),
                      .quality = second % 100 == 0 ? Quality::kBadFrame : Quality::kGood,
                      .value = second % 130});
    }
    SqlTransaction transaction(*connection_);
    samples.insert(rows);
    TierWriter tiers;
    tiers.note(*connection_, rows);
    transaction.commit();
    while (tiers.step(*connection_, at_second(kSpan))) {}
    channel_ = samples.channels(Pattern()).at(0);
  }

  std::vector<Bucket> read(Duration every, UtcTime from = {}, UtcTime to = at_second(kSpan)) {
    std::vector<Bucket> found;
    TierHistory(*connection_, every).read(channel_, from, to, [&](const Bucket& bucket) {
      found.push_back(bucket);
      return true;
    });
    return found;
  }
  void remove_samples(std::int64_t before) {
    SampleTable(*connection_).remove_before(channel_.id, at_second(before), 100'000);
  }

  const test::Scratch scratch_;
  std::unique_ptr<SqlConnection> connection_;
  StoredChannel channel_;
};

TEST_F(TierHistoryTest, IsTheSameFromSamplesAndFromTiers) {
  std::vector<std::vector<Bucket>> from_tiers;
  const Duration widths[] = {1min, 7min, 1h, 2h, 24h};
  for (const Duration every : widths) from_tiers.push_back(read(every));
  connection_->script("delete from tiers");
  for (std::size_t i = 0; i < std::size(widths); ++i)
    EXPECT_EQ(read(widths[i]), from_tiers[i]) << to_seconds(widths[i]);
  EXPECT_EQ(from_tiers[2].size(), 4u) << "three whole hours and the one that is not closed";
  EXPECT_EQ(from_tiers[2][3].count, 54u);
}

TEST_F(TierHistoryTest, ReadsTheCoarsestTierThatServes) {
  remove_samples(kSpan);
  EXPECT_THAT(read(10s), ElementsAre());
  EXPECT_EQ(read(7min).size(), 28u) << "minutes; the last one was not closed";
  connection_->script("delete from tiers where width = 60");
  EXPECT_THAT(read(7min), ElementsAre());
  EXPECT_EQ(read(1h).size(), 3u);
}

TEST_F(TierHistoryTest, GivesWholeBuckets) {
  const auto one = read(1h, at_second(3700), at_second(3800));
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].start, at_second(3600));
  EXPECT_EQ(one[0].count + one[0].bad, 360u);
  EXPECT_EQ(read(1h, at_second(3600), at_second(7200)), one) << "the end is not in it";
  EXPECT_EQ(read(1h, at_second(3600), at_second(7201)).size(), 2u);
}

TEST_F(TierHistoryTest, EndsWhenNobodyWantsMore) {
  int seen = 0;
  EXPECT_FALSE(
      TierHistory(*connection_, 1min).read(channel_, {}, at_second(kSpan), [&](const Bucket&) {
        return ++seen < 3;
      }));
  EXPECT_EQ(seen, 3);
}

TEST_F(TierHistoryTest, SaysWhenACoarserTierReachesFurtherBack) {
  EXPECT_FALSE(TierHistory(*connection_, 10s).reach(channel_));
  remove_samples(3700);
  const auto reach = TierHistory(*connection_, 10s).reach(channel_);
  ASSERT_TRUE(reach);
  EXPECT_EQ(reach->oldest, at_second(3700));
  EXPECT_EQ(reach->coarser_tier, 0u);
  EXPECT_EQ(reach->coarser_oldest, at_second(0));
  EXPECT_FALSE(TierHistory(*connection_, 1min).reach(channel_));
  connection_->script("delete from tiers where width = 60");
  EXPECT_EQ(TierHistory(*connection_, 1min).reach(channel_)->coarser_tier, 1u);
}

TEST_F(TierHistoryTest, ReadsSamplesWhileTiersOfAnOlderStoreAreMissing) {
  const auto wanted = read(1h);
  test::back_to_version(*connection_, 4);
  connection_ = open_store(StoreAddress(scratch_.path("a.db")), IfMissing::kFail);
  EXPECT_EQ(read(1h), wanted);
}

}  // namespace
}  // namespace fieldcast
