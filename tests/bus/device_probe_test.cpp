#include "core/bus/command/device_probe.hpp"

#include <gtest/gtest.h>

#include "tests/bus/rtu_bus.hpp"

namespace fieldcast {
namespace {

using namespace std::chrono_literals;

constexpr Instant kLimit{5s};

CommandResult result_of(const Command& command, Cause cause) {
  CommandResult result;
  result.request_id = command.request_id;
  result.state = cause == Cause::kNone ? CommandState::kDone : CommandState::kFailed;
  result.cause = cause;
  result.reason = cause == Cause::kNone ? "" : std::string(to_text(cause));
  if (cause == Cause::kNone) result.values = {Value{std::uint64_t{7}}};
  result.started = Instant{1s};
  result.completed = Instant{1s + 30ms};
  return result;
}

std::string channel_of(const Command& command) {
  return command.ad_hoc->name + '/' + std::get<ChannelTarget>(command.target).name;
}

// Every request has this result. Returns what was requested.
std::vector<std::string> run(DeviceProbe& probe, Cause cause) {
  std::vector<std::string> requested;
  while (const auto command = probe.next()) {
    requested.push_back(channel_of(*command));
    EXPECT_EQ(command->request_id, requested.size());
    EXPECT_EQ(command->expires, kLimit);
    EXPECT_TRUE(command->in_spare_time());
    probe.on_result(result_of(*command, cause));
  }
  return requested;
}

TEST(DeviceProbe, ReadsEachChannelOfEachDevice) {
  DeviceProbe probe(test::rtu_bus(2).devices, kLimit);
  EXPECT_EQ(run(probe, Cause::kNone),
            (std::vector<std::string>{"unit-1/r0", "unit-1/r1", "unit-1/r2", "unit-1/r3",
                                      "unit-2/r0", "unit-2/r1", "unit-2/r2", "unit-2/r3"}));
  const ProbedChannel& last = probe.devices().back().channels.back();
  EXPECT_EQ(last.value, Value{std::uint64_t{7}});
  EXPECT_EQ(last.took, 30ms);
  EXPECT_TRUE(last.responded);
}

TEST(DeviceProbe, LeavesASilentDeviceAndADeviceThatHasResponded) {
  DeviceProbe silent(test::rtu_bus(2).devices, kLimit);
  EXPECT_EQ(run(silent, Cause::kNoResponse),
            (std::vector<std::string>{"unit-1/r0", "unit-1/r1", "unit-2/r0", "unit-2/r1"}));
  DeviceProbe refusing(test::rtu_bus(2).devices, kLimit, 4);
  EXPECT_EQ(run(refusing, Cause::kDeviceError),
            (std::vector<std::string>{"unit-1/r0", "unit-2/r0"}));
  EXPECT_TRUE(refusing.devices().front().channels.front().responded);
}

// The first two of the four channels are questions.
TEST(DeviceProbe, ReadsTheChannelsBehindTheQuestionsOfADeviceThatResponds) {
  const auto devices = test::rtu_bus(1).devices;
  DeviceProbe responding(devices, kLimit, 2);
  EXPECT_EQ(run(responding, Cause::kNone),
            (std::vector<std::string>{"unit-1/r0", "unit-1/r2", "unit-1/r3"}));
  DeviceProbe refusing(devices, kLimit, 2);
  EXPECT_EQ(run(refusing, Cause::kDeviceError),
            (std::vector<std::string>{"unit-1/r0", "unit-1/r2"}))
      << "a refused identity ends there";
  for (const Cause cause : {Cause::kNoResponse, Cause::kChecksum}) {
    DeviceProbe silent(devices, kLimit, 2);
    EXPECT_EQ(run(silent, cause), (std::vector<std::string>{"unit-1/r0", "unit-1/r1"}));
  }
}

TEST(DeviceProbe, EndsWhenTheBusCannotSend) {
  for (const Cause cause : {Cause::kExpired, Cause::kLeased, Cause::kShutdown, Cause::kOffline}) {
    DeviceProbe probe(test::rtu_bus(2).devices, kLimit);
    EXPECT_EQ(run(probe, cause), std::vector<std::string>{"unit-1/r0"}) << to_text(cause);
    EXPECT_EQ(probe.devices().size(), 1u);
  }
}

// The first is a fault of the items that the device sent, the second one of the request.
TEST(DeviceProbe, ARangeFaultIsAResponseIfTheRequestWasSent) {
  for (const CommandState state : {CommandState::kFailed, CommandState::kRejected}) {
    DeviceProbe probe(test::rtu_bus(1).devices, kLimit);
    CommandResult result = result_of(*probe.next(), Cause::kRange);
    result.state = state;
    probe.on_result(result);
    EXPECT_EQ(probe.devices()[0].channels[0].responded, state == CommandState::kFailed);
  }
}

TEST(DeviceProbe, ADeviceWithoutChannelsIsLeftOut) {
  auto devices = test::rtu_bus(2).devices;
  devices[0].channels.resize(0);
  DeviceProbe probe(devices, kLimit);
  EXPECT_EQ(run(probe, Cause::kNoResponse), (std::vector<std::string>{"unit-2/r0", "unit-2/r1"}));
}

TEST(DeviceProbe, IsBounded) {
  BusSpec bus = test::rtu_bus(100);
  DeviceProbe probe(bus.devices, kLimit, 4);
  EXPECT_EQ(run(probe, Cause::kNone).size(), DeviceProbe::kMostDevices);
  bus.devices.front().channels.own().resize(500, bus.devices.front().channels.front());
  DeviceProbe long_device({bus.devices.front()}, kLimit);
  EXPECT_EQ(run(long_device, Cause::kNone).size(), DeviceProbe::kMostChannels);
  EXPECT_FALSE(DeviceProbe({}, kLimit).next());
}

}  // namespace
}  // namespace fieldcast
