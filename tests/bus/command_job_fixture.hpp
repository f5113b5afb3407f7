// A device with channels of Modbus RTU for tests of commands.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "core/bus/command/command_job.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast {

using namespace std::chrono_literals;

class CommandJobTest : public testing::Test {
 protected:
  CommandJobTest() {
    device_.name = "press";
    device_.retries = 1;
    add("setpoint", {2, 100, 1}, {}, Access::kReadWrite);
    add("speed", {2, 101, 1}, {}, Access::kReadOnly);
    Encoding bit{ValueType::kBool};
    bit.bit = 3;
    add("lamp", {2, 102, 1}, bit, Access::kReadWrite);
    add("valve", {0, 7, 1}, {ValueType::kBool}, Access::kReadWrite);
    device_.channels[0].write_min = 0;
    device_.channels[0].write_max = 1000;
  }
  void add(const std::string& name, Range range, Encoding encoding, Access access) {
    ChannelSpec channel;
    channel.name = name;
    channel.range = range;
    channel.encoding = encoding;
    channel.access = access;
    device_.channels.push_back(channel);
  }
  Command write(const std::string& channel, Value value, bool verify = false) {
    Command command;
    command.device = "press";
    command.target = ChannelTarget{channel};
    command.values = {std::move(value)};
    command.verify = verify;
    return command;
  }
  tl::expected<CommandJob, CommandFault> make(const Command& command) {
    return CommandJob::make(command, device_, 0, 10, *protocol_);
  }
  static CommandResult result(const CommandJob& job) { return job.result(Instant{}, Instant{1s}); }
  static Reply items(Bytes bytes) { return {{Cause::kNone, 0, std::move(bytes)}}; }

  DeviceSpec device_;
  std::unique_ptr<Protocol> protocol_ = std::move(*find_protocol("modbus-rtu")->make({1, {}}));
};

}  // namespace fieldcast
