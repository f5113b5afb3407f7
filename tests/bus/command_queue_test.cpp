#include "tests/bus/command_queue_fixture.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
using test::CommandQueueTest;

// A permanent refusal is reported even while the device or its port is down.
TEST_F(CommandQueueTest, APermanentRefusalGoesBeforeAMomentaryOne) {
  Command wrong_type = write("r0", 0);
  wrong_type.values = {Value{std::string("text")}};
  for (const CommandQueue::Condition condition : {CommandQueue::Condition{BusState::kRunning, true},
                                                  {BusState::kClosed, false},
                                                  {BusState::kOpening, false},
                                                  {BusState::kLeased, false},
                                                  {BusState::kStopped, false}}) {
    EXPECT_EQ(refusal_of(write("r3", 1), condition), Cause::kReadOnly);
    EXPECT_EQ(refusal_of(write("r0", 70000), condition), Cause::kRange);
    EXPECT_EQ(refusal_of(wrong_type, condition), Cause::kWrongType);
    EXPECT_EQ(refusal_of(write("none", 1), condition), Cause::kUnknownChannel);
    EXPECT_EQ(refusal_of(write("r0", 1, "nobody"), condition), Cause::kUnknownDevice);
  }
}

TEST_F(CommandQueueTest, AMomentaryRefusalSaysWhatIsDown) {
  EXPECT_EQ(refusal_of(write("r0", 1), {BusState::kRunning, true}), Cause::kOffline);
  EXPECT_EQ(refusal_of(write("r0", 1), {BusState::kClosed, false}), Cause::kOffline);
  EXPECT_EQ(refusal_of(write("r0", 1), {BusState::kLeased, false}), Cause::kLeased);
  EXPECT_EQ(refusal_of(write("r0", 1), {BusState::kStopped, false}), Cause::kShutdown);
  EXPECT_TRUE(queue_.empty());
}

// A read of the gateway shares each response that contains its items, but only a later or a fresh
// one.
TEST_F(CommandQueueTest, AGatewaysReadIsServedByAResponseThatContainsIt) {
  BusSpec spec = bus();
  spec.gateway.emplace();
  const BusSetup setup(spec);
  CommandQueue queue(setup, channels_, plain_text_codec());
  const auto read = [&](Duration max_age, Instant now) {
    Command command = acquire("");
    command.target = AddressTarget{"holding:101", {}};
    command.gateway = true;
    command.max_age = max_age;
    queue.accept(command, {}, now, sink_);
  };
  const auto respond = [&](Instant asked, Instant acquired) {
    queue.read(0, {{test::kHolding, 100, 2}, {0, 1, 0x12, 0x34}, asked, acquired}, acquired, sink_);
    return results();
  };
  read(0ms, Instant{100ms});
  EXPECT_TRUE(respond(Instant{90ms}, Instant{110ms}).empty()) << "it was sent before the request";
  const auto done = respond(Instant{120ms}, Instant{130ms});
  ASSERT_EQ(done.size(), 1u);
  EXPECT_EQ(done[0].values, std::vector<Value>{Value{std::uint64_t{0x1234}}});
  EXPECT_TRUE(done[0].gateway_read);
  EXPECT_TRUE(queue.empty());
  read(50ms, Instant{180ms});
  EXPECT_EQ(results().size(), 1u) << "50 ms old";
  read(50ms, Instant{181ms});
  EXPECT_TRUE(results().empty()) << "51 ms old";
  queue.written(0);
  read(1h, Instant{182ms});
  EXPECT_TRUE(results().empty()) << "a write may have changed the items";
}

TEST_F(CommandQueueTest, AWriteThatWasBrokenOffMakesStoredResponsesInvalid) {
  queue_.read(0, {{test::kHolding, 100, 1}, {0, 1}, Instant{}, Instant{}}, Instant{}, sink_);
  Command read = acquire("");
  read.target = AddressTarget{"holding:100", {}};
  read.gateway = true;
  read.max_age = 1h;
  accept(read);
  EXPECT_EQ(results().size(), 1u);
  accept(write("r0", 2));
  ASSERT_TRUE(next());
  queue_.failed(1, Cause::kPortClosed, 0, Instant{}, Instant{}, sink_);
  EXPECT_EQ(results().size(), 1u) << "of the write";
  accept(read);
  EXPECT_TRUE(results().empty()) << "the write may have taken effect";
}

