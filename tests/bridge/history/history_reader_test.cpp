#include "bridge/history/history_reader.hpp"

#include <gmock/gmock.h>

#include "bridge/store/store.hpp"
#include "tests/bridge/store/older_store.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast::test {
namespace {

using std::chrono::seconds;
using Numbers = std::vector<SampleNumber>;

std::uint64_t epoch(std::int64_t second) {
  return static_cast<std::uint64_t>(utc(second).nanoseconds);
}

// Channels a and b of bus "h": two samples of an older version, 1 to 5 from second 100, then a
// restart, and 1 to 3 from second 200.
void fill(const StoreAddress& address) {
  Store store(forever(address));
  const auto intake = store.intake(bus_of("h", {"a", "b"}));
  const auto put = [&](std::int64_t second, std::uint64_t sequence) {
    const Sample both[] = {sample(0, 0.5, second, sequence),
                           sample(1, std::string("text"), second, sequence)};
    intake->put(both, kClock, utc(second));
  };
  for (std::uint64_t i = 1; i <= 2; ++i) put(static_cast<std::int64_t>(i), i);
  store.put(BusEpoch{"h", epoch(100)});
  store.put(BusEpoch{"other", epoch(102)});
  for (std::uint64_t i = 1; i <= 5; ++i) put(100 + static_cast<std::int64_t>(i), i);
  store.put(BusEpoch{"h", epoch(200)});
  for (std::uint64_t i = 1; i <= 3; ++i) put(200 + static_cast<std::int64_t>(i), i);
  ASSERT_TRUE(store.flush(seconds{30}));
}

HistoryRequest request(std::vector<HistoryRange> channels, std::uint32_t rows = 1024) {
  return {
      .requester = "r", .bus = "h", .until = kEnd, .rows = rows, .channels = std::move(channels)};
}

Numbers numbers(const HistoryResponse& response) {
  Numbers found;
  for (const HistoryRow& row : response.rows) found.push_back(row.number);
  return found;
}

void reads_ranges(const StoreAddress& address) {
  fill(address);
  const auto connection = open_store(address, IfMissing::kFail);
  make_read_only(*connection);
  HistoryReader reader(*connection);
  const auto read = [&](const HistoryRange& range) {
    const auto response = reader.read(request({range}), utc(300));
    EXPECT_EQ(response.complete, 1u);
    return numbers(response);
  };
  const std::uint64_t first = epoch(100), second = epoch(200);
  EXPECT_EQ(read({.device = "d", .channel = "a"}), (Numbers{{0, 1},
                                                            {0, 2},
                                                            {first, 1},
                                                            {first, 2},
                                                            {first, 3},
                                                            {first, 4},
                                                            {first, 5},
                                                            {second, 1},
                                                            {second, 2},
                                                            {second, 3}}));
  EXPECT_EQ(read({.device = "d", .channel = "a", .after = {first, 3}, .until = {second, 2}}),
            (Numbers{{first, 4}, {first, 5}, {second, 1}}));
  EXPECT_EQ(read({.device = "d", .channel = "a", .after = {first, 1}, .until = {first, 4}}),
            (Numbers{{first, 2}, {first, 3}}));
  EXPECT_EQ(read({.device = "d", .channel = "a", .after = {epoch(150), 9}}),
            (Numbers{{second, 1}, {second, 2}, {second, 3}}))
      << "an epoch that was not stored";
  EXPECT_EQ(read({.device = "d", .channel = "a", .since = utc(202), .after = {0, 2}}),
            (Numbers{{second, 3}}))
      << "after the sample at this time";
  EXPECT_EQ(read({.device = "d", .channel = "unknown"}), Numbers{});
  auto limited = request({{.device = "d", .channel = "a"}});
  limited.until = utc(101);
  EXPECT_EQ(numbers(reader.read(limited, utc(300))), (Numbers{{0, 1}, {0, 2}}));

  std::vector<HistoryRange> both{{.device = "d", .channel = "a", .after = {first, 3}},
                                 {.device = "d", .channel = "b"}};
  const auto part = reader.read(request(both, 7), utc(300));
  EXPECT_EQ(part.complete, 1u);
  ASSERT_EQ(part.rows.size(), 7u);
  EXPECT_EQ(part.rows.back().channel, 1u);
  EXPECT_EQ(part.rows.back().value, Value{std::string("text")});
  EXPECT_EQ(part.rows.back().published_at, utc(2));
  EXPECT_EQ(part.rows.back().acquired_at, utc(2));
  EXPECT_EQ(part.rows.back().quality, Quality::kGood);
  const auto exact = reader.read(request({both[0]}, 5), utc(300));
  EXPECT_EQ(exact.complete, 1u) << "all rows fit exactly";
}

void an_older_store_has_no_epochs(const StoreAddress& address) {
  {
    const auto connection = open_store(address, IfMissing::kCreate);
    back_to_version(*connection, 8);
  }
  fill(address);
}

TEST(HistoryReader, ReadsRangesFromSqlite) {
  const Scratch scratch;
  an_older_store_has_no_epochs(StoreAddress(scratch.path("upgraded.db")));
  reads_ranges(StoreAddress(scratch.path("history.db")));
}

TEST(HistoryReader, ReadsRangesFromPostgres) {
  with_postgres([](PostgresServer& server) { reads_ranges(server.address()); });
}

// The sample after which a range begins is found from the end, so that a long epoch is not read.
TEST(HistoryReader, FindsTheBeginOfARangeInALongEpoch) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("long.db"));
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("h", {"a"}));
    store.put(BusEpoch{"h", epoch(0)});
    for (std::uint64_t i = 1; i <= 20'000; ++i) {
      const Sample one[] = {sample(0, 0.5, static_cast<std::int64_t>(i), i)};
      intake->put(one, kClock, utc(static_cast<std::int64_t>(i)));
    }
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  const auto connection = open_store(address, IfMissing::kFail);
  for (const std::uint64_t after : {19'990u, 19'000u, 10u, 0u}) {
    const HistoryRange range{
        .device = "d", .channel = "a", .after = {epoch(0), after}, .until = {epoch(0), after + 4}};
    EXPECT_EQ(numbers(HistoryReader(*connection).read(request({range}), utc(20'001))),
              (Numbers{{epoch(0), after + 1}, {epoch(0), after + 2}, {epoch(0), after + 3}}));
  }
}

// The first samples after the step have earlier times than the last ones before it.
TEST(HistoryReader, FindsTheSamplesAfterAStepOfTheClock) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("step.db"));
  constexpr std::uint64_t kBefore = 20'000, kAfter = 500;
  constexpr std::int64_t kStep = 600, kNow = kBefore - kStep + kAfter;
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("h", {"a"}));
    store.put(BusEpoch{"h", epoch(0)});
    for (std::uint64_t i = 1; i <= kBefore + kAfter; ++i) {
      const auto second = static_cast<std::int64_t>(i) - (i > kBefore ? kStep : 0);
      const Sample one[] = {sample(0, 0.5, second, i)};
      intake->put(one, kClock, utc(second));
    }
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  const auto connection = open_store(address, IfMissing::kFail);
  const HistoryRange range{.device = "d",
                           .channel = "a",
                           .after = {epoch(0), kBefore},
                           .until = {epoch(0), kBefore + kAfter}};
  const auto found =
      numbers(HistoryReader(*connection).read(request({range}, 2 * kAfter), utc(kNow)));
  ASSERT_EQ(found.size(), kAfter - 1);
  EXPECT_EQ(found.front(), (SampleNumber{epoch(0), kBefore + 1}));
  EXPECT_EQ(found.back(), (SampleNumber{epoch(0), kBefore + kAfter - 1}));
}

TEST(HistoryReader, LongTextsEndAResponseEarlier) {
  const Scratch scratch;
  const StoreAddress address(scratch.path("texts.db"));
  {
    Store store(forever(address));
    const auto intake = store.intake(bus_of("h", {"a"}));
    for (std::uint64_t i = 1; i <= 1000; ++i) {
      const Sample one[] = {sample(0, std::string(256, 'x'), static_cast<std::int64_t>(i), i)};
      intake->put(one, kClock, utc(static_cast<std::int64_t>(i)));
    }
    ASSERT_TRUE(store.flush(seconds{30}));
  }
  const auto connection = open_store(address, IfMissing::kFail);
  const auto response =
      HistoryReader(*connection).read(request({{.device = "d", .channel = "a"}}), utc(2000));
  EXPECT_EQ(response.complete, 0u);
  EXPECT_LE(response.rows.size() * 304, HistoryReader::kMostBytes);
  EXPECT_GT(response.rows.size(), 300u);
}

}  // namespace
}  // namespace fieldcast::test
