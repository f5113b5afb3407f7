#include "bridge/store/tiers/sample_days.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/store/retention.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/store_support.hpp"

namespace fieldcast {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kHour = 3600;
constexpr UtcTime kMidnight{1'700'006'400'000'000'000};  // 2023-11-15
UtcTime after_midnight(std::int64_t second) {
  return {kMidnight.nanoseconds + second * 1'000'000'000};
}
UtcTime day(std::int64_t number) { return after_midnight(number * 24 * kHour); }

class Days {
 public:
  explicit Days(const StoreAddress& address)
      : address_(address), connection_(open_store(address, IfMissing::kCreate)) {
    for (const UtcTime each : SampleDays(*connection_).all())
      EXPECT_TRUE(SampleDays(*connection_).drop(each));
    connection_->script("delete from samples; delete from tiers; delete from open_buckets");
    channel_ = SampleTable(*connection_).channel_id("line", "press", "t", "", "float64");
  }
  SqlConnection& operator*() { return *connection_; }
  std::vector<UtcTime> all() { return SampleDays(*connection_).all(); }
  std::int64_t channel() const { return channel_; }

  void insert(std::vector<UtcTime> times) {
    std::vector<SampleRow> rows;
    for (const UtcTime at : times)
      rows.push_back({.channel = channel_, .published_at = at, .sequence = 1, .value = 1.0});
    SqlTransaction transaction(*connection_);
    SampleTable(*connection_).insert(rows);
    transaction.commit();
  }
  void insert_undated(UtcTime at) {
    connection_->execute(
        "insert into samples (channel, published_at, sequence, acquired_at, quality, device_code, "
        "value_kind, real_value) values ($1, $2, 1, 0, 0, 0, 3, 5.0)",
        SqlRow{channel_, at.nanoseconds});
  }
  std::vector<UtcTime> times() {
    std::vector<UtcTime> found;
    for (const StoredSample& sample : test::history(address_, "line"))
      found.push_back(sample.published_at);
    return found;
  }
  void tidy(const StoreSpec& spec, UtcTime now) {
    Retention retention(spec);
    for (int steps = 0; retention.step(*connection_, Instant{}, now);) ASSERT_LT(++steps, 1000);
  }

 private:
  const StoreAddress address_;
  const std::unique_ptr<SqlConnection> connection_;
  std::int64_t channel_ = 0;
};

void hold_their_samples(const StoreAddress& address) {
  Days days(address);
  const std::vector<UtcTime> times{
      day(0), after_midnight(1), {day(1).nanoseconds - 1}, day(1), day(40)};
  days.insert({times[3], times[0], times[4], times[1], times[2], times[0]});
  EXPECT_THAT(days.all(), ElementsAre(day(0), day(1), day(40)));
  EXPECT_EQ(days.times(), times) << "one that is there already stays as it is";
  EXPECT_GT(SampleDays(*days).bytes(), 0u);
  std::int64_t rows = 0;
  (*days).query("select count(*) from samples_20231115", {}, [&](const SqlRow& row) {
    rows = integer_at(row, 0);
    return true;
  });
  EXPECT_EQ(rows, 3);
}

void go_as_a_whole(const StoreAddress& address) {
  Days days(address);
  days.insert({day(0), day(1), after_midnight(30 * kHour), day(2), day(3)});
  StoreSpec spec;
  spec.keep = 2 * SampleDays::kDay;
  days.tidy(spec, after_midnight(3 * 24 * kHour + 3 * kHour));
  EXPECT_THAT(days.all(), ElementsAre(day(1), day(2), day(3)));
  EXPECT_EQ(days.times().size(), 4u) << "a day goes when all of it is too old";
  days.tidy(spec, day(4));
  EXPECT_THAT(days.times(), ElementsAre(day(2), day(3)));
}

void stay_while_their_minutes_are_not_written(const StoreAddress& address) {
  Days days(address);
  days.insert({day(0), day(1)});
  const BucketKey open[] = {{days.channel(), day(0)}};
  TierTable(*days).note(kTiers[0], open);
  StoreSpec spec;
  spec.keep = 2 * SampleDays::kDay;
  days.tidy(spec, day(10));
  EXPECT_THAT(days.all(), ElementsAre(day(0), day(1)));
  TierTable(*days).forget(kTiers[0], open);
  days.tidy(spec, day(10));
  EXPECT_THAT(days.all(), IsEmpty());
}

void wait_for_who_reads_them(const StoreAddress& address) {
  Days days(address);
  days.insert({day(0)});
  const auto reader = open_store(address, IfMissing::kFail);
  SqlTransaction reading(*reader);
  reader->query("select count(*) from samples", {}, [](const SqlRow&) { return true; });
  EXPECT_FALSE(SampleDays(*days).drop(day(0)));
  EXPECT_EQ(days.times().size(), 1u) << "the connection goes on";
  days.insert({day(1)});
  reading.commit();
  EXPECT_TRUE(SampleDays(*days).drop(day(0)));
  EXPECT_THAT(days.times(), ElementsAre(day(1)));
}

void go_until_the_rest_is_small_enough(const StoreAddress& address) {
  Days days(address);
  std::vector<UtcTime> times;
  for (std::int64_t number = 0; number < 5; ++number) {
    for (std::int64_t i = 0; i < 1000; ++i) times.push_back(after_midnight(number * 86'400 + i));
  }
  days.insert(times);
  StoreSpec spec;
  spec.keep = {};
  spec.max_bytes = SampleDays(*days).bytes() / 2;
  days.tidy(spec, after_midnight(4 * 86'400 + 2000));
  EXPECT_THAT(days.all(), ElementsAre(day(3), day(4)));
  spec.max_bytes = 1;
  days.tidy(spec, after_midnight(4 * 86'400 + 2000));
  EXPECT_THAT(days.all(), ElementsAre(day(4))) << "the present one stays";
}

void are_read_and_removed_beside_older_samples(const StoreAddress& address) {
  Days days(address);
  days.insert_undated(day(0));
  days.insert_undated(day(1));
  days.insert({after_midnight(24 * kHour + 1), day(2)});
  EXPECT_TRUE(SampleDays(*days).has_undated());
  EXPECT_THAT(days.times(), ElementsAre(day(0), day(1), after_midnight(24 * kHour + 1), day(2)));
  StoreSpec spec;
  spec.keep = 2 * SampleDays::kDay;
  days.tidy(spec, day(3));
  EXPECT_THAT(days.times(), ElementsAre(day(1), after_midnight(24 * kHour + 1), day(2)));
  days.tidy(spec, day(4));
  EXPECT_FALSE(SampleDays(*days).has_undated());
  EXPECT_THAT(days.times(), ElementsAre(day(2)));
}

TEST(SampleDays, OfAServerHoldItsSamplesAndGoAsAWhole) {
  test::with_postgres([](test::PostgresServer& server) {
    const std::pair<const char*, void (*)(const StoreAddress&)> all[] = {
        {"hold", hold_their_samples},
        {"go", go_as_a_whole},
        {"stay", stay_while_their_minutes_are_not_written},
        {"wait", wait_for_who_reads_them},
        {"size", go_until_the_rest_is_small_enough},
        {"older", are_read_and_removed_beside_older_samples}};
    for (const auto& [name, check] : all) {
      SCOPED_TRACE(name);
      check(server.address());
    }
  });
}

}  // namespace
}  // namespace fieldcast