TEST_F(CommandQueueTest, AGatewaysReadGoesAfterAllCommands) {
  Command command = of("client", acquire("", "unit-2"));
  command.target = AddressTarget{"holding:100", {}};
  command.gateway = true;
  accept(command);
  accept(of("plant", write("r0", 1)));
  EXPECT_EQ(serve(), "plant");
  EXPECT_EQ(serve(), "client");
}

// A bridge that has just started or taken over opens its port soon.
TEST_F(CommandQueueTest, WhileThePortIsBeingOpenedACommandWaits) {
  accept(write("r0", 1), {BusState::kOpening, false});
  EXPECT_TRUE(results().empty());
  EXPECT_EQ(refusal_of(write("r0", 2), {BusState::kOpening, true}), Cause::kOffline)
      << "the device was known to be silent by the bridge before";
  Command short_lived = write("r1", 3);
  short_lived.expires = Instant{100ms};
  accept(short_lived, {BusState::kOpening, false});
  queue_.expire(BusState::kOpening, Instant{100ms}, sink_);
  const auto expired = results();
  ASSERT_EQ(expired.size(), 1u);
  EXPECT_EQ(expired[0].state, CommandState::kExpired);
  EXPECT_NE(expired[0].reason.find("the port of bus 'bus' was still being opened"),
            std::string::npos)
      << expired[0].reason;
  queue_.refuse_all(Cause::kOffline, "port is down", Instant{1s}, sink_);
  const auto refused = results();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].state, CommandState::kRejected) << "it never began";
}

TEST_F(CommandQueueTest, ARefusedCommandDoesNotCountForTheRateLimit) {
  EXPECT_EQ(refusal_of(write("r2", 1), {BusState::kRunning, true}), Cause::kOffline);
  accept(write("r2", 1));
  EXPECT_TRUE(results().empty()) << "the first that is taken";
  EXPECT_EQ(refusal_of(write("r2", 1), {}), Cause::kRateLimited);
  accept(write("r2", 1), {}, Instant{1s});
  EXPECT_TRUE(results().empty());
}

TEST_F(CommandQueueTest, AWriteThatDoesNotRunDoesNotCountForTheRateLimit) {
  Command waits = write("r2", 1);
  waits.expires = Instant{100ms};
  accept(waits);
  queue_.expire(BusState::kRunning, Instant{100ms}, sink_);
  ASSERT_EQ(results().size(), 1u);
  accept(write("r2", 1), {}, Instant{100ms});
  EXPECT_TRUE(results().empty()) << "the first has expired";
  queue_.refuse_all(Cause::kOffline, "port is down", Instant{200ms}, sink_);
  ASSERT_EQ(results().size(), 1u);
  accept(write("r2", 1), {}, Instant{200ms});
  EXPECT_TRUE(results().empty()) << "the second was rejected";
}

TEST_F(CommandQueueTest, AWriteThatIsDisplacedDoesNotCountForTheRateLimit) {
  for (std::size_t i = 1; i < CommandQueue::kMaxWaiting; ++i) accept(write("r0", i));
  accept(write("r2", 1));
  accept(of("b", write("r0", 1)));
  ASSERT_EQ(results().size(), 1u) << "the newest of the flood";
  accept(of("b", write("r2", 1)));
  const auto displaced = results();
  ASSERT_EQ(displaced.size(), 1u);
  EXPECT_EQ(displaced[0].cause, Cause::kQueueFull);
}

TEST_F(CommandQueueTest, AWriteThatExpiresKeepsTheRateLimitOfALaterOne) {
  Command waits = write("r2", 1);
  waits.expires = Instant{1500ms};
  accept(waits);
  accept(write("r2", 2), {}, Instant{1s});
  queue_.expire(BusState::kRunning, Instant{1500ms}, sink_);
  ASSERT_EQ(results().size(), 1u);
  accept(write("r2", 3), {}, Instant{1500ms});
  const auto refused = results();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].cause, Cause::kRateLimited);
}

