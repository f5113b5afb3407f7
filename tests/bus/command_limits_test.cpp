// Limits of commands: of values, which the device gets rounded, and of time.
#include <gtest/gtest.h>

#include "core/bus/command/command_job.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

class CommandLimits : public testing::Test {
 protected:
  ChannelSpec& channel(Encoding encoding, double min, double max) {
    device_.name = "press";
    device_.retries = 3;
    ChannelSpec channel;
    channel.name = "setpoint";
    channel.range = {2, 100, width_bits(encoding) / 16};
    channel.encoding = encoding;
    channel.access = Access::kReadWrite;
    channel.write_min = min;
    channel.write_max = max;
    device_.channels.push_back(channel);
    return device_.channels.back();
  }
  static Command write(Value value) {
    Command command;
    command.device = "press";
    command.target = ChannelTarget{"setpoint"};
    command.values = {std::move(value)};
    return command;
  }
  tl::expected<CommandJob, CommandFault> make(const Command& command) {
    return CommandJob::make(command, device_, 0, 0, *protocol_);
  }
  std::string reason_of(Value value) {
    const auto job = make(write(std::move(value)));
    return job ? "" : job.error().reason;
  }
  static Encoding scaled(double scale, double offset = 0) {
    Encoding encoding{ValueType::kInt16};
    encoding.scale = scale;
    encoding.offset = offset;
    return encoding;
  }

  DeviceSpec device_;
  std::unique_ptr<Protocol> protocol_ = std::move(*find_protocol("modbus-rtu")->make({1, {}}));
};

// A float32 of 293.15 is 293.14999.
TEST_F(CommandLimits, AFloatWithAnOffsetCanHaveItsLimit) {
  Encoding celsius{ValueType::kFloat32};
  celsius.offset = -273.15;
  channel(celsius, 20, 90);
  EXPECT_EQ(reason_of(20.0), "");
  EXPECT_EQ(reason_of(90.0), "");
  EXPECT_NE(reason_of(19.9999), "");
  EXPECT_NE(reason_of(90.0001), "");
}

// Regression: 16 was within the limits, and the device got 20.
TEST_F(CommandLimits, ValuesAreWithinTheLimitsAlsoAsTheDeviceGetsThem) {
  channel(scaled(10), 4, 16);
  EXPECT_EQ(reason_of(16.0),
            "20 (rounded from 16) is above the highest value allowed, 16 (write: max)");
  EXPECT_EQ(reason_of(4.0), "0 (rounded from 4) is below the lowest value allowed, 4 (write: min)");
  EXPECT_EQ(reason_of(14.0), "");
  EXPECT_EQ(reason_of(17.0),
            "20 (rounded from 17) is above the highest value allowed, 16 (write: max)");
}

TEST_F(CommandLimits, AnOffsetBelongsToTheValueThatTheDeviceGets) {
  channel(scaled(10, -5), 0, 100);
  EXPECT_EQ(reason_of(0.0),
            "-5 (rounded from 0) is below the lowest value allowed, 0 (write: min)");
}

// In a double, 3 * 0.1 is more than 0.3.
TEST_F(CommandLimits, TheLimitItselfIsAllowedWhereItIsAWholeRawNumber) {
  for (int raw = -3000; raw <= 3000; ++raw) {
    device_.channels.clear();
    const double limit =
        std::stod(std::to_string(raw / 10) + '.' + std::to_string(std::abs(raw % 10)));
    channel(scaled(0.1), limit, limit);
    EXPECT_EQ(reason_of(limit), "") << limit;
  }
}

TEST_F(CommandLimits, IntegersOf64BitsAreComparedExactly) {
  channel({ValueType::kUint64}, 9007199254740992.0, 9223372036854775808.0);
  EXPECT_EQ(reason_of(std::uint64_t{9007199254740992}), "");
  EXPECT_NE(reason_of(std::uint64_t{9007199254740991}), "");
  EXPECT_EQ(reason_of(std::uint64_t{9223372036854775808u}), "");
  EXPECT_NE(reason_of(std::uint64_t{9223372036854775809u}), "");
}

TEST_F(CommandLimits, AFloatOfTheLimitIsAllowed) {
  channel({ValueType::kFloat32}, -0.1, 0.1);
  EXPECT_EQ(reason_of(0.1), "");
  EXPECT_NE(reason_of(0.11), "");
}

// Regression: a write was sent again long after its requester had given up.
TEST_F(CommandLimits, AWriteIsNotRepeatedAfterItsExpiry) {
  channel({ValueType::kUint16}, 0, 1000);
  Command command = write(std::uint64_t{7});
  command.expires = Instant{1s};
  auto job = make(command);
  ASSERT_TRUE(job);
  for (const Duration read_back : {900ms, 1000ms}) {
    ASSERT_TRUE(std::holds_alternative<WriteRequest>(*job->next()));
    job->failed(Cause::kNoResponse, 0);
    ASSERT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
    job->responded({{Cause::kNone, 0, {0, 6}}}, Instant{read_back});
  }
  EXPECT_FALSE(job->next());
  const CommandResult result = job->result(Instant{}, Instant{1s});
  EXPECT_EQ(result.state, CommandState::kFailed);
  EXPECT_EQ(
      result.reason,
      "no response, and reading back shows a different value; not written again after its expiry");
  EXPECT_EQ(result.values, std::vector<Value>{Value{std::uint64_t{6}}});
}

}  // namespace
}  // namespace fieldcast
