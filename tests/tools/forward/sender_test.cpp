#include "tools/forward/send/sender.hpp"

#include <gtest/gtest.h>

#include <condition_variable>

#include "bridge/base/clock.hpp"
#include "tests/tools/forward/batch_support.hpp"
#include "tools/forward/outlet/message_id.hpp"

namespace fieldcast::forward {
namespace {

// What the engine does is decided by the test.
struct Engine {
  std::mutex mutex;
  std::condition_variable changed;
  bool is_ready = true;
  Outcome outcome = Outcome::kAcknowledged;
  std::vector<std::string> sent;  // ids
  std::size_t late = 0;
  std::vector<OutletResult> results;

  [[nodiscard]] bool wait(const std::function<bool()>& condition) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds{20}, condition);
  }
};

class EngineOutlet final : public Outlet {
 public:
  EngineOutlet(Engine& engine, Sender& sender) : engine_(engine), sender_(sender) {}
  bool is_ready(Instant) override {
    const std::lock_guard lock(engine_.mutex);
    return engine_.is_ready;
  }
  std::optional<std::size_t> send(const Record& record) override {
    const bool is_broken = !payloads_.payload_of(record);
    {
      const std::lock_guard lock(engine_.mutex);
      engine_.sent.push_back(message_id_of("north", record));
      engine_.late += record.is_late ? 1 : 0;
      engine_.results.push_back({record.id, is_broken ? Outcome::kRefused : engine_.outcome});
    }
    engine_.changed.notify_all();
    sender_.wake();
    return record.body.size();
  }
  std::vector<OutletResult> take_results() override {
    const std::lock_guard lock(engine_.mutex);
    return std::exchange(engine_.results, {});
  }

 private:
  Engine& engine_;
  Sender& sender_;
  PayloadMaker payloads_{"north", {}, [](std::uint64_t) { return std::nullopt; }};
};

struct SenderTest : testing::Test {
  Folder folder;
  Queue queue{{folder.file("queue.db")}};
  Engine engine;
  UtcTime appended_at = read_clocks().utc;

  Sender sender() { return {{.in_flight = 4}, queue}; }
  // Each with a catalogue of its own, so that they are not merged.
  void append(std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) {
      SampleBatch batch = seconds(i, i + 1);
      batch.catalogue = static_cast<std::uint64_t>(i);
      const Record record = record_of(batch);
      queue.append(std::span(&record, 1), {}, appended_at);
    }
  }
  [[nodiscard]] bool is_empty_in_time() {
    for (int i = 0; i < 2'000 && queue.counters().records != 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds{10});
    return queue.counters().records == 0;
  }
};

TEST_F(SenderTest, AcknowledgedRecordsLeaveTheQueueInOrder) {
  append(0, 20);
  Sender sending = sender();
  sending.start(std::make_unique<EngineOutlet>(engine, sending));
  ASSERT_TRUE(is_empty_in_time());
  append(20, 25);
  sending.wake();
  ASSERT_TRUE(is_empty_in_time());
  sending.stop();
  ASSERT_EQ(engine.sent.size(), 25u);
  EXPECT_EQ(std::set(engine.sent.begin(), engine.sent.end()).size(), 25u);
  EXPECT_EQ(sending.counters().samples, 25u);
  EXPECT_EQ(sending.counters().repeated, 0u);
}

TEST_F(SenderTest, WithoutAnAcknowledgementARecordIsSentAgainAndStays) {
  append(0, 2);
  engine.outcome = Outcome::kFailed;
  Sender sending = sender();
  sending.start(std::make_unique<EngineOutlet>(engine, sending));
  ASSERT_TRUE(engine.wait([this] { return engine.sent.size() >= 3; }));
  EXPECT_EQ(queue.counters().records, 2u);
  {
    const std::lock_guard lock(engine.mutex);
    EXPECT_EQ(std::set(engine.sent.begin(), engine.sent.end()).size(), 1u) << "the first one";
    engine.outcome = Outcome::kAcknowledged;
  }
  EXPECT_TRUE(is_empty_in_time());
}