TEST_F(CommandQueueTest, WritesThatTouchTravelInOneRequestAndHaveAResultEach) {
  accept(write("r0", 10));
  accept(write("r1", 11, "unit-2"));
  accept(write("r1", 11));
  const auto sent = next();
  ASSERT_TRUE(sent);
  EXPECT_EQ(sent->batch, 2u);
  EXPECT_EQ(std::get<WriteRequest>(sent->request).range, (Range{test::kHolding, 100, 2}));
  queue_.responded(sent->batch, {{}}, Instant{10ms}, Instant{10ms}, sink_);
  const auto all = results();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].request_id, 1u);
  EXPECT_EQ(all[1].request_id, 3u);
  EXPECT_EQ(queue_.done(), 2u);
  EXPECT_EQ(next()->device, 1u);
}

TEST_F(CommandQueueTest, ARefusedBatchGoesAloneAndACommandThatHasBegunStaysFirst) {
  accept(write("r0", 10));
  accept(write("r1", 11));
  const auto sent = next();
  ASSERT_EQ(sent->batch, 2u);
  queue_.failed(sent->batch, Cause::kDeviceError, 2, Instant{}, Instant{}, sink_);
  EXPECT_TRUE(results().empty()) << "nobody knows which of them was meant";
  EXPECT_TRUE(queue_.keeps_wire());
  const auto alone = next();
  EXPECT_EQ(alone->batch, 1u);
  queue_.failed(1, Cause::kDeviceError, 2, Instant{}, Instant{}, sink_);
  const auto all = results();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].cause, Cause::kDeviceError);
  EXPECT_EQ(all[0].device_code, 2);
}

// A gateway lost the response: each command of the batch may have taken effect.
TEST_F(CommandQueueTest, ABatchThatMayHaveTakenEffectIsReadBackAndNotWrittenAgain) {
  accept(write("r0", 10));
  accept(write("r1", 11));
  const auto sent = next();
  ASSERT_EQ(sent->batch, 2u);
  queue_.failed(sent->batch, Cause::kDeviceBusy, 0x0B, Instant{}, Instant{}, sink_);
  for (const auto value : Bytes{10, 11}) {
    const auto read = next();
    ASSERT_TRUE(read && std::holds_alternative<ReadRequest>(read->request));
    queue_.responded(1, test::items({0, value}), Instant{}, Instant{}, sink_);
    const auto all = results();
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all.back().state, CommandState::kDone);
  }
}

TEST_F(CommandQueueTest, TheFirstWhoseDeviceMayBeAskedGoes) {
  accept(write("r0", 1));
  accept(write("r0", 2, "unit-2"));
  const CommandQueue::Gate gate = [](const CommandJob& job) {
    return job.device() == 0 ? Instant{1s} : Instant{200ms};
  };
  EXPECT_FALSE(queue_.next(Instant{}, gate, false));
  EXPECT_EQ(queue_.sendable_from(gate), Instant{200ms});
  EXPECT_EQ(queue_.next(Instant{200ms}, gate, false)->device, 1u);
  EXPECT_TRUE(queue_.keeps_wire());
}

// Regression: a long read command of a device that paused held back the commands of all others.
TEST_F(CommandQueueTest, CommandsOfOtherDevicesComeBetweenTheRequestsOfARead) {
  accept(of("a", acquire("", "unit-2")));
  ASSERT_EQ(next()->device, 1u);
  queue_.responded(1, test::items({0, 1, 0, 2}), Instant{}, Instant{}, sink_);
  accept(of("a", write("r0", 1)));
  const CommandQueue::Gate pause = [](const CommandJob& job) {
    return job.device() == 1 ? Instant{1s} : kLongAgo;
  };
  EXPECT_EQ(queue_.sendable_from(pause), kLongAgo);
  ASSERT_EQ(queue_.next(Instant{}, pause, false)->device, 0u);
  actions_.clear();
  queue_.responded(1, test::items({0, 1}), Instant{}, Instant{}, sink_);
  EXPECT_EQ(results().size(), 1u);
  EXPECT_FALSE(queue_.next(Instant{}, pause, false)) << "the read still waits for its device";
  EXPECT_EQ(queue_.next(Instant{1s}, pause, false)->device, 1u);
}

