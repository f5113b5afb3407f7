// A queue of commands at a bus of two Modbus units, in virtual time.
#pragma once

#include <gtest/gtest.h>

#include "core/bus/command/command_queue.hpp"
#include "tests/bus/rtu_bus.hpp"

namespace fieldcast::test {

class CommandQueueTest : public testing::Test {
 protected:
  static BusSpec bus() {
    BusSpec bus = rtu_bus(2);
    bus.devices[0].channels[2].write_interval = std::chrono::seconds{1};
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
    queue_.responded(1, items({0x01, 0x02}), Instant{}, Instant{}, sink_);
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

}  // namespace fieldcast::test
