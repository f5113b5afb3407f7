#include "bridge/dds/topics/topic_type.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <thread>

#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {
namespace {

using rtps::InstanceHandle_t;
using rtps::SerializedPayload_t;

idl::Command long_command() {
  Command command;
  command.requester = "r";
  command.request_id = 7;
  command.device = "d";
  command.target = ChannelTarget{"c"};
  command.values = {true, std::string("text"), 2.5};
  idl::Command topic;
  EXPECT_TRUE(to_idl("b", command, topic));
  return topic;
}

std::vector<std::uint8_t> bytes_of(TopicType<idl::CommandPubSubType>& type, idl::Command& command) {
  SerializedPayload_t payload(type.largest());
  EXPECT_TRUE(type.to_bytes(&command, payload));
  return {payload.data, payload.data + payload.length};
}

bool read(TopicType<idl::CommandPubSubType>& type, const std::vector<std::uint8_t>& bytes,
          idl::Command& out) {
  SerializedPayload_t payload(static_cast<std::uint32_t>(std::max<std::size_t>(bytes.size(), 1)));
  if (!bytes.empty()) std::memcpy(payload.data, bytes.data(), bytes.size());
  payload.length = static_cast<std::uint32_t>(bytes.size());
  return type.from_bytes(payload, &out);
}

TEST(TopicType, AMessageWithAKeyMayBeLongerThanTheFirstAllocation) {
  EXPECT_FALSE(TopicType<idl::ReadPlanPubSubType>().is_bounded());
  EXPECT_FALSE(TopicType<idl::BridgePubSubType>().is_bounded());
  EXPECT_FALSE(TopicType<idl::InterestPubSubType>().is_bounded());
}

TEST(TopicType, KeysOfManyThreadsDoNotMix) {
  TopicType<idl::SamplePubSubType> type;
  const auto key_of = [&](int channel) {
    idl::Sample sample;
    sample.bus() = "bus";
    sample.channel() = "channel-" + std::to_string(channel);
    InstanceHandle_t handle;
    EXPECT_TRUE(type.key_of(&sample, handle, false));
    return handle;
  };
  std::vector<std::thread> threads;
  std::atomic<int> wrong{0};
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      const InstanceHandle_t mine = key_of(t);
      for (int i = 0; i < 20'000; ++i) wrong += key_of(t) != mine;
    });
  }
  for (auto& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_NE(key_of(1), key_of(2));
}

// The padding after "bus" must not contain bytes of an earlier, longer key.
TEST(TopicType, KeyDoesNotDependOnTheKeyBefore) {
  TopicType<idl::SamplePubSubType> type;
  const auto key_of = [&](const std::string& bus) {
    idl::Sample sample;
    sample.bus() = bus;
    sample.device() = "d";
    InstanceHandle_t handle;
    EXPECT_TRUE(type.key_of(&sample, handle, false));
    return handle;
  };
  const InstanceHandle_t first = key_of("b");
  (void)key_of("quite another and longer name");
  EXPECT_EQ(key_of("b"), first);
}

TEST(TopicType, EveryTruncationIsRefused) {
  TopicType<idl::CommandPubSubType> type;
  idl::Command command = long_command(), out;
  const auto bytes = bytes_of(type, command);
  ASSERT_TRUE(read(type, bytes, out));
  EXPECT_EQ(out.values().size(), 3u);
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(
        read(type, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)}, out))
        << length << " bytes";
  }
}

TEST(TopicType, DamagedBytesNeverEndTheProcess) {
  TopicType<idl::CommandPubSubType> type;
  idl::Command command = long_command();
  const auto bytes = bytes_of(type, command);
  std::mt19937 random(1);
  for (int round = 0; round < 20'000; ++round) {
    auto damaged = bytes;
    for (int i = 0; i < 3; ++i)
      damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    idl::Command out;
    if (read(type, damaged, out))
      (void)from_idl(out);  // rejected, or a command that the conversion can check
  }
}

TEST(TopicType, LongerThanTheTypeCanBeIsRefused) {
  TopicType<idl::CommandPubSubType> type;
  idl::Command command = long_command(), out;
  auto bytes = bytes_of(type, command);
  bytes.resize(type.largest() + 1);
  EXPECT_FALSE(read(type, bytes, out));
}

}  // namespace
}  // namespace fieldcast