TEST_F(CommandQueueTest, AReadThatIsRefusedBetweenItsRequestsCannotHaveTakenEffect) {
  accept(acquire("", "unit-2"));
  ASSERT_TRUE(next());
  queue_.responded(1, test::items({0, 1, 0, 2}), Instant{}, Instant{}, sink_);
  actions_.clear();
  queue_.refuse_all(Cause::kOffline, "port is down", Instant{1s}, sink_);
  const auto all = results();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].state, CommandState::kFailed);
  EXPECT_EQ(all[0].reason, "port is down");
}

TEST_F(CommandQueueTest, WhatHasBegunDoesNotExpire) {
  Command begun = write("r0", 1), waits = write("r3", 1, "unit-2");
  waits.operation = Operation::kAcquire;
  begun.expires = waits.expires = Instant{100ms};
  accept(begun);
  accept(waits);
  EXPECT_EQ(queue_.next_expiry(), Instant{100ms});
  ASSERT_TRUE(next());
  queue_.expire(BusState::kRunning, Instant{100ms}, sink_);
  const auto all = results();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].request_id, waits.request_id);
  EXPECT_EQ(all[0].state, CommandState::kExpired);
  EXPECT_EQ(queue_.next_expiry(), kNever);
  EXPECT_FALSE(queue_.empty());
}

TEST_F(CommandQueueTest, RefusingAllSaysThatABegunWriteIsInDoubt) {
  accept(write("r0", 1));
  accept(write("r0", 2, "unit-2"));
  ASSERT_TRUE(next());
  queue_.refuse_all(Cause::kOffline, "port is down", Instant{1s}, sink_);
  const auto all = results();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].state, CommandState::kFailed);
  EXPECT_EQ(all[0].reason, "port is down; unknown whether it took effect");
  EXPECT_EQ(all[1].state, CommandState::kRejected);
  EXPECT_TRUE(queue_.empty());
  EXPECT_FALSE(queue_.keeps_wire());
}

TEST_F(CommandQueueTest, AnAcquisitionIsAResultAndSamples) {
  Command read = write("r3", 0);
  read.operation = Operation::kAcquire;
  read.values.clear();
  accept(read);
  ASSERT_TRUE(next());
  queue_.responded(1, test::items({0x01, 0x02}), Instant{5ms}, Instant{6ms}, sink_);
  ASSERT_EQ(actions_.size(), 2u);
  const auto& published = std::get<Publish>(actions_[1]).samples;
  ASSERT_EQ(published.size(), 1u);
  EXPECT_EQ(published[0].acquired, Instant{5ms});
  EXPECT_EQ(samples_, 1u);
  EXPECT_EQ(results()[0].values, std::vector<Value>{Value{std::uint64_t{0x0102}}});
}

TEST_F(CommandQueueTest, EachPartOfAnAcquisitionHasTheTimeOfItsResponse) {
  accept(acquire("", "unit-2"));
  ASSERT_TRUE(next());
  queue_.responded(1, test::items({0, 1, 0, 2}), Instant{5ms}, Instant{6ms}, sink_);
  ASSERT_EQ(actions_.size(), 1u) << "samples do not wait for the end of the command";
  ASSERT_TRUE(next());
  queue_.failed(1, Cause::kNoResponse, 0, Instant{1s}, Instant{1s}, sink_);
  const auto& first = std::get<Publish>(actions_[0]).samples;
  ASSERT_EQ(first.size(), 2u);
  for (const Sample& sample : first) EXPECT_EQ(sample.acquired, Instant{5ms});
  EXPECT_EQ(samples_, 2u) << "the failure repeats none of them";
  EXPECT_EQ(results()[0].state, CommandState::kFailed);
}

}  // namespace
}  // namespace fieldcast
