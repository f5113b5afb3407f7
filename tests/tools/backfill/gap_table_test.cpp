#include "tools/backfill/gap_table.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace fieldcast {
namespace {

constexpr Instant kBegin{std::chrono::seconds{100}};

HistoryRow row(std::uint32_t channel, std::uint64_t epoch, std::uint64_t sequence) {
  return {.channel = channel,
          .number = {epoch, sequence},
          .acquired_at = {static_cast<std::int64_t>(sequence)},
          .value = 0.5,
          .quality = Quality::kGood};
}

struct GapTableTest : testing::Test {
  GapTable table;
  Instant now = kBegin;

  void add(const std::string& name, SampleNumber after, SampleNumber until) {
    ASSERT_TRUE(table.add({name, after, until, {}}, now));
  }
  std::optional<HistoryRequest> next() { return table.next(now); }
  GapTable::Progress respond(const HistoryRequest& request, std::vector<HistoryRow> rows,
                             std::uint32_t complete) {
    return table.on_response(request, {.complete = complete, .rows = std::move(rows)}, now);
  }
  static std::vector<std::uint64_t> sequences(const GapTable::Progress& progress) {
    std::vector<std::uint64_t> found;
    for (const Fetched& part : progress.fetched)
      for (const auto& [name, row] : part.samples) found.push_back(row.number.sequence);
    return found;
  }
};

TEST_F(GapTableTest, AGapIsRequestedWhenTheBridgeHasStoredIt) {
  add("line/press/a", {7, 3}, {7, 6});
  EXPECT_FALSE(next());
  now += GapTable::kSettle;
  const auto request = next();
  ASSERT_TRUE(request);
  EXPECT_EQ(request->bus, "line");
  ASSERT_EQ(request->channels.size(), 1u);
  EXPECT_EQ(request->channels[0],
            (HistoryRange{"press", "a", {}, SampleNumber{7, 3}, SampleNumber{7, 6}}));
  EXPECT_EQ(request->until.nanoseconds, std::numeric_limits<std::int64_t>::max())
      << "the clock of the bridge may be ahead by any time";
}

TEST_F(GapTableTest, AFilledGapIsClosedAndEachSampleIsAcceptedOnce) {
  add("line/press/a", {7, 3}, {7, 6});
  now += GapTable::kSettle;
  const auto request = next();
  const auto progress = respond(
      *request,
      {row(0, 7, 3), row(0, 7, 4), row(0, 7, 4), row(0, 7, 5), row(0, 7, 6), row(0, 8, 1)}, 1);
  EXPECT_THAT(sequences(progress), testing::ElementsAre(4, 5));
  EXPECT_THAT(progress.changes,
              testing::ElementsAre(GapChange{{"line/press/a", {7, 5}, {7, 6}, {}}, true}));
  EXPECT_EQ(table.size(), 0u);
  EXPECT_TRUE(respond(*request, {row(0, 7, 4)}, 1).fetched.empty()) << "a late second response";
}

TEST_F(GapTableTest, AnIncompleteResponseIsContinuedAfterItsLastRow) {
  add("line/press/a", {7, 3}, {7, 9});
  add("line/press/b", {7, 1}, {7, 3});
  now += GapTable::kSettle;
  const auto progress = respond(*next(), {row(0, 7, 4), row(0, 7, 5)}, 0);
  EXPECT_THAT(progress.changes,
              testing::ElementsAre(GapChange{{"line/press/a", {7, 5}, {7, 9}, {}}, false}));
  const auto further = next();
  ASSERT_TRUE(further);
  EXPECT_EQ(further->channels.size(), 2u);
  EXPECT_EQ(further->channels[0].after, (SampleNumber{7, 5}));
}

TEST_F(GapTableTest, AGapOverARestartOfTheBusContainsBothEpochs) {
  add("line/press/a", {7, 3}, {9, 2});
  now += GapTable::kSettle;
  const auto progress =
      respond(*next(), {row(0, 7, 4), row(0, 8, 1), row(0, 9, 1), row(0, 9, 2)}, 1);
  ASSERT_EQ(progress.fetched.size(), 3u) << "a batch has one epoch";
  EXPECT_EQ(progress.fetched[1].epoch, 8u);
  EXPECT_EQ(table.size(), 0u);
}

TEST_F(GapTableTest, ASampleWithoutAnEpochIsIgnored) {
  add("line/press/a", {7, 3}, {9, 2});
  now += GapTable::kSettle;
  EXPECT_TRUE(respond(*next(), {row(0, 0, 4)}, 1).fetched.empty());
}

TEST_F(GapTableTest, AGapThatTheStoreDoesNotFillIsClosedAfterAWhile) {
  add("line/press/a", {7, 3}, {7, 9});
  now += GapTable::kSettle;
  EXPECT_TRUE(respond(*next(), {}, 1).changes.empty());
  EXPECT_FALSE(next()) << "the bridge may not have stored it yet";
  now += GapTable::kPatience;
  const auto request = next();
  ASSERT_TRUE(request);
  EXPECT_TRUE(respond(*request, {}, 1).changes.at(0).is_closed);
  EXPECT_EQ(table.size(), 0u);
}

TEST_F(GapTableTest, ABusyBridgeIsAskedAgainLater) {
  add("line/press/a", {7, 3}, {7, 9});
  now += GapTable::kSettle;
  const auto request = next();
  (void)table.on_response(*request, {.outcome = HistoryOutcome::kBusy}, now);
  EXPECT_FALSE(next());
  now += GapTable::kRest;
  EXPECT_TRUE(next());
  table.on_failure("line", now);
  now += GapTable::kRest;
  EXPECT_FALSE(next()) << "the rest doubles";
}

TEST_F(GapTableTest, ABridgeWithoutAStoreClosesTheGapWithItsReason) {
  add("line/press/a", {7, 3}, {7, 9});
  now += GapTable::kSettle;
  const auto request = next();
  const auto progress =
      table.on_response(*request, {.outcome = HistoryOutcome::kNoStore, .reason = "no store"}, now);
  EXPECT_EQ(progress.refusal, "no store");
  EXPECT_TRUE(progress.changes.at(0).is_closed);
  EXPECT_EQ(table.size(), 0u);
}

TEST_F(GapTableTest, ARequestHasAtMost128ChannelsOfOneBus) {
  for (int i = 0; i < 300; ++i) add("line/press/" + std::to_string(i), {7, 3}, {7, 9});
  add("other/press/a", {7, 3}, {7, 9});
  now += GapTable::kSettle;
  EXPECT_EQ(next()->channels.size(), HistoryRequest::kMostChannels);
  table.on_failure("line", now);
  EXPECT_EQ(next()->bus, "other");
}

}  // namespace
}  // namespace fieldcast
