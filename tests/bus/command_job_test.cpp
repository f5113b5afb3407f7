#include "core/bus/command_job.hpp"

#include <gtest/gtest.h>

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

// A device with one writable register, one read-only, one bit of a register and one coil.
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

TEST_F(CommandJobTest, WriteIsDoneWhenTheDeviceConfirms) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  ASSERT_TRUE(job);
  const auto request = job->next();
  EXPECT_EQ(std::get<WriteRequest>(*request).items, (Bytes{0x01, 0xF4}));
  job->answered({{}});
  EXPECT_FALSE(job->next());
  EXPECT_EQ(result(*job).state, CommandState::kDone);
  EXPECT_EQ(job->written_channel(), ChannelIndex{10});
}

TEST_F(CommandJobTest, VerifyReadsBack) {
  auto job = make(write("setpoint", std::uint64_t{500}, true));
  job->answered({{}});
  ASSERT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
  job->answered(items({0x01, 0xF4}));
  EXPECT_EQ(result(*job).state, CommandState::kVerified);
  EXPECT_EQ(result(*job).values, (std::vector<Value>{std::uint64_t{500}}));
}

TEST_F(CommandJobTest, AnotherValueReadBackIsAFailure) {
  auto job = make(write("setpoint", std::uint64_t{500}, true));
  job->answered({{}});
  job->answered(items({0x00, 0x01}));
  EXPECT_EQ(result(*job).state, CommandState::kFailed);
  EXPECT_EQ(result(*job).cause, Cause::kNotVerified);
}

TEST_F(CommandJobTest, UnansweredWriteIsReadBackNotRepeated) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  job->failed(Cause::kNoAnswer, 0);
  ASSERT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
  job->answered(items({0x01, 0xF4}));
  EXPECT_EQ(result(*job).state, CommandState::kDone);
}

TEST_F(CommandJobTest, WriteThatDidNotTakeEffectIsRepeatedWithinTheRetries) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  job->failed(Cause::kNoAnswer, 0);
  job->answered(items({0x00, 0x00}));
  ASSERT_TRUE(std::holds_alternative<WriteRequest>(*job->next()));
  job->failed(Cause::kNoAnswer, 0);
  job->answered(items({0x00, 0x00}));
  EXPECT_EQ(result(*job).state, CommandState::kFailed);
  EXPECT_EQ(result(*job).cause, Cause::kNoAnswer);
}

TEST_F(CommandJobTest, SilenceAfterAnUnansweredWriteLeavesItOpen) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  job->failed(Cause::kNoAnswer, 0);
  job->failed(Cause::kNoAnswer, 0);
  EXPECT_EQ(result(*job).state, CommandState::kFailed);
  EXPECT_NE(result(*job).reason.find("unknown whether"), std::string::npos);
}

TEST_F(CommandJobTest, RefusedWriteIsNotRepeated) {
  auto job = make(write("setpoint", std::uint64_t{500}));
  job->failed(Cause::kDeviceError, 4);
  EXPECT_FALSE(job->next());
  EXPECT_EQ(result(*job).cause, Cause::kDeviceError);
  EXPECT_EQ(result(*job).device_code, 4);
}

TEST_F(CommandJobTest, BitOfAWordKeepsTheOtherBits) {
  auto job = make(write("lamp", true));
  ASSERT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
  job->answered(items({0xA0, 0x51}));
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{0xA0, 0x59}));
  job->answered({{}});
  EXPECT_EQ(result(*job).state, CommandState::kDone);
}

TEST_F(CommandJobTest, BitOfAWordIsOneRequestWhereTheDeviceMasks) {
  protocol_ = std::move(*find_protocol("modbus-rtu")->make({1, {{"mask-write", "true"}}}));
  auto job = make(write("lamp", true));
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).bit, 3);
}

TEST_F(CommandJobTest, EachFaultHasItsCause) {
  EXPECT_EQ(make(write("speed", std::uint64_t{1})).error().cause, Cause::kReadOnly);
  EXPECT_EQ(make(write("nothing", std::uint64_t{1})).error().cause, Cause::kUnknownChannel);
  EXPECT_EQ(make(write("setpoint", std::string{"x"})).error().cause, Cause::kWrongType);
  EXPECT_EQ(make(write("setpoint", std::uint64_t{70000})).error().cause, Cause::kRange);
  EXPECT_EQ(make(write("setpoint", std::uint64_t{1001})).error().cause, Cause::kRange);
  Command raw = write("", std::uint64_t{1});
  raw.target = AddressTarget{"holding:5", {}};
  EXPECT_EQ(make(raw).error().cause, Cause::kRawNotAllowed);
  device_.allow_raw_write = true;
  EXPECT_TRUE(make(raw));
  raw.target = AddressTarget{"holding:99999", {}};
  EXPECT_EQ(make(raw).error().cause, Cause::kBadAddress);
  raw.target = AddressTarget{"input-register:5", {}};
  EXPECT_EQ(make(raw).error().cause, Cause::kReadOnly);
}

TEST_F(CommandJobTest, WholeDeviceIsAcquiredInFewReads) {
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  command.target = ChannelTarget{};
  auto job = make(command);
  ASSERT_TRUE(job);
  job->answered(items({1}));                                   // the coil
  job->answered(items({0x00, 0x05, 0x00, 0x06, 0x00, 0x08}));  // three registers side by side
  EXPECT_FALSE(job->next());
  EXPECT_EQ(result(*job).values, (std::vector<Value>{std::uint64_t{5}, std::uint64_t{6}, true, true}));
  EXPECT_EQ(job->acquired().size(), 4u);
}

TEST_F(CommandJobTest, AddressesAreAcquiredAsOftenAsAsked) {
  device_.allow_raw_read = true;
  Command command;
  command.operation = Operation::kAcquire;
  command.device = "press";
  command.target = AddressTarget{"holding:200", {}};
  command.count = 300;
  auto job = make(command);
  ASSERT_TRUE(job);
  std::size_t reads = 0;
  while (const auto request = job->next()) {
    const Range range = std::get<ReadRequest>(*request).ranges.front();
    job->answered(items(Bytes(2 * range.count, 0)));
    ++reads;
  }
  EXPECT_EQ(reads, 3u);
  EXPECT_EQ(result(*job).values.size(), 300u);
}

}  // namespace
}  // namespace fieldcast
