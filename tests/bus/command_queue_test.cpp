#include "core/bus/command/command_queue.hpp"

#include <gtest/gtest.h>

#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

class CommandQueueTest : public testing::Test {
 protected:
  static BusSpec bus() {
    BusSpec bus = test::rtu_bus(2);
    bus.devices[0].channels[2].write_interval = 1s;
    bus.devices[1].max_block = 2;
    bus.devices[0].allow_raw_write = true;
    return bus;
  }
  Command write(const std::string& channel, std::uint64_t value,
                const std::string& device = "unit-1") {
    Command command;
    command.request_id = ++sent_;
    command.device = device;
    command.target = ChannelTarget{channel};
    command.values = {Value{value}};
    return command;
  }
  Command acquire(const std::string& channel, const std::string& device = "unit-1") {
    Command command = write(channel, 0, device);
    command.operation = Operation::kAcquire;
    command.values.clear();
    return command;
  }
  static Command of(std::string requester, Command command) {
    command.requester = std::move(requester);
    return command;
  }
  std::string serve() {
    if (!next()) return "nobody";
    queue_.responded(1, test::items({0x01, 0x02}), Instant{}, Instant{}, sink_);
    return results().front().requester;
  }
  std::vector<CommandResult> results() {
    std::vector<CommandResult> all;
    for (const Action& action : actions_) {
      if (const auto* complete = std::get_if<Complete>(&action)) all.push_back(complete->result);
    }
    actions_.clear();
    return all;
  }
  void accept(const Command& command, CommandQueue::Condition condition = {}, Instant now = {}) {
    queue_.accept(command, condition, now, sink_);
  }
  Cause refusal_of(const Command& command, CommandQueue::Condition condition) {
    accept(command, condition);
    const auto all = results();
    return all.size() == 1 && all[0].state == CommandState::kRejected ? all[0].cause : Cause::kNone;
  }
  std::optional<CommandQueue::Next> next(Instant now = {}) {
    return queue_.next(now, at_once_, false);
  }

  BusSetup setup_{bus()};
  ChannelTable channels_{setup_.spec()};
  CommandQueue queue_{setup_, channels_, plain_text_codec()};
  CommandQueue::Gate at_once_ = [](const CommandJob&) { return kLongAgo; };
  std::uint64_t samples_ = 0;
  std::uint64_t sent_ = 0;
  Actions actions_;
  ActionSink sink_{setup_, samples_, actions_};
};

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

TEST_F(CommandQueueTest, WhoFillsTheQueueIsRefusedAndAnotherIsNot) {
  for (std::size_t i = 0; i < CommandQueue::kMaxWaiting; ++i) accept(write("r0", i));
  EXPECT_TRUE(results().empty());
  EXPECT_EQ(refusal_of(write("r0", 1), {}), Cause::kQueueFull);
  accept(of("another", write("r0", 1)));
  const auto refused = results();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].requester, "");
  EXPECT_EQ(refused[0].request_id, CommandQueue::kMaxWaiting) << "its newest";
  EXPECT_EQ(refused[0].state, CommandState::kRejected);
  EXPECT_EQ(refused[0].cause, Cause::kQueueFull);
}

TEST_F(CommandQueueTest, RequestersAreServedInTurn) {
  for (int i = 0; i < 100; ++i) accept(of("flood", acquire("r3")));
  accept(of("b", acquire("r3")));
  accept(of("b", acquire("r3")));
  accept(of("c", acquire("r3", "unit-2")));
  std::vector<std::string> served;
  for (int i = 0; i < 6; ++i) served.push_back(serve());
  EXPECT_EQ(served, (std::vector<std::string>{"flood", "b", "c", "flood", "b", "flood"}));
}

// The first command of a requester waits for at most one command of each other requester.
TEST_F(CommandQueueTest, OneThatSendsAgainAfterEachResultDoesNotStarveTheOthers) {
  for (int i = 0; i < 10; ++i) accept(of("flood", acquire("r3")));
  std::map<std::string, int> served;
  accept(of("polite", acquire("r3")));
  for (int i = 0; i < 10; ++i) {
    const std::string who = serve();
    ++served[who];
    if (who == "polite") accept(of("polite", acquire("r3")));
  }
  EXPECT_EQ(served["flood"], 5);
  EXPECT_EQ(served["polite"], 5);
}

TEST_F(CommandQueueTest, AFloodOfManyNamesLeavesRoomForAnother) {
  const std::size_t names = CommandQueue::kMaxWaiting / 4;
  for (std::size_t i = 0; i < CommandQueue::kMaxWaiting; ++i)
    accept(of("flood-" + std::to_string(i % names), write("r0", 1)));
  EXPECT_TRUE(results().empty());
  accept(of("another", write("r0", 1)));
  const auto refused = results();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].cause, Cause::kQueueFull);
  EXPECT_EQ(refused[0].requester.substr(0, 6), "flood-");
}

TEST_F(CommandQueueTest, WithAsManyNamesAsTheQueueHoldsTheLastIsRefused) {
  for (std::size_t i = 0; i < CommandQueue::kMaxWaiting; ++i)
    accept(of(std::to_string(i), write("r0", 1)));
  EXPECT_TRUE(results().empty());
  EXPECT_EQ(refusal_of(of("another", write("r0", 1)), {}), Cause::kQueueFull);
}

