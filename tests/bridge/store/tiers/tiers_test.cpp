#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <thread>

#include "bridge/store/retention.hpp"
#include "bridge/store/store.hpp"
#include "bridge/store/tiers/tier_writer.hpp"
#include "tests/bridge/store/older_store.hpp"
#include "tests/bridge/store/postgres_server.hpp"
#include "tests/bridge/store/scratch.hpp"
#include "tests/bridge/store/tiers/times.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::at_second;
using testing::ElementsAre;
using testing::IsEmpty;

const Tier& kMinute = kTiers[0];
const Tier& kHour = kTiers[1];

std::vector<Bucket> rows(SqlConnection& connection, const Tier& tier, std::int64_t channel) {
  std::vector<Bucket> found;
  TierTable(connection).read(tier, channel, {}, kEndOfTime, [&](const Bucket& bucket) {
    found.push_back(bucket);
    return true;
  });
  return found;
}

// A store without threads: the work of its writer, in virtual time.
class Recorder {
 public:
  explicit Recorder(const StoreAddress& address)
      : connection_(open_store(address, IfMissing::kCreate)) {}

  SqlConnection& connection() { return *connection_; }
  std::int64_t channel(const std::string& name, const std::string& type = "float64") {
    return SampleTable(*connection_).channel_id("line", "press", name, "", type);
  }
  void store(const std::vector<SampleRow>& samples) {
    SqlTransaction transaction(*connection_);
    SampleTable(*connection_).insert(samples);
    tiers_.note(*connection_, samples);
    transaction.commit();
  }
  void store(std::int64_t channel, std::int64_t second, Value value,
             Quality quality = Quality::kGood) {
    const bool is_text = std::holds_alternative<std::string>(value);
    store({SampleRow{.channel = channel,
                     .published_at = at_second(second),
                     .sequence = ++sequence_,
                     .quality = quality,
                     .value = std::move(value),
                     .is_text = is_text}});
  }
  int write_tiers(UtcTime now) {
    int steps = 0;
    while (tiers_.step(*connection_, now)) {
      if (++steps > 10'000) ADD_FAILURE() << "it does not end";
      if (steps > 10'000) break;
    }
    return steps;
  }
  void restart() { tiers_ = TierWriter(); }

 private:
  std::unique_ptr<SqlConnection> connection_;
  TierWriter tiers_;
  std::uint64_t sequence_ = 0;
};

void writes_a_minute_when_it_is_closed(const StoreAddress& address) {
  Recorder recorder(address);
  const std::int64_t channel = recorder.channel("closed");
  recorder.store(channel, 1, 3.0);
  recorder.store(channel, 30, std::int64_t{-1});
  recorder.store(channel, 59, 4.0, Quality::kBadNoResponse);
  recorder.write_tiers(at_second(64));
  EXPECT_THAT(rows(recorder.connection(), kMinute, channel), IsEmpty());
  recorder.write_tiers(at_second(65));
  const Bucket minute{channel, at_second(0), 2, 1, -1, 3, 2, 3, -1};
  EXPECT_THAT(rows(recorder.connection(), kMinute, channel), ElementsAre(minute));
  EXPECT_THAT(rows(recorder.connection(), kHour, channel), IsEmpty());
  recorder.write_tiers(at_second(3605));
  EXPECT_THAT(rows(recorder.connection(), kHour, channel), ElementsAre(minute));
}

void makes_the_row_of_a_late_sample_anew(const StoreAddress& address) {
  Recorder recorder(address);
  const std::int64_t channel = recorder.channel("late");
  recorder.store(channel, 10, 1.0);
  recorder.write_tiers(at_second(4000));
  recorder.store(channel, 5, 9.0);
  recorder.restart();
  recorder.write_tiers(at_second(4001));
  const Bucket both{channel, at_second(0), 2, 0, 1, 9, 10, 9, 1};
  EXPECT_THAT(rows(recorder.connection(), kMinute, channel), ElementsAre(both));
  EXPECT_THAT(rows(recorder.connection(), kHour, channel), ElementsAre(both));
}

void has_none_for_texts_and_no_numbers_for_bad_samples(const StoreAddress& address) {
  Recorder recorder(address);
  const std::int64_t text = recorder.channel("text", "string");
  const std::int64_t bad = recorder.channel("bad");
  recorder.store({SampleRow{.channel = text, .published_at = at_second(0), .is_text = true}});
  recorder.store(text, 1, std::string("run"));
  recorder.store(bad, 1, 5.0, Quality::kNotYetRead);
  recorder.write_tiers(at_second(4000));
  EXPECT_THAT(rows(recorder.connection(), kMinute, text), IsEmpty());
  EXPECT_THAT(rows(recorder.connection(), kMinute, bad),
              ElementsAre(Bucket{.channel = bad, .start = at_second(0), .bad = 1}));
}

void agrees_with_a_count_of_all_samples(const StoreAddress& address) {
  Recorder recorder(address);
  const std::int64_t channels[] = {recorder.channel("random-1"), recorder.channel("random-2")};
  std::mt19937 random(11);
  std::vector<SampleRow> all, batch;
  std::int64_t now = 0;
  for (std::uint64_t number = 1; number <= 3000; ++number) {
    now += static_cast<std::int64_t>(random() % 9);
    const std::int64_t late = random() % 10 == 0 ? static_cast<std::int64_t>(random() % 5000) : 0;
    batch.push_back({.channel = channels[random() % 2],
                     .published_at = at_second(std::max<std::int64_t>(now - late, 0)),
                     .sequence = number,
                     .quality = random() % 8 == 0 ? Quality::kBadFrame : Quality::kGood,
                     .value = static_cast<double>(random() % 100)});
    all.push_back(batch.back());
    if (random() % 20 != 0) continue;
    recorder.store(batch);
    batch.clear();
    if (random() % 3 == 0) recorder.write_tiers(at_second(now));
    if (random() % 30 == 0) recorder.restart();
  }
  recorder.store(batch);
  recorder.write_tiers(at_second(now + 7200));
  std::ranges::stable_sort(all, {}, &SampleRow::published_at);
  for (const Tier& tier : kTiers) {
    for (const std::int64_t channel : channels) {
      std::map<UtcTime, Bucket> wanted;
      for (const SampleRow& sample : all) {
        if (sample.channel != channel) continue;
        const UtcTime start = bucket_start(sample.published_at, tier.width);
        wanted.try_emplace(start, Bucket{.channel = channel, .start = start})
            .first->second.add(sample.quality, sample.value);
      }
      const auto found = rows(recorder.connection(), tier, channel);
      ASSERT_EQ(found.size(), wanted.size()) << tier.name;
      for (const Bucket& bucket : found) EXPECT_EQ(bucket, wanted.at(bucket.start)) << tier.name;
    }
  }
}

void keeps_each_tier_as_long_as_it_is_said(const StoreAddress& address) {
  Recorder recorder(address);
  const std::int64_t channel = recorder.channel("kept");
  for (int hour = 0; hour < 10; ++hour) recorder.store(channel, hour * 3600 + 5, 1.0);
  StoreSpec spec;
  spec.keep = 1h;
  spec.keep_minutes = 3h;
  spec.keep_hours = 5h;
  Retention retention(spec);
  const auto left = [&] {
    std::size_t samples = 0;
    SampleTable(recorder.connection()).numbers(channel, {}, kEndOfTime, 1000, [&](auto&&...) {
      return ++samples > 0;
    });
    return std::vector<std::size_t>{samples, rows(recorder.connection(), kMinute, channel).size(),
                                    rows(recorder.connection(), kHour, channel).size()};
  };
  Instant now{};
  const auto tidy = [&] {
    for (now += 1h; retention.step(recorder.connection(), now, at_second(10 * 3600));) {}
  };
  tidy();
  EXPECT_THAT(left(), ElementsAre(10, 0, 0)) << "samples stay until their tiers are written";
  recorder.write_tiers(at_second(10 * 3600));
  tidy();
  EXPECT_THAT(left(), ElementsAre(1, 3, 4)) << "the last hour is not closed yet";
  const auto hours = rows(recorder.connection(), kHour, channel);
  recorder.store(channel, 8 * 3600 + 6, 100.0);
  recorder.write_tiers(at_second(10 * 3600 + 1));
  EXPECT_EQ(rows(recorder.connection(), kHour, channel), hours)
      << "what comes for a minute whose samples are gone does not take its row away";
}

// Version 4 had no tiers. They are created for its samples in parts.
void an_older_store_gets_its_tiers(const StoreAddress& address) {
  constexpr std::int64_t kMany = 2 * TierWriter::kSamplesAtOnce + 100;
  std::int64_t channel = 0, dense = 0, text = 0;
  {
    Recorder recorder(address);
    channel = recorder.channel("old");
    dense = recorder.channel("old-dense");
    text = recorder.channel("old-text", "string");
    std::vector<SampleRow> samples;
    for (std::int64_t i = 0; i < kMany; ++i) {
      const auto sequence = static_cast<std::uint64_t>(i);
      samples.push_back({.channel = channel,
                         .published_at = at_second(i),
                         .sequence = sequence,
                         .quality = Quality::kGood,
                         .value = static_cast<double>(i)});
      samples.push_back({.channel = dense,
                         .published_at = {at_second(0).nanoseconds + i},
                         .sequence = sequence,
                         .quality = Quality::kGood,
                         .value = 1.0});
    }
    samples.push_back({.channel = text, .published_at = at_second(0), .value = std::string("x")});
    SqlTransaction transaction(recorder.connection());
    SampleTable(recorder.connection()).insert(samples);
    transaction.commit();
    test::back_to_version(recorder.connection(), 4);
  }
  Recorder recorder(address);
  recorder.store(channel, kMany, 0.0);  // the bridge continues meanwhile
  const UtcTime now = at_second(kMany + 1);
  EXPECT_TRUE(TierTable(recorder.connection()).is_untiered(channel));
  EXPECT_GE(recorder.write_tiers(now), 5) << "in pieces";
  EXPECT_FALSE(TierTable(recorder.connection()).is_untiered(channel));
  EXPECT_THAT(rows(recorder.connection(), kMinute, text), IsEmpty());
  const auto minutes = rows(recorder.connection(), kMinute, channel);
  ASSERT_EQ(minutes.size(), static_cast<std::size_t>((kMany - 4) / 60)) << "those that are closed";
  for (std::size_t i = 0; i < minutes.size(); ++i) {
    EXPECT_EQ(minutes[i].count, 60u);
    EXPECT_EQ(minutes[i].first, static_cast<double>(60 * i));
  }
  EXPECT_EQ(rows(recorder.connection(), kHour, channel).size(),
            static_cast<std::size_t>((kMany - 4) / 3600));
  ASSERT_EQ(rows(recorder.connection(), kMinute, dense).size(), 1u);
  EXPECT_EQ(rows(recorder.connection(), kMinute, dense)[0].count,
            static_cast<std::uint64_t>(kMany));
  recorder.write_tiers(at_second(kMany + 3600));
  const auto last = rows(recorder.connection(), kMinute, channel).back();
  EXPECT_EQ(last.count, static_cast<std::uint64_t>(kMany % 60 + 1)) << "old and new samples";
}

void comes_with_the_store(const StoreAddress& address) {
  BusSpec bus;
  bus.name = "threaded";
  bus.devices.resize(1);
  bus.devices[0].name = "d";
  bus.devices[0].channels.resize(2);
  bus.devices[0].channels[0].name = "number";
  bus.devices[0].channels[1].name = "text";
  bus.devices[0].channels[1].encoding.type = ValueType::kString;
  StoreSpec spec{address.text()};
  spec.keep = spec.keep_minutes = spec.keep_hours = {};
  Store store(spec);
  const auto intake = store.intake(bus);
  const UtcMapping clock{Instant{}, at_second(0)};
  for (int second = 0; second < 3600; second += 10) {
    const Sample both[] = {{.channel = 0, .value = 1.0 * second, .quality = Quality::kGood},
                           {.channel = 1, .value = {}, .quality = Quality::kNotYetRead}};
    intake->put(both, clock, at_second(second));
  }
  ASSERT_TRUE(store.flush(30s));
  const auto connection = open_store(address, IfMissing::kFail);
  const auto seen = [&] {
    std::vector<std::string> found;
    connection->query(
        "select channel, count, min, average, max, start_ns from hour_history "
        "where bus = 'threaded'",
        {}, [&](const SqlRow& row) {
          found.push_back(text_at(row, 0));
          EXPECT_EQ(integer_at(row, 1), 360);
          EXPECT_EQ(std::get<double>(row[2]), 0.0);
          EXPECT_EQ(std::get<double>(row[3]), 1795.0);
          EXPECT_EQ(std::get<double>(row[4]), 3590.0);
          EXPECT_EQ(integer_at(row, 5), at_second(0).nanoseconds);
          return true;
        });
    return found;
  };
  for (const auto end = std::chrono::steady_clock::now() + 30s;
       seen().empty() && std::chrono::steady_clock::now() < end;)
    std::this_thread::sleep_for(20ms);
  EXPECT_THAT(seen(), ElementsAre("number"));
}

void all_of_it(const StoreAddress& address) {
  const std::pair<const char*, void (*)(const StoreAddress&)> all[] = {
      {"closed", writes_a_minute_when_it_is_closed},
      {"late", makes_the_row_of_a_late_sample_anew},
      {"texts", has_none_for_texts_and_no_numbers_for_bad_samples},
      {"all samples", agrees_with_a_count_of_all_samples},
      {"the store", comes_with_the_store},
      {"retention", keeps_each_tier_as_long_as_it_is_said},
      {"older", an_older_store_gets_its_tiers}};
  for (const auto& [name, check] : all) {
    SCOPED_TRACE(name);
    check(address);
  }
}

TEST(Tiers, OfSqliteAreThoseOfItsSamples) {
  const test::Scratch scratch;
  all_of_it(StoreAddress(scratch.path("store.db")));
}

TEST(Tiers, OfPostgresAreThoseOfItsSamples) {
  test::with_postgres([](test::PostgresServer& server) { all_of_it(server.address()); });
}

}  // namespace
}  // namespace fieldcast
