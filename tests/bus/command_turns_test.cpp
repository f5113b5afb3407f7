#include "tests/bus/command_queue_fixture.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;
// Whose command goes next, and whose is refused.
class CommandTurns : public test::CommandQueueTest {};

TEST_F(CommandTurns, WhoFillsTheQueueIsRefusedAndAnotherIsNot) {
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

TEST_F(CommandTurns, RequestersAreServedInTurn) {
  for (int i = 0; i < 100; ++i) accept(of("flood", acquire("r3")));
  accept(of("b", acquire("r3")));
  accept(of("b", acquire("r3")));
  accept(of("c", acquire("r3", "unit-2")));
  std::vector<std::string> served;
  for (int i = 0; i < 6; ++i) served.push_back(serve());
  EXPECT_EQ(served, (std::vector<std::string>{"flood", "b", "c", "flood", "b", "flood"}));
}

// The first command of a requester waits for at most one command of each other requester.
TEST_F(CommandTurns, OneThatSendsAgainAfterEachResultDoesNotStarveTheOthers) {
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

TEST_F(CommandTurns, AFloodOfManyNamesLeavesRoomForAnother) {
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

TEST_F(CommandTurns, WithAsManyNamesAsTheQueueHoldsTheLastIsRefused) {
  for (std::size_t i = 0; i < CommandQueue::kMaxWaiting; ++i)
    accept(of(std::to_string(i), write("r0", 1)));
  EXPECT_TRUE(results().empty());
  EXPECT_EQ(refusal_of(of("another", write("r0", 1)), {}), Cause::kQueueFull);
}

TEST_F(CommandTurns, TheBytesOfARequesterAreLimited) {
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

TEST_F(CommandTurns, EachValueOfACommandCounts) {
  Command command = write("", 0);
  command.target = AddressTarget{"holding:100", {.type = ValueType::kUint16}};
  command.values.assign(120, Value{std::uint64_t{1}});
  std::size_t accepted = 0;
  for (; accepted < CommandQueue::kMaxWaiting && results().empty(); ++accepted) accept(command);
  EXPECT_LE(accepted, CommandQueue::kMaxBytesOfRequester / (120 * sizeof(Value)) + 1);
}

TEST_F(CommandTurns, TheBytesOfAllRequestersAreLimitedAndTheLargestGivesWay) {
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

TEST_F(CommandTurns, CommandsThatWereServedByAResponseLeaveTheirRoom) {
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

TEST_F(CommandTurns, ARequesterHasItsTurnBetweenTheRequestsOfTheReadOfAnother) {
  accept(of("a", acquire("", "unit-2")));
  accept(of("a", write("r2", 1)));
  accept(of("b", write("r0", 1)));
  ASSERT_TRUE(next());
  queue_.responded(1, test::items({0, 1, 0, 2}), Instant{}, Instant{}, sink_);
  EXPECT_EQ(serve(), "b");
  EXPECT_EQ(next()->device, 1u) << "the read of a is older than its write";
}

// The requester with the most commands gives way only while it has at least two more.
TEST_F(CommandTurns, ARequesterGivesWayUntilBothHaveAsMany) {
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

TEST_F(CommandTurns, ARequesterDoesNotGiveWayForOneCommand) {
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
