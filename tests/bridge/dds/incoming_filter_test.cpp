#include "bridge/dds/filter/incoming_filter.hpp"

#include <gtest/gtest.h>

#include <random>
#include <thread>

namespace fieldcast {
namespace {

using Bytes = IncomingFilter::Bytes;

constexpr security::GuidStart kSubject{0x91, 2, 3, 4, 5, 6};

// RTPS 2.2, 9.4: the header, followed by the submessages.
Bytes message(std::initializer_list<std::uint8_t> submessages, std::uint8_t first = 0x91) {
  Bytes bytes{'R', 'T', 'P', 'S', 2, 2, 1, 15, first, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  bytes.insert(bytes.end(), submessages);
  return bytes;
}
// 15 flags length | extra to-inline-qos | reader | writer | sequence, little-endian
Bytes data_of(std::uint8_t writer_2, std::uint8_t writer_3, std::uint8_t writer_4,
              std::uint8_t high = 0) {
  return message({0x15, 5, 20, 0,    0, 0, 16, 0, 0, 0, 0, 0, 0, writer_2, writer_3, writer_4,  //
                  0,    0, 0,  high, 1, 0, 0,  0});
}

TEST(IncomingFilter, DiscoveryHandshakeAndProtectedSubmessagesMayBeInClear) {
  EXPECT_TRUE(may_be_in_clear(data_of(1, 0, 0xc2)));
  EXPECT_TRUE(may_be_in_clear(data_of(2, 1, 0xc3)));
  EXPECT_TRUE(may_be_in_clear(message({0x09, 1, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_TRUE(may_be_in_clear(message({0x31, 1, 4, 0, 0, 0, 0, 0, 0x30, 1, 4, 0, 0, 0, 0, 0})));
}

TEST(IncomingFilter, NothingElseMayBeInClear) {
  EXPECT_FALSE(may_be_in_clear(data_of(0, 1, 3))) << "samples";
  EXPECT_FALSE(may_be_in_clear(data_of(0, 3, 0xc2))) << "discovery of endpoints";
  EXPECT_FALSE(may_be_in_clear(data_of(2, 0, 0xc2))) << "liveliness";
  EXPECT_FALSE(may_be_in_clear(message({0x0c, 1, 20, 0}))) << "another sender's name";
  EXPECT_FALSE(may_be_in_clear(message({0x07, 1, 28, 0, 0, 0, 0, 0, 0, 0, 1, 3, 0, 0, 0, 0})))
      << "a heartbeat of samples";
  Bytes both = message({0x09, 1, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  const Bytes sample = data_of(0, 1, 3);
  both.insert(both.end(), sample.begin() + 20, sample.end());
  EXPECT_FALSE(may_be_in_clear(both)) << "behind something harmless";
  EXPECT_FALSE(may_be_in_clear(message({0x15, 5, 20}))) << "cut off";
  EXPECT_FALSE(may_be_in_clear(data_of(1, 0, 0xc2, 0x40))) << "a number of ours";
}

// Also runs under the sanitizers, which detect reads beyond the end of a message.
TEST(IncomingFilter, AnyBytesAreTakenOrNot) {
  std::mt19937 random(1);
  const Bytes samples = data_of(0, 1, 3);
  std::size_t taken = 0;
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes = data_of(1, 0, 0xc2);
    if (i % 2 == 0) bytes.insert(bytes.end(), samples.begin() + 20, samples.end());
    for (unsigned n = random() % 4; n > 0; --n)
      bytes[20 + random() % (bytes.size() - 20)] = static_cast<std::uint8_t>(random());
    bytes.resize(20 + random() % (bytes.size() - 19));
    bytes.shrink_to_fit();
    taken += may_be_in_clear(bytes);
  }
  EXPECT_GT(taken, 1000U);
  EXPECT_LT(taken, 99'000U);
}

TEST(IncomingFilter, WhatIsInClearIsTakenOnlyWhereMessagesAreNotProtected) {
  IncomingFilter filter(true);
  EXPECT_FALSE(filter.takes(data_of(0, 1, 3)));
  EXPECT_EQ(filter.refused_in_clear(), 1U);
  EXPECT_TRUE(IncomingFilter(false).takes(data_of(0, 1, 3)));
  EXPECT_TRUE(IncomingFilter(true).takes(message({0x33, 1, 20, 0}))) << "protected as a whole";
  EXPECT_FALSE(IncomingFilter(true).takes(Bytes{'R', 'T', 'P', 'S'}));
}

TEST(IncomingFilter, WhoIsRefusedIsNotHeardAndLeavesOnceForEachThread) {
  IncomingFilter filter(true);
  const Bytes revoked = data_of(1, 0, 0xc2);
  const Bytes other = message({0x33, 1, 20, 0}, 0x92);
  EXPECT_TRUE(filter.takes(revoked));
  EXPECT_TRUE(filter.takes(other));
  EXPECT_TRUE(filter.goodbyes().empty());
  filter.refuse(kSubject);
  EXPECT_FALSE(filter.takes(revoked));
  EXPECT_TRUE(filter.takes(other));
  EXPECT_EQ(filter.goodbyes().size(), 1U);
  EXPECT_TRUE(filter.goodbyes().empty());
  std::thread([&] { EXPECT_EQ(filter.goodbyes().size(), 1U); }).join();
  EXPECT_FALSE(filter.goodbye_of_sender(revoked).empty());
  EXPECT_TRUE(filter.goodbye_of_sender(other).empty());
}

TEST(IncomingFilter, AGoodbyeIsTheNoteOfTheParticipantItself) {
  IncomingFilter filter(true);
  filter.refuse(kSubject);
  const Bytes bytes = filter.goodbye_of_sender(data_of(1, 0, 0xc2));
  const Bytes expected = message({
      0x15, 3, 52, 0,                                              // data with inline QoS
      0,    0, 16, 0,                                              // offset behind the number
      0,    1, 0,  0xc7, 0,    1, 0, 0xc2,                         // of participants
      0,    0, 0,  0x40, 1,    0, 0, 0,                            // the number
      0x70, 0, 16, 0,    0x91, 2, 3, 4,    5, 6, 7, 8, 9, 10, 11,  // the key
      12,   0, 0,  1,    0xc1,                                     //
      0x71, 0, 4,  0,    0,    0, 0, 3,                            // disposed and unregistered
      1,    0, 0,  0,                                              // the end
  });
  EXPECT_EQ(bytes, expected);
}

}  // namespace
}  // namespace fieldcast
