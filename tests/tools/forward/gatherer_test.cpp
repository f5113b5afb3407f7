#include "tools/forward/batch/gatherer.hpp"

#include <gmock/gmock.h>

#include "tests/tools/forward/batch_support.hpp"

namespace fieldcast::forward {
namespace {

constexpr Instant kStart{std::chrono::seconds{100}};
constexpr Duration kSecond = std::chrono::seconds{1};

struct GathererTest : testing::Test {
  Gatherer gatherer{{.time = kSecond, .samples = 4}};

  void announce(const std::vector<std::string>& names) {
    for (const std::string& name : names) gatherer.on_channel(channel(name));
  }
};

TEST_F(GathererTest, ABatchEndsAfterItsTime) {
  announce({"a", "b"});
  gatherer.on_sample(sample("a", 1), kStart);
  gatherer.on_sample(sample("b", 5), kStart + kSecond / 2);
  EXPECT_TRUE(gatherer.take(kStart + kSecond / 2).empty());
  const auto taken = gatherer.take(kStart + kSecond);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].batch.bus, "line");
  EXPECT_EQ(taken[0].batch.device, "press");
  EXPECT_EQ(taken[0].batch.epoch, 7u);
  ASSERT_EQ(taken[0].batch.samples.size(), 2u);
  EXPECT_EQ(taken[0].batch.samples[1].channel, 1u);
  EXPECT_EQ(taken[0].batch.samples[1].sequence, 5u);
  EXPECT_TRUE(gatherer.take(kStart + 9 * kSecond).empty());
}

TEST_F(GathererTest, AFullBatchEndsImmediately) {
  announce({"a"});
  for (std::uint64_t i = 1; i <= 5; ++i) gatherer.on_sample(sample("a", i), kStart);
  const auto taken = gatherer.take(kStart);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].batch.samples.size(), 4u);
  EXPECT_EQ(gatherer.take(kStart, true).size(), 1u);
}

