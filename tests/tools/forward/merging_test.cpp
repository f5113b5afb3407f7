#include "tools/forward/queue/merging.hpp"

#include <gtest/gtest.h>

#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {
namespace {

Record second(std::uint64_t id) {
  const auto from = static_cast<std::int64_t>(id);
  Record record = record_of(seconds(from, from + 1));
  record.id = id;
  return record;
}

TEST(Merging, RecordsOfADeviceBecomeOne) {
  Merging merging(10'000, 100);
  for (std::uint64_t id = 1; id <= 3; ++id) merging.add(second(id), true);
  const auto result = merging.take();
  ASSERT_EQ(result.records.size(), 1u);
  EXPECT_EQ(result.records[0].id, 1u);
  EXPECT_EQ(result.records[0].samples, 3u);
  EXPECT_EQ(decode_samples(result.records[0].body)->samples, seconds(1, 4).samples);
  EXPECT_EQ(result.records[0].identity, identity_of(seconds(1, 4)));
  EXPECT_EQ(result.merged, std::set<std::uint64_t>{1});
  EXPECT_EQ(result.removed, (std::vector<std::uint64_t>{2, 3}));
}

TEST(Merging, SamplesAreSortedByChannelAndThenInTheirOrder) {
  Merging merging(10'000, 100);
  SampleBatch first = seconds(1, 2), second = seconds(2, 3);
  first.samples.push_back({1, 1, {1}, Value{1.0}});
  second.samples.push_back({1, 2, {2}, Value{2.0}});
  Record a = record_of(first), b = record_of(second);
  a.id = 1;
  b.id = 2;
  merging.add(a, true);
  merging.add(b, true);
  const auto merged = decode_samples(merging.take().records.at(0).body);
  ASSERT_TRUE(merged);
  ASSERT_EQ(merged->samples.size(), 4u);
  EXPECT_EQ(merged->samples[0].sequence, first.samples[0].sequence);
  EXPECT_EQ(merged->samples[1].sequence, second.samples[0].sequence);
  EXPECT_EQ(merged->samples[3], second.samples[1]);
}

TEST(Merging, ARecordThatWasSentStaysAndSeparatesTheOthers) {
  Merging merging(10'000, 100);
  merging.add(second(1), true);
  merging.add(second(2), false);
  merging.add(second(3), true);
  merging.add(second(4), true);
  const auto result = merging.take();
  ASSERT_EQ(result.records.size(), 3u);
  EXPECT_EQ(result.records[1].body, second(2).body);
  EXPECT_EQ(result.merged, std::set<std::uint64_t>{3});
  EXPECT_EQ(result.removed, std::vector<std::uint64_t>{4});
}

TEST(Merging, EpochCatalogueDeviceAndLimitsSeparate) {
  Merging merging(10'000, 2);
  SampleBatch other_epoch = seconds(2, 3), other_catalogue = seconds(3, 4);
  other_epoch.epoch = 8;
  other_catalogue.catalogue = 5;
  Record record = second(4);
  record.device = "oven";
  merging.add(second(1), true);
  std::uint64_t id = 2;
  for (const SampleBatch& batch : {other_epoch, other_catalogue}) {
    Record each = record_of(batch);
    each.id = id++;
    merging.add(each, true);
  }
  merging.add(record, true);
  EXPECT_TRUE(merging.take().removed.empty());

  for (std::uint64_t each = 1; each <= 5; ++each) merging.add(second(each), true);
  EXPECT_EQ(merging.take().records.size(), 3u) << "two samples each";

  Merging small(second(1).body.size() * 2 - 1, 100);
  small.add(second(1), true);
  small.add(second(2), true);
  EXPECT_TRUE(small.take().removed.empty());
}

TEST(Merging, AlarmsAndCataloguesStay) {
  Merging merging(10'000, 100);
  merging.add(second(1), true);
  merging.add({.id = 2, .kind = RecordKind::kAlarm, .bus = "line", .device = "press"}, true);
  merging.add(second(3), true);
  const auto result = merging.take();
  ASSERT_EQ(result.records.size(), 2u);
  EXPECT_EQ(result.records[1].kind, RecordKind::kAlarm);
  EXPECT_EQ(result.removed, std::vector<std::uint64_t>{3});
}

}  // namespace
}  // namespace fieldcast::forward
