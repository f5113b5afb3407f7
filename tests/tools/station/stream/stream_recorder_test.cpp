#include "tools/station/stream/stream_recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/store/tiers/tier_table.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"
#include "tests/tools/station/stream/stream_support.hpp"

namespace fieldcast::web {
namespace {

using fieldcast::test::forever;
using fieldcast::test::history;
using fieldcast::test::Scratch;
using std::chrono::seconds;
using test::at;
using test::batch_of;
using test::sample;
using testing::ElementsAre;

class StreamRecorderTest : public testing::Test {
 protected:
  void start() {
    store_.emplace(forever(address_));
    recorder_.emplace(*store_);
  }
  void stop() {
    ASSERT_TRUE(store_->flush(seconds{30}));
    recorder_.reset();
    store_.reset();
  }
  [[nodiscard]] std::vector<std::uint64_t> stored() const {
    std::vector<std::uint64_t> found;
    for (const auto& each : history(address_, "north:line/press/a")) found.push_back(each.sequence);
    return found;
  }
  const Scratch scratch_;
  const StoreAddress address_{scratch_.path("stream.db")};
  std::optional<Store> store_;
  std::optional<StreamRecorder> recorder_;
};

TEST_F(StreamRecorderTest, LateSamplesFillTheGapInOrder) {
  start();
  recorder_->record(batch_of({sample(1), sample(2)}, at(3)));
  recorder_->record(batch_of({sample(6), sample(7)}, at(8)));
  recorder_->record(batch_of({sample(3), sample(4), sample(5)}, at(9), true));
  stop();
  EXPECT_THAT(stored(), ElementsAre(1, 2, 3, 4, 5, 6, 7));
}

TEST_F(StreamRecorderTest, RangesOfLateSamplesAreNoted) {
  start();
  recorder_->record(batch_of({sample(1), sample(2)}, at(3)));
  EXPECT_TRUE(recorder_->take_late().empty());
  recorder_->record(batch_of({sample(3), sample(4)}, at(9), true));
  recorder_->record(batch_of({sample(5)}, at(10), true));
  recorder_->record(batch_of({sample(5)}, at(11), true));
  recorder_->record(batch_of({sample(500)}, at(600), true));
  const auto late = recorder_->take_late();
  ASSERT_EQ(late.size(), 2U);
  EXPECT_EQ(late[0].bus, "north:line");
  EXPECT_EQ(late[0].device, "press");
  EXPECT_EQ(late[0].range, (LateRange{at(3), at(5), 3, at(10)})) << "a repeated one is not counted";
  EXPECT_EQ(late[1].range.samples, 1U);
  EXPECT_TRUE(recorder_->take_late().empty());
  stop();
}

TEST_F(StreamRecorderTest, ARepeatedBatchIsStoredOnce) {
  start();
  recorder_->record(batch_of({sample(1), sample(2)}, at(3)));
  recorder_->record(batch_of({sample(1), sample(2)}, at(3)));
  recorder_->record(batch_of({sample(2)}, at(20), true));
  EXPECT_EQ(recorder_->counters().repeated, 3U);
  stop();
  EXPECT_THAT(stored(), ElementsAre(1, 2));
}

TEST_F(StreamRecorderTest, ABatchThatIsReadAgainAfterARestartIsStoredOnce) {
  const StreamBatch batch = batch_of({sample(1), sample(2, Quality::kBadFrame), sample(3)}, at(4));
  for (int run = 0; run < 2; ++run) {
    start();
    recorder_->record(batch);
    stop();
  }
  EXPECT_THAT(stored(), ElementsAre(1, 2, 3));
}

// A minute that was closed is made again.
TEST_F(StreamRecorderTest, LateSamplesAreInTheMinuteAndTheHour) {
  start();
  recorder_->record(batch_of({sample(1), sample(2)}, at(3)));
  stop();
  auto connection = open_store(address_, IfMissing::kFail);
  TierWriter tiers;
  while (tiers.step(*connection, at(100'000))) {}
  const auto minute = [&](std::size_t tier) {
    std::vector<Bucket> found;
    const auto channel = SampleTable(*connection).find({"north:line", "press", "a"});
    TierTable(*connection)
        .read(kTiers[tier], channel->id, UtcTime{}, at(100'000), [&](const Bucket& bucket) {
          found.push_back(bucket);
          return true;
        });
    return found;
  };
  ASSERT_EQ(minute(0).size(), 1U);
  EXPECT_EQ(minute(0)[0].count, 2U);
  start();
  recorder_->record(batch_of({sample(3), sample(4), sample(5)}, at(9), true));
  stop();
  TierWriter again;
  while (again.step(*connection, at(100'000))) {}
  ASSERT_EQ(minute(0).size(), 1U);
  EXPECT_EQ(minute(0)[0].count, 5U);
  EXPECT_EQ(minute(0)[0].max, 5.0);
  ASSERT_EQ(minute(1).size(), 1U);
  EXPECT_EQ(minute(1)[0].count, 5U);
}

TEST(StoredTimes, ABadSampleIsBetweenItsNeighbours) {
  EXPECT_THAT(stored_times(batch_of({sample(1), sample(1, Quality::kBadFrame), sample(5)}, at(9))),
              ElementsAre(at(1), UtcTime{at(5).nanoseconds - 1}, at(5)));
  EXPECT_THAT(stored_times(batch_of({sample(1), sample(1, Quality::kBadFrame)}, at(9))),
              ElementsAre(at(1), at(1)));
  EXPECT_THAT(stored_times(batch_of({sample(1, Quality::kBadFrame)}, at(9))), ElementsAre(at(9)));
}

TEST(StoredTimes, ALateBadSampleIsNotStoredAtTheTimeOfItsArrival) {
  EXPECT_THAT(stored_times(batch_of({sample(1), sample(1, Quality::kBadFrame)}, at(900), true)),
              ElementsAre(at(1), at(1)));
}

TEST(StoredTimes, AnAcquisitionFarInTheFutureIsNotBelieved) {
  EXPECT_THAT(stored_times(batch_of({sample(1000)}, at(9))), ElementsAre(at(9)));
}

}  // namespace
}  // namespace fieldcast::web
