#include "tools/station/live/command_controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <future>

#include "tests/tools/station/live/io_test.hpp"

namespace fieldcast::web {
namespace {

using namespace std::chrono_literals;

// A bridge that responds immediately, never, or is absent.
struct FakePort : CommandPort {
  std::uint64_t reserve_request_id() override { return ++last; }
  tl::expected<std::uint64_t, StationFault> send(StationCommand command) override {
    if (gate.valid()) gate.wait();
    const std::lock_guard lock(mutex);
    sent.push_back(command);
    if (!bridge) return tl::unexpected(StationFault::kNoBridge);
    if (answer) answer(command);
    return command.command.request_id;
  }
  tl::expected<std::uint64_t, StationFault> send(AlarmAction action) override {
    const std::lock_guard lock(mutex);
    actions.push_back(action);
    return action.request_id;
  }
  void declare(const std::string& pattern, Duration refresh) override {
    const std::lock_guard lock(mutex);
    declared.emplace_back(pattern, refresh);
  }

  std::atomic<std::uint64_t> last = 0;
  std::shared_future<void> gate;  // if valid, sending waits for it
  bool bridge = true;
  std::function<void(const StationCommand&)> answer;
  std::mutex mutex;
  std::vector<StationCommand> sent;
  std::vector<AlarmAction> actions;
  std::vector<std::pair<std::string, Duration>> declared;
};

struct FakeAudit : Audit {
  void append(AuditEntry entry) override { entries.push_back(std::move(entry)); }
  std::vector<AuditEntry> entries;
};

struct CommandControllerTest : IoTest {
  auto write() {
    return desk.submit(anna, write_command({"shop", "press", "oil"}, 21.5, true),
                       [this](const CommandOutcome& outcome) { outcomes.push_back(outcome); });
  }
  void answer_all() {
    port.answer = [this](const StationCommand& command) {
      StationResult result;
      result.request_id = command.command.request_id;
      result.state = CommandState::kDone;
      result.cause = "NONE";
      desk.on_result(result);
    };
  }

  FakePort port;
  FakeAudit audit;
  std::vector<CommandOutcome> outcomes, others;
  CommandController desk{io, port, &audit,
                         [this](const CommandOutcome& outcome) { others.push_back(outcome); }};
  const Caller anna{"anna", Role::kOperator, "10.0.0.7"};
};

TEST_F(CommandControllerTest, AResultThatComesBeforeTheSendingReturnsCounts) {
  answer_all();
  const auto id = write();
  ASSERT_TRUE(id);
  ASSERT_TRUE(run_until([&] { return !outcomes.empty(); }));
  EXPECT_EQ(outcomes[0].request_id, *id);
  EXPECT_EQ(outcomes[0].state, "done");
  EXPECT_EQ(port.sent[0].person, "anna");
  EXPECT_EQ(port.sent[0].command.request_id, *id);
  EXPECT_EQ(desk.find("anna", *id)->state, "done");
}

TEST_F(CommandControllerTest, EveryCommandIsAudited) {
  answer_all();
  ASSERT_TRUE(write());
  ASSERT_TRUE(run_until([&] { return !audit.entries.empty(); }));
  EXPECT_EQ(audit.entries[0], (AuditEntry{.who = "anna from 10.0.0.7",
                                          .what = "write 21.5",
                                          .target = "shop/press/oil",
                                          .result = "done"}));
}

TEST_F(CommandControllerTest, WithoutABridgeItSaysSo) {
  port.bridge = false;
  ASSERT_TRUE(write());
  ASSERT_TRUE(run_until([&] { return !outcomes.empty(); }));
  EXPECT_EQ(outcomes[0].state, "not-sent");
  EXPECT_THAT(audit.entries[0].result, ::testing::HasSubstr("no bridge serves the bus"));
}

TEST_F(CommandControllerTest, AWorkerThatWaitsDoesNotHoldUpTheIoThread) {
  std::promise<void> open;
  port.gate = open.get_future();
  std::size_t taken = 0;
  while (taken < PendingCommands::kMaxOfUser && write()) ++taken;
  EXPECT_EQ(taken, PendingCommands::kMaxOfUser);
  const auto refused = write();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().error, "too many commands are pending");
  open.set_value();
}

TEST_F(CommandControllerTest, WhatNobodyWaitsForIsReportedToAll) {
  answer_all();
  ASSERT_TRUE(desk.submit(anna, acquire_command({"shop", "press", "oil"}), {}));
  ASSERT_TRUE(run_until([&] { return !others.empty(); }));
  EXPECT_EQ(others[0].user, "anna");
}

TEST_F(CommandControllerTest, AnAlarmActionNamesItsPerson) {
  AlarmAction action;
  action.kind = AlarmActionKind::kAcknowledge;
  action.alarm = {"shop", "press", "oil", LimitKind::kHigh};
  action.note = "fan is ordered";
  const auto id = desk.submit(anna, action, {});
  ASSERT_TRUE(id);
  StationResult result;
  result.request_id = *id;
  result.state = CommandState::kRejected;
  result.reason = "no such alarm";
  desk.on_result(result);
  ASSERT_TRUE(run_until([&] { return !others.empty() && !port.actions.empty(); }));
  EXPECT_EQ(port.actions[0].by, "anna");
  EXPECT_EQ(audit.entries[0].what, "acknowledge: fan is ordered");
  EXPECT_EQ(audit.entries[0].target, "shop/press/oil high");
  EXPECT_EQ(audit.entries[0].result, "rejected: no such alarm");
}

TEST_F(CommandControllerTest, ACommandForASiteOfTheStreamHasItsRoute) {
  FakePort stream;
  desk.set_stream(stream, [](const std::string& bus) { return bus.starts_with("north:"); });
  EXPECT_TRUE(desk.reaches_stream());
  const auto done = [this](const CommandOutcome& outcome) { outcomes.push_back(outcome); };
  const auto id = desk.submit(anna, acquire_command({"north:shop", "press", "oil"}), done);
  ASSERT_TRUE(id);
  ASSERT_TRUE(write());
  desk.on_outcome(*id, tl::unexpected(StationFault::kNoBridge));
  ASSERT_TRUE(run_until([&] {
    const std::scoped_lock lock(port.mutex, stream.mutex);
    return !outcomes.empty() && !port.sent.empty() && !stream.sent.empty();
  }));
  EXPECT_EQ(stream.sent.size(), 1u);
  EXPECT_EQ(stream.sent[0].bus, "north:shop");
  EXPECT_EQ(stream.sent[0].person, "anna");
  EXPECT_EQ(port.sent[0].bus, "shop");
  EXPECT_EQ(outcomes[0].state, "not-sent");
  desk.close();
}

TEST_F(CommandControllerTest, InterestsAreDeclaredOnTheWorker) {
  desk.declare("shop/press/oil", 500ms);
  ASSERT_TRUE(run_until([&] {
    const std::lock_guard lock(port.mutex);
    return !port.declared.empty();
  }));
  EXPECT_EQ(port.declared.back(), (std::pair<std::string, Duration>{"shop/press/oil", 500ms}));
}

TEST_F(CommandControllerTest, AfterItsEndNothingComes) {
  ASSERT_TRUE(write());
  desk.close();
  StationResult result;
  result.request_id = 1;
  desk.on_result(result);
  io.restart();
  io.run_for(20ms);
  EXPECT_TRUE(outcomes.empty());
}

}  // namespace
}  // namespace fieldcast::web
