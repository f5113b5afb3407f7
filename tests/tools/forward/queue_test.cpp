#include "tools/forward/queue/queue.hpp"

#include <gmock/gmock.h>

#include <filesystem>

#include "tests/support/full_disk.hpp"
#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {
namespace {

using testing::ElementsAre;

constexpr UtcTime kNow{1'000'000'000'000};

struct QueueTest : testing::Test {
  Folder folder;
  std::string path = folder.file("queue.db");

  Queue open(std::uint64_t max_bytes = 10'000'000, Duration keep = {}) {
    return Queue({path, max_bytes, keep});
  }
  // `sent`: as a record that was sent soon.
  static void append(Queue& queue, const Record& record, UtcTime now = kNow, bool sent = true) {
    queue.set_sending(sent);
    queue.append(std::span(&record, 1), {}, now);
  }
  static void append_seconds(Queue& queue, std::int64_t from, std::int64_t to, bool sent = false) {
    for (std::int64_t i = from; i < to; ++i)
      append(queue, record_of(seconds(i, i + 1)), kNow, sent);
  }
  // Without a change.
  static std::vector<Record> all(Queue& queue, std::uint64_t after = 0) {
    return queue.read({after, queue.last(), queue.last()}).records;
  }
  static std::vector<std::uint64_t> ids(Queue& queue) {
    std::vector<std::uint64_t> found;
    for (const Record& record : all(queue)) found.push_back(record.id);
    return found;
  }
  static std::uint64_t samples(Queue& queue) {
    std::uint64_t count = 0;
    for (const Record& record : all(queue)) count += record.samples;
    return count;
  }
  static Record catalogue_record() {
    return {.kind = RecordKind::kCatalogue,
            .bus = "line",
            .device = "press",
            .identity = identity_of(catalogue({"a"})),
            .body = encode("north", catalogue({"a"}))};
  }
  static Record audit_record() {
    return {.kind = RecordKind::kAudit,
            .bus = "plant",
            .epoch = 7,
            .identity = identity_of(audit()),
            .body = encode("north", audit())};
  }
  static Record alarm_record() {
    return {.kind = RecordKind::kAlarm,
            .bus = "line",
            .device = "press",
            .identity = identity_of(alarm()),
            .body = encode("north", alarm())};
  }
};

TEST_F(QueueTest, RecordsStayInTheirOrderOverARestart) {
  {
    Queue queue = open();
    append(queue, record_of(seconds(0, 3)));
    append(queue, alarm_record());
  }
  Queue queue = open();
  const auto records = all(queue);
  ASSERT_EQ(records.size(), 2u);
  EXPECT_LT(records[0].id, records[1].id);
  EXPECT_EQ(records[0].bus, "line");
  EXPECT_EQ(records[0].epoch, 7u);
  EXPECT_EQ(records[0].identity, identity_of(seconds(0, 3)));
  EXPECT_EQ(records[0].samples, 3u);
  EXPECT_EQ(records[0].body, encode(seconds(0, 3))) << "bytes of protobuf, also zeros";
  EXPECT_EQ(records[1].kind, RecordKind::kAlarm);
  EXPECT_EQ(queue.counters().records, 2u);
}

TEST_F(QueueTest, OnlyItsOwnerReadsTheFile) {
  Queue queue = open();
  EXPECT_EQ(std::filesystem::status(path).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
}

TEST_F(QueueTest, ReadReturnsARangeInParts) {
  Queue queue = open();
  append_seconds(queue, 0, 5, true);
  EXPECT_EQ(queue.read({2, 4, 5}).records.size(), 2u);
  EXPECT_EQ(queue.read({2, 4, 5}).records[0].id, 3u);
  EXPECT_TRUE(queue.read({5, 9, 9}).records.empty());
  EXPECT_EQ(queue.read({5, 9, 9}).read_to, 9u);
  Record large = alarm_record();
  large.body.resize(3u << 20);
  append(queue, large);
  append(queue, large);
  const auto part = queue.read({5, 7, 7});
  EXPECT_EQ(part.records.size(), 1u);
  EXPECT_EQ(part.read_to, 6u);
}

TEST_F(QueueTest, ARemovedRecordIsNotReadAgain) {
  Queue queue = open();
  for (std::int64_t i = 0; i < 3; ++i) append(queue, record_of(seconds(i, i + 1)));
  queue.remove(std::vector<std::uint64_t>{1, 3, 3, 77});
  EXPECT_THAT(ids(queue), ElementsAre(2u));
  EXPECT_EQ(queue.counters().records, 1u);
  queue.remove(std::vector<std::uint64_t>{2});
  EXPECT_EQ(queue.counters().bytes, 0u);
  append(queue, record_of(seconds(0, 1)));
  EXPECT_THAT(ids(queue), ElementsAre(4u)) << "a number is not used twice";
}

TEST_F(QueueTest, PositionsAndCataloguesStayOverARestart) {
  {
    Queue queue = open();
    const Record record = catalogue_record();
    const NamedPosition first{"line/press/a", {7, 1}}, second{"line/press/a", {7, 2}};
    queue.append(std::span(&record, 1), std::span(&first, 1), kNow);
    queue.append({}, std::span(&second, 1), kNow);
    queue.remove(std::vector<std::uint64_t>{1});
  }
  Queue queue = open();
  ASSERT_EQ(queue.positions().size(), 1u);
  EXPECT_EQ(queue.positions()[0].position, (Position{7, 2}));
  const auto body = queue.catalogue(identity_of(catalogue({"a"})));
  ASSERT_TRUE(body);
  EXPECT_TRUE(decode_catalogue(*body));
  EXPECT_FALSE(queue.catalogue(1));
}

TEST_F(QueueTest, ConnectionsAreCountedOverARestart) {
  {
    Queue queue = open();
    EXPECT_EQ(queue.count_up("outlet connections"), 0u);
    EXPECT_EQ(queue.count_up("outlet connections"), 1u);
    EXPECT_EQ(queue.count_up("other connections"), 0u);
  }
  EXPECT_EQ(open().count_up("outlet connections"), 2u);
}

TEST_F(QueueTest, AFullQueueThinsTheOldestSamplesFirst) {
  Queue queue = open(100'000);
  append(queue, alarm_record());
  for (std::int64_t i = 0; i < 900; ++i) append(queue, record_of(seconds(i, i + 1)));
  const Queue::Counters counters = queue.counters();
  EXPECT_LE(counters.bytes, 100'000u);
  EXPECT_GT(counters.thinned, 0u);
  EXPECT_EQ(counters.dropped_samples, 0u);
  EXPECT_EQ(samples(queue) + counters.thinned, 900u);
  const auto records = all(queue);
  EXPECT_EQ(records.size(), counters.records);
  EXPECT_EQ(records[1].body, encode(seconds(0, 1)));
  EXPECT_EQ(records[2].body, encode(seconds(60, 61))) << "one a minute";
  EXPECT_EQ(records.back().body, encode(seconds(899, 900)));
  EXPECT_EQ(records[records.size() - 2].body, encode(seconds(898, 899))) << "the newest are raw";
}

TEST_F(QueueTest, AThinnedRecordKeepsItsIdentity) {
  Queue queue = open(20'000);
  for (std::int64_t i = 0; i < 200; ++i) append(queue, record_of(seconds(3 * i, 3 * i + 3)));
  const auto records = all(queue);
  EXPECT_EQ(records[0].identity, identity_of(seconds(0, 3)));
  EXPECT_EQ(records[0].samples, 1u);
}

TEST_F(QueueTest, ThenTheOldestSamplesAreDroppedThenAlarmsAndTheAuditLast) {
  Queue queue = open(50'000);
  append(queue, alarm_record());
  append(queue, catalogue_record());
  append(queue, audit_record());
  // One sample a minute: nothing can be thinned out.
  for (std::int64_t i = 0; i < 900; ++i) append(queue, record_of(seconds(60 * i, 60 * i + 1)));
  Queue::Counters counters = queue.counters();
  EXPECT_LE(counters.bytes, 50'000u);
  EXPECT_EQ(counters.thinned, 0u);
  EXPECT_GT(counters.dropped_samples, 0u);
  auto records = all(queue);
  EXPECT_EQ(records[0].kind, RecordKind::kAlarm);
  EXPECT_EQ(records[1].kind, RecordKind::kCatalogue);
  EXPECT_EQ(records.back().body, encode(seconds(60 * 899, 60 * 899 + 1)));
  for (int i = 0; i < 900; ++i) append(queue, alarm_record());
  records = all(queue);
  EXPECT_LE(queue.counters().bytes, 50'000u);
  EXPECT_EQ(records[0].kind, RecordKind::kAudit) << "the audit is dropped last";
  for (std::size_t i = 1; i < records.size(); ++i) EXPECT_EQ(records[i].kind, RecordKind::kAlarm);
  EXPECT_GT(records[1].id, 903u);
  for (int i = 0; i < 900; ++i) append(queue, audit_record());
  for (const Record& record : all(queue)) EXPECT_EQ(record.kind, RecordKind::kAudit);
}

TEST_F(QueueTest, RecordsWhoseThinningFailedAreThinnedLater) {
  { Queue queue = open(); }
  open_sqlite(path, IfMissing::kFail)
      ->script(
          "create trigger full before update of body on records "
          "when (select epoch from positions where name = 'full') = 1 "
          "begin select raise(fail, 'full'); end");
  Queue queue = open(5'000);
  const auto set_full = [&](std::uint64_t full) {
    const NamedPosition position{"full", {full, 0}};
    queue.append({}, std::span(&position, 1), kNow);
  };
  set_full(1);
  const auto append_minutes = [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) append(queue, record_of(seconds(60 * i, 60 * i + 60)));
  };
  EXPECT_THROW(append_minutes(0, 1000), StoreError);
  set_full(0);
  append_minutes(1000, 1001);
  const auto records = all(queue);
  ASSERT_FALSE(records.empty());
  EXPECT_EQ(records[0].id, 1u);
  EXPECT_EQ(records[0].samples, 1u);
}

TEST_F(QueueTest, OldRecordsAreDroppedIfTheirAgeIsBounded) {
  constexpr Duration kHour = std::chrono::hours{1};
  Queue queue = open(10'000'000, kHour);
  append(queue, record_of(seconds(0, 5)), kNow);
  append(queue, record_of(seconds(5, 6)), {kNow.nanoseconds + kHour.count()});
  queue.clean({kNow.nanoseconds + kHour.count()});
  EXPECT_EQ(ids(queue).size(), 2u);
  queue.clean({kNow.nanoseconds + kHour.count() + 1});
  EXPECT_THAT(ids(queue), ElementsAre(2u));
  EXPECT_EQ(queue.counters().dropped_samples, 5u);
}

TEST_F(QueueTest, WithoutALimitOfAgeNothingIsTooOld) {
  Queue queue = open();
  append(queue, record_of(seconds(0, 5)), kNow);
  queue.clean({INT64_MAX});
  EXPECT_EQ(ids(queue).size(), 1u);
}

TEST_F(QueueTest, RecordsThatWereNotSentAreMergedInTheFile) {
  std::uint64_t identity = 0;
  {
    Queue queue = open();
    append_seconds(queue, 0, 10);
    const std::uint64_t before = queue.counters().bytes;
    const auto merged = queue.read({0, queue.last(), 0});
    EXPECT_EQ(merged.read_to, 10u);
    ASSERT_EQ(merged.records.size(), 1u);
    EXPECT_EQ(decode_samples(merged.records[0].body)->samples, seconds(0, 10).samples);
    identity = merged.records[0].identity;
    EXPECT_EQ(queue.counters().records, 1u);
    EXPECT_LT(queue.counters().bytes, before);
    append_seconds(queue, 10, 12);
  }
  Queue queue = open();
  const std::uint64_t after = queue.counters().bytes;
  const auto again = queue.read({0, queue.last(), queue.last()});
  ASSERT_EQ(again.records.size(), 2u) << "the merged record may have been sent";
  EXPECT_EQ(again.records[0].identity, identity);
  EXPECT_EQ(again.records[1].samples, 2u);
  queue.remove(std::vector<std::uint64_t>{again.records[0].id, again.records[1].id});
  EXPECT_EQ(queue.counters().bytes, 0u);
  EXPECT_LT(queue.counters().bytes, after);
}

TEST_F(QueueTest, RecordsThatMayHaveBeenSentAreNotMerged) {
  Queue queue = open();
  append_seconds(queue, 0, 1);
  EXPECT_EQ(queue.read({0, 1, 0}).records.size(), 1u);
  append_seconds(queue, 1, 3, true);
  append_seconds(queue, 3, 6);
  EXPECT_EQ(queue.read({0, queue.last(), queue.last()}).records.size(), 4u)
      << "1, 2, 3, and the rest";
  EXPECT_EQ(queue.counters().records, 4u);
}

TEST_F(QueueTest, RecordsThatWereNeverReadAreMergedAlsoWhileOthersAreSent) {
  Queue queue = open();
  append_seconds(queue, 0, 6, true);
  EXPECT_EQ(queue.read({0, queue.last(), 2}).records.size(), 3u) << "1, 2, and the rest";
}

TEST_F(QueueTest, TheLastRecordBeforeATimeIsFound) {
  Queue queue = open();
  EXPECT_EQ(queue.last_before({100}, 0), 0u);
  for (const std::int64_t at : {10, 20, 30}) {
    const Record record = record_of(seconds(at, at + 1));
    queue.append(std::span(&record, 1), {}, {at});
  }
  EXPECT_EQ(queue.last_before({25}, 0), 2u);
  EXPECT_EQ(queue.last_before({25}, 2), 0u);
  EXPECT_EQ(queue.last(), 3u);
}

TEST_F(QueueTest, AFileOfAnEarlierVersionIsUpgraded) {
  {
    Queue queue = open();
    append_seconds(queue, 0, 2);
  }
  open_sqlite(path, IfMissing::kFail)
      ->script("alter table records drop column late; alter table records drop column fixed");
  Queue queue = open();
  EXPECT_EQ(queue.read({0, queue.last(), queue.last()}).records.size(), 2u);
}

TEST_F(QueueTest, ASecondForwarderCannotUseTheFile) {
  Queue queue = open();
  try {
    open();
    FAIL();
  } catch (const StoreError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("only one fieldcast-forward"));
  }
  append(queue, record_of(seconds(0, 1)));
  EXPECT_EQ(ids(queue).size(), 1u);
}

TEST_F(QueueTest, AFullDiskIsNotASecondForwarder) {
  { Queue queue = open(); }
  const test::FullDisk full;
  for (const std::string& file : {path, folder.file("new.db")}) {
    try {
      Queue({file, 10'000'000, {}});
      ADD_FAILURE() << file;
    } catch (const StoreAway& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(file));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("only one")));
    }
  }
}

TEST_F(QueueTest, AFileThatIsNotAQueueIsRefusedWithItsName) {
  std::filesystem::create_directory(path);
  try {
    open();
    FAIL();
  } catch (const StoreError& error) { EXPECT_THAT(error.what(), testing::HasSubstr(path)); }
}

TEST_F(QueueTest, GapsAreKeptUntilTheyAreClosed) {
  const Gap first{"line/press/a", {7, 1}, {7, 9}, {}}, second{"line/press/a", {8, 1}, {8, 3}, {}};
  {
    Queue queue = open();
    const std::vector<GapChange> changes{{first}, {second}};
    queue.append({}, {}, kNow, changes);
  }
  {
    Queue queue = open();
    EXPECT_THAT(queue.gaps(), testing::UnorderedElementsAre(first, second));
    const std::vector<GapChange> changes{{{first.path, {7, 5}, first.until, {}}}, {second, true}};
    queue.append({}, {}, kNow, changes);
  }
  EXPECT_THAT(open().gaps(), testing::ElementsAre(Gap{first.path, {7, 5}, first.until, {}}));
}

}  // namespace
}  // namespace fieldcast::forward
