#include "tools/station/stream/live_feed.hpp"

#include <gtest/gtest.h>

#include "tests/tools/station/stream/stream_support.hpp"

namespace fieldcast::web {
namespace {

using test::at;
using test::batch_of;
using test::sample;

class LiveFeedTest : public testing::Test {
 protected:
  const LiveChannel* channel(const std::string& name, Instant now = {}) {
    inbox_.deliver(model_, now);
    return model_.find({"north:line", "press", name});
  }
  LiveModel model_;
  DomainInbox inbox_{[] {}};
  LiveFeed feed_{inbox_};
};

TEST_F(LiveFeedTest, TheNewestSampleOfABatchIsPresent) {
  feed_.pass(batch_of({sample(1), sample(2)}, at(3)), at(3));
  const LiveChannel* const live = channel("a");
  ASSERT_NE(live, nullptr);
  EXPECT_EQ(live->origin, Origin::kStream);
  EXPECT_EQ(live->last.sequence, 2U);
  EXPECT_EQ(live->last.quality, Quality::kGood);
  ASSERT_NE(channel("b"), nullptr);
  EXPECT_EQ(channel("b")->last.quality, Quality::kNotYetRead);
}

TEST_F(LiveFeedTest, ALateSampleNeverReplacesAValue) {
  feed_.pass(batch_of({sample(5)}, at(5)), at(5));
  feed_.pass(batch_of({sample(2)}, at(6), true), at(6));
  EXPECT_EQ(channel("a")->last.sequence, 5U);
}

TEST_F(LiveFeedTest, AValueOfAnOldMessageIsUncertain) {
  feed_.pass(batch_of({sample(1)}, at(1)), at(40));
  EXPECT_EQ(channel("a")->last.quality, Quality::kUncertain);
}

TEST_F(LiveFeedTest, AChannelThatTheNextCatalogueDoesNotHaveIsRemoved) {
  feed_.pass(batch_of({sample(1)}, at(1)), at(1));
  ASSERT_NE(channel("b"), nullptr);
  StreamBatch next = batch_of({sample(2)}, at(2));
  next.catalogue =
      std::make_shared<const forward::DeviceCatalogue>(test::catalogue_of("north:line", {"a"}));
  feed_.pass(next, at(2));
  EXPECT_FALSE(channel("a")->gone);
  EXPECT_TRUE(channel("b")->gone);
}

TEST_F(LiveFeedTest, ValuesOfASilentSiteBecomeUncertain) {
  feed_.pass(batch_of({sample(1)}, at(1)), at(1));
  EXPECT_EQ(channel("a")->last.quality, Quality::kGood);
  inbox_.on_silent("nor");
  EXPECT_EQ(channel("a")->last.quality, Quality::kGood);
  inbox_.on_silent("north");
  EXPECT_EQ(channel("a")->last.quality, Quality::kUncertain);
}

}  // namespace
}  // namespace fieldcast::web
