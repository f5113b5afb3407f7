// Writes of a bit that need the word around it (read, change, write).
#include <gtest/gtest.h>

#include "core/bus/command/command_job.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast {
namespace {

Reply items(Bytes bytes) { return {{Cause::kNone, 0, std::move(bytes)}}; }

// Regression: the second write restored the other bits as they were before the first one.
TEST(BitWrite, ARepeatedWriteKeepsTheOtherBitsThatWereReadLast) {
  const auto protocol = std::move(*find_protocol("modbus-rtu")->make({1, {}}));
  DeviceSpec device;
  device.name = "press";
  device.retries = 1;
  ChannelSpec lamp;
  lamp.name = "lamp";
  lamp.range = {2, 102, 1};
  lamp.encoding.type = ValueType::kBool;
  lamp.encoding.bit = 3;
  lamp.access = Access::kReadWrite;
  device.channels.push_back(lamp);
  Command command;
  command.device = "press";
  command.target = ChannelTarget{"lamp"};
  command.values = {Value{true}};

  auto job = CommandJob::make(command, device, 0, 0, *protocol);
  ASSERT_TRUE(job) << job.error().reason;
  job->responded(items({0x00, 0x00}), {});
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{0x00, 0x08}));
  job->failed(Cause::kNoResponse, 0);
  ASSERT_TRUE(std::holds_alternative<ReadRequest>(*job->next()));
  job->responded(items({0x01, 0x10}), {});  // the device has set two bits of its own
  EXPECT_EQ(std::get<WriteRequest>(*job->next()).items, (Bytes{0x01, 0x18}));
  job->responded({{}}, {});
  EXPECT_FALSE(job->next());
  EXPECT_EQ(job->result({}, {}).state, CommandState::kDone);
}

}  // namespace
}  // namespace fieldcast