TEST_F(CommandQueueTest, TheBytesOfARequesterAreLimited) {
  const std::string name(20000, 'x');
  std::size_t accepted = 0;
  for (; accepted < CommandQueue::kMaxWaiting && results().empty(); ++accepted)
    accept(of(name, write("r0", 1)));
  EXPECT_LE(accepted, CommandQueue::kMaxBytesOfRequester / name.size() + 1);
  EXPECT_GE(accepted, CommandQueue::kMaxBytesOfRequester / (name.size() + 2000));
  queue_.refuse_all(Cause::kShutdown, "stopped", Instant{}, sink_);
  actions_.clear();
  accept(of(name, write("r0", 1)));
  EXPECT_TRUE(results().empty()) << "the room is free again";
}

TEST_F(CommandQueueTest, EachValueOfACommandCounts) {
  Command command = write("", 0);
  command.target = AddressTarget{"holding:100", {.type = ValueType::kUint16}};
  command.values.assign(120, Value{std::uint64_t{1}});
  std::size_t accepted = 0;
  for (; accepted < CommandQueue::kMaxWaiting && results().empty(); ++accepted) accept(command);
  EXPECT_LE(accepted, CommandQueue::kMaxBytesOfRequester / (120 * sizeof(Value)) + 1);
}

TEST_F(CommandQueueTest, TheBytesOfAllRequestersAreLimitedAndTheLargestGivesWay) {
  const std::string a(20000, 'a'), b(20000, 'b'), c(20000, 'c');
  for (const std::string& name : {a, b}) {
    for (std::size_t i = 0; i < 190; ++i) accept(of(name, write("r0", 1)));
  }
  ASSERT_TRUE(results().empty());
  std::size_t room = 0;
  for (;; ++room) {
    accept(of(c, write("r0", 1)));
    if (!actions_.empty()) break;
  }
  EXPECT_LE((380 + room) * c.size(), CommandQueue::kMaxBytes);
  EXPECT_GT((381 + room) * (c.size() + 2000), CommandQueue::kMaxBytes);
  std::vector<std::string> refused;
  for (int i = 0; i < 3; ++i) {
    const auto all = results();
    ASSERT_EQ(all.size(), 1u) << "each is as long as the other";
    refused.push_back(all[0].requester.substr(0, 1));
    EXPECT_EQ(all[0].cause, Cause::kQueueFull);
    accept(of(c, write("r0", 1)));
  }
  EXPECT_EQ(refused, (std::vector<std::string>{"b", "a", "b"}));
}

TEST_F(CommandQueueTest, CommandsThatWereServedByAResponseLeaveTheirRoom) {
  const std::string name(20000, 'x');
  for (int time = 0; time < 3; ++time) {
    for (int i = 0; i < 150; ++i) {
      Command command = of(name, acquire("r0"));
      command.target = AddressTarget{"holding:100", {}};
      command.gateway = true;
      accept(command);
    }
    EXPECT_TRUE(results().empty()) << time;
    queue_.read(0, {{test::kHolding, 100, 1}, {0, 1}, Instant{1s}, Instant{1s}}, Instant{1s},
                sink_);
    EXPECT_EQ(results().size(), 150u);
    queue_.written(0);  // the response is not kept
  }
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

TEST_F(CommandQueueTest, ARequesterHasItsTurnBetweenTheRequestsOfTheReadOfAnother) {
  accept(of("a", acquire("", "unit-2")));
  accept(of("a", write("r2", 1)));
  accept(of("b", write("r0", 1)));
  ASSERT_TRUE(next());
  queue_.responded(1, test::items({0, 1, 0, 2}), Instant{}, Instant{}, sink_);
  EXPECT_EQ(serve(), "b");
  EXPECT_EQ(next()->device, 1u) << "the read of a is older than its write";
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

// The requester with the most commands gives way only while it has at least two more.
TEST_F(CommandQueueTest, ARequesterGivesWayUntilBothHaveAsMany) {
  const std::size_t half = CommandQueue::kMaxWaiting / 2;
  for (std::size_t i = 0; i < half + 1; ++i) accept(of("a", write("r0", 1)));
  for (std::size_t i = 0; i < half - 1; ++i) accept(of("b", write("r0", 1)));
  ASSERT_TRUE(results().empty());
  accept(of("b", write("r0", 1)));
  const auto refused = results();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].requester, "a");
  EXPECT_EQ(refusal_of(of("b", write("r0", 1)), {}), Cause::kQueueFull);
  EXPECT_EQ(refusal_of(of("a", write("r0", 1)), {}), Cause::kQueueFull);
}

TEST_F(CommandQueueTest, ARequesterDoesNotGiveWayForOneCommand) {
  const std::size_t half = CommandQueue::kMaxWaiting / 2;
  accept(of("c", write("r0", 1)));
  for (std::size_t i = 0; i < half; ++i) accept(of("a", write("r0", 1)));
  for (std::size_t i = 0; i < half - 1; ++i) accept(of("b", write("r0", 1)));
  ASSERT_TRUE(results().empty());
  accept(of("b", write("r0", 1)));
  const auto refused = results();
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].requester, "b") << "it would only exchange the places";
}

}  // namespace
}  // namespace fieldcast