TEST_F(SenderTest, ARecordWithoutAcknowledgementIsSentAfterARestart) {
  append(0, 1);
  engine.outcome = Outcome::kFailed;
  {
    Sender sending = sender();
    sending.start(std::make_unique<EngineOutlet>(engine, sending));
    ASSERT_TRUE(engine.wait([this] { return !engine.sent.empty(); }));
  }
  EXPECT_EQ(queue.counters().records, 1u);
  engine.outcome = Outcome::kAcknowledged;
  engine.results.clear();
  Sender again = sender();
  again.start(std::make_unique<EngineOutlet>(engine, again));
  EXPECT_TRUE(is_empty_in_time());
  again.stop();
  EXPECT_EQ(std::set(engine.sent.begin(), engine.sent.end()).size(), 1u) << "the same message id";
}

TEST_F(SenderTest, ARefusedRecordIsRemovedAndTheRestGoesOn) {
  append(0, 1);
  engine.outcome = Outcome::kRefused;
  Sender sending = sender();
  sending.start(std::make_unique<EngineOutlet>(engine, sending));
  ASSERT_TRUE(is_empty_in_time());
  {
    const std::lock_guard lock(engine.mutex);
    engine.outcome = Outcome::kAcknowledged;
  }
  append(1, 3);
  sending.wake();
  ASSERT_TRUE(is_empty_in_time());
  sending.stop();
  EXPECT_EQ(sending.counters().refused, 1u);
  EXPECT_EQ(sending.counters().samples, 2u);
}

TEST_F(SenderTest, OldRecordsAreLateAndWaitingOnesAreMerged) {
  for (const UtcTime at : {UtcTime{1}, read_clocks().utc}) {
    for (std::int64_t i = 0; i < 50; ++i) {
      const Record record = record_of(seconds(i, i + 1));
      queue.append(std::span(&record, 1), {}, at);
    }
  }
  Sender sending = sender();
  sending.start(std::make_unique<EngineOutlet>(engine, sending));
  ASSERT_TRUE(is_empty_in_time());
  sending.stop();
  EXPECT_EQ(sending.counters().samples, 100u);
  EXPECT_EQ(sending.counters().late, 50u);
  EXPECT_EQ(engine.late, 1u);
  EXPECT_EQ(engine.sent.size(), 2u);
}

TEST_F(SenderTest, RecordsThatTheOutletDidNotAcceptInTimeBecomeLate) {
  append(0, 3);
  engine.outcome = Outcome::kFailed;
  Sender sending({.in_flight = 4, .late_after = std::chrono::milliseconds{300}}, queue);
  sending.start(std::make_unique<EngineOutlet>(engine, sending));
  ASSERT_TRUE(engine.wait([this] { return engine.late > 0; }));
  {
    const std::lock_guard lock(engine.mutex);
    engine.outcome = Outcome::kAcknowledged;
  }
  ASSERT_TRUE(is_empty_in_time());
  sending.stop();
  EXPECT_EQ(sending.counters().late, 3u);
}

TEST_F(SenderTest, AfterAStepOfTheClockEveryRecordIsSentInItsOrder) {
  constexpr std::int64_t kHour = 3'600'000'000'000;
  const std::int64_t now = read_clocks().utc.nanoseconds;
  std::int64_t next = 0;
  for (const std::int64_t at : {now, now + kHour, now - kHour, now}) {
    appended_at = {at};
    append(next, next + 3);
    next += 3;
  }
  Sender sending = sender();
  sending.start(std::make_unique<EngineOutlet>(engine, sending));
  ASSERT_TRUE(is_empty_in_time());
  sending.stop();
  EXPECT_EQ(sending.counters().samples, 12u);
  EXPECT_EQ(std::set(engine.sent.begin(), engine.sent.end()).size(), 12u);
}

TEST_F(SenderTest, NothingIsSentBeforeTheOutletIsReady) {
  append(0, 1);
  engine.is_ready = false;
  Sender sending = sender();
  sending.start(std::make_unique<EngineOutlet>(engine, sending));
  sending.stop();
  EXPECT_TRUE(engine.sent.empty());
  EXPECT_EQ(queue.counters().records, 1u);
}

}  // namespace
}  // namespace fieldcast::forward