TEST_F(GathererTest, ABatchWithLongTextsEndsEarlier) {
  Gatherer large{{.time = kSecond, .samples = 2'000}};
  large.on_channel(channel("a"));
  for (std::uint64_t i = 1; i <= 600; ++i) {
    StationSample text = sample("a", i);
    text.value = std::string(256, 'x');
    large.on_sample(text, kStart);
  }
  const auto taken = large.take(kStart);
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(taken[0].batch.samples.size(), Gatherer::kMaxTexts / 256);
}

TEST_F(GathererTest, SamplesAreSortedByChannelAndKeepTheirOrder) {
  announce({"a", "b"});
  gatherer.on_sample(sample("b", 1), kStart);
  gatherer.on_sample(sample("a", 1), kStart);
  gatherer.on_sample(sample("b", 2), kStart);
  const auto taken = gatherer.take(kStart, true);
  ASSERT_EQ(taken.size(), 1u);
  std::vector<std::pair<std::uint32_t, std::uint64_t>> order;
  for (const BatchSample& each : taken[0].batch.samples)
    order.emplace_back(each.channel, each.sequence);
  EXPECT_THAT(order, testing::ElementsAre(std::pair{0u, 1u}, std::pair{1u, 1u}, std::pair{1u, 2u}));
}

TEST_F(GathererTest, TheCatalogueIsPassedOnOnceAndAfterAChange) {
  announce({"a"});
  gatherer.on_sample(sample("a", 1), kStart);
  const auto first = gatherer.take(kStart, true);
  ASSERT_TRUE(first[0].catalogue);
  EXPECT_EQ(first[0].batch.catalogue, identity_of(*first[0].catalogue));
  announce({"a"});
  gatherer.on_sample(sample("a", 2), kStart);
  EXPECT_FALSE(gatherer.take(kStart, true)[0].catalogue);
  announce({"b"});
  gatherer.on_sample(sample("a", 3), kStart);
  const auto third = gatherer.take(kStart, true);
  ASSERT_TRUE(third[0].catalogue);
  EXPECT_EQ(third[0].catalogue->channels.size(), 2u);
  EXPECT_NE(third[0].batch.catalogue, first[0].batch.catalogue);
}

TEST_F(GathererTest, AnAcceptedSampleIsNotAcceptedAgain) {
  announce({"a"});
  gatherer.on_sample(sample("a", 2), kStart);
  gatherer.on_sample(sample("a", 2), kStart);
  gatherer.on_sample(sample("a", 1), kStart);
  EXPECT_EQ(gatherer.take(kStart, true)[0].batch.samples.size(), 1u);
  EXPECT_EQ(gatherer.counters().repeated, 2u);
}

TEST_F(GathererTest, AnAcceptedSampleIsNotAcceptedAgainAfterARestart) {
  announce({"a", "b"});
  gatherer.on_sample(sample("a", 2), kStart);
  Gatherer restarted{{.time = kSecond, .samples = 4}};
  for (const Gathered& gathered : gatherer.take(kStart, true)) {
    for (const NamedPosition& position : gathered.positions) restarted.restore(position);
  }
  restarted.on_channel(channel("a"));
  restarted.on_sample(sample("a", 2), kStart);
  EXPECT_TRUE(restarted.take(kStart, true).empty());
  restarted.on_sample(sample("a", 3), kStart);
  EXPECT_EQ(restarted.take(kStart, true).size(), 1u);
}

TEST_F(GathererTest, ANewEpochBeginsABatchAndItsSequences) {
  announce({"a"});
  gatherer.on_sample(sample("a", 9, 7), kStart);
  gatherer.on_sample(sample("a", 1, 8), kStart);
  const auto taken = gatherer.take(kStart, true);
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_EQ(taken[0].batch.epoch, 7u);
  EXPECT_EQ(taken[1].batch.epoch, 8u);
  EXPECT_EQ(taken[1].batch.samples[0].sequence, 1u);
}

TEST_F(GathererTest, ADeviceWithoutChannelsEndsItsBatchAndBeginsAgain) {
  announce({"a", "b"});
  gatherer.on_sample(sample("b", 1), kStart);
  gatherer.on_channel_removed("line", "press", "a");
  EXPECT_TRUE(gatherer.take(kStart).empty());
  gatherer.on_channel_removed("line", "press", "b");
  const auto taken = gatherer.take(kStart);
  ASSERT_EQ(taken.size(), 1u);
  EXPECT_EQ(taken[0].catalogue->channels.size(), 2u);
  announce({"b"});
  gatherer.on_sample(sample("b", 1), kStart);
  EXPECT_TRUE(gatherer.take(kStart, true).empty()) << "it was accepted before";
  gatherer.on_sample(sample("b", 2), kStart);
  EXPECT_EQ(gatherer.take(kStart, true)[0].catalogue->channels.size(), 1u);
}

TEST_F(GathererTest, ASampleWithoutAChannelIsCounted) {
  gatherer.on_sample(sample("a", 1), kStart);
  announce({"b"});
  gatherer.on_sample(sample("a", 1), kStart);
  EXPECT_EQ(gatherer.counters().unknown, 2u);
  EXPECT_TRUE(gatherer.take(kStart, true).empty());
}

TEST_F(GathererTest, BeyondTheLimitSamplesAreRefusedAndCounted) {
  announce({"a"});
  for (std::uint64_t i = 1; i <= Gatherer::kMaxPending + 3; ++i)
    gatherer.on_sample(sample("a", i), kStart);
  EXPECT_EQ(gatherer.counters().refused, 3u);
  EXPECT_EQ(gatherer.counters().accepted, Gatherer::kMaxPending);
  EXPECT_EQ(gatherer.take(kStart, true).size(), Gatherer::kMaxPending / 4);
  gatherer.on_sample(sample("a", Gatherer::kMaxPending + 4), kStart);
  EXPECT_EQ(gatherer.take(kStart, true).size(), 1u);
}

TEST(Identity, DiffersByEachPartOfABatch) {
  const SampleBatch batch = seconds(0, 3);
  std::set<std::uint64_t> identities{identity_of(batch)};
  const auto add = [&](auto change) {
    SampleBatch changed = batch;
    change(changed);
    EXPECT_TRUE(identities.insert(identity_of(changed)).second);
  };
  add([](SampleBatch& changed) { changed.device = "pres"; });
  add([](SampleBatch& changed) { changed.bus = "line2"; });
  add([](SampleBatch& changed) { changed.epoch = 8; });
  add([](SampleBatch& changed) { changed.samples.pop_back(); });
  add([](SampleBatch& changed) { changed.samples[1].sequence = 9; });
  add([](SampleBatch& changed) { changed.samples[1].channel = 9; });
  EXPECT_EQ(identity_of(seconds(0, 3)), identity_of(batch));
}

TEST_F(GathererTest, AGapIsReportedWithTheBatchThatFollowsIt) {
  announce({"a", "b"});
  gatherer.on_sample(sample("a", 4), kStart);
  gatherer.on_sample(sample("b", 1), kStart);
  EXPECT_TRUE(gatherer.take(kStart, true).at(0).gaps.empty()) << "the first samples have no gap";
  gatherer.on_sample(sample("a", 5), kStart);
  gatherer.on_sample(sample("a", 9), kStart);
  gatherer.on_sample(sample("b", 1, 8), kStart);
  std::vector<Gap> gaps;
  for (const Gathered& gathered : gatherer.take(kStart, true))
    gaps.insert(gaps.end(), gathered.gaps.begin(), gathered.gaps.end());
  EXPECT_THAT(gaps, testing::UnorderedElementsAre(Gap{"line/press/a", {7, 5}, {7, 9}, {}},
                                                  Gap{"line/press/b", {7, 1}, {8, 1}, {}}));
}

TEST_F(GathererTest, TheGapSinceTheLastRunIsReported) {
  gatherer.restore({"line/press/a", {7, 3}});
  announce({"a"});
  gatherer.on_sample(sample("a", 8), kStart);
  EXPECT_THAT(gatherer.take(kStart, true).at(0).gaps,
              testing::ElementsAre(Gap{"line/press/a", {7, 3}, {7, 8}, {}}));
}

TEST(Position, AnEntryOfTheAuditIsKnownOnlyInItsEpoch) {
  const Position known{7, 3};
  EXPECT_TRUE(is_known(known, {.epoch = 7, .number = 2}));
  EXPECT_TRUE(is_known(known, {.epoch = 7, .number = 3}));
  EXPECT_FALSE(is_known(known, {.epoch = 7, .number = 4}));
  EXPECT_FALSE(is_known(known, {.epoch = 8, .number = 1}));
  EXPECT_FALSE(is_known(known, {.epoch = 6, .number = 1})) << "the clock was set back";
}

TEST_F(GathererTest, ADeviceIsAnnouncedWhileItHasAChannel) {
  EXPECT_FALSE(gatherer.has("line", "press"));
  announce({"a", "b"});
  gatherer.on_channel_removed("line", "press", "a");
  EXPECT_TRUE(gatherer.has("line", "press"));
  gatherer.on_channel_removed("line", "press", "b");
  EXPECT_FALSE(gatherer.has("line", "press"));
}

TEST_F(GathererTest, AFetchedBatchHasTheCatalogueButNoPosition) {
  announce({"a", "b"});
  gatherer.on_fetched({"line", "press", 6, {{"b", {.number = {6, 4}}}, {"unknown", {}}}});
  gatherer.on_fetched({"line", "removed", 6, {{"a", {}}}});
  const auto taken = gatherer.take(kStart);
  ASSERT_EQ(taken.size(), 1u);
  const Gathered& late = taken[0];
  EXPECT_TRUE(late.is_late);
  EXPECT_TRUE(late.catalogue);
  EXPECT_TRUE(late.positions.empty());
  EXPECT_EQ(late.batch.epoch, 6u);
  ASSERT_EQ(late.batch.samples.size(), 1u);
  EXPECT_EQ(late.batch.samples[0].channel, 1u);
}

TEST_F(GathererTest, TheCatalogueIsWithTheFirstBatchThatNeedsIt) {
  announce({"a"});
  gatherer.on_sample(sample("a", 5), kStart);
  gatherer.on_fetched({"line", "press", 7, {{"a", {.number = {7, 4}}}}});
  const auto taken = gatherer.take(kStart, true);
  ASSERT_EQ(taken.size(), 2u);
  EXPECT_TRUE(taken[0].is_late && taken[0].catalogue);
  EXPECT_FALSE(taken[1].is_late || taken[1].catalogue);
}

TEST_F(GathererTest, AFetchedSampleIsKeptWhenItsBusIsRemoved) {
  announce({"a"});
  gatherer.on_fetched({"line", "press", 7, {{"a", {.number = {7, 4}}}}});
  gatherer.on_channel_removed("line", "press", "a");
  EXPECT_EQ(gatherer.take(kStart).size(), 1u);
}

TEST_F(GathererTest, ABusIsAnnouncedWhileItHasAChannel) {
  EXPECT_FALSE(gatherer.has_bus("line"));
  announce({"a"});
  EXPECT_TRUE(gatherer.has_bus("line"));
  EXPECT_FALSE(gatherer.has_bus("lin"));
  EXPECT_FALSE(gatherer.has_bus("line2"));
  gatherer.on_channel_removed("line", "press", "a");
  EXPECT_FALSE(gatherer.has_bus("line"));
}

}  // namespace
}  // namespace fieldcast::forward
