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

// The announcement of a participant (RTPS 2.2, 8.5.3.3) with the identity token of DDS Security
// 1.1, 9.3.2.1, in the byte order of its parameter list.
Bytes announcement(const security::Subject& subject, bool little = true, bool inline_qos = false) {
  const security::GuidStart start = security::guid_start(subject);
  Bytes bytes{'R', 'T', 'P', 'S', 2, 2, 1, 15};
  bytes.insert(bytes.end(), start.begin(), start.end());
  bytes.insert(bytes.end(), {7, 8, 9, 10, 11, 12});
  Bytes data{0, 0, 16, 0, 0, 0, 0, 0, 0, 1, 0, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0};
  if (inline_qos) data.insert(data.end(), {0x71, 0, 4, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  Bytes token, list{0, static_cast<std::uint8_t>(little ? 3 : 2), 0, 0};
  const auto number = [little](Bytes& to, std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i)
      to.push_back(static_cast<std::uint8_t>(value >> 8 * (little ? i : size - 1 - i)));
  };
  const auto text = [&](std::string_view one) {
    number(token, static_cast<std::uint32_t>(one.size() + 1), 4);
    token.insert(token.end(), one.begin(), one.end());
    do token.push_back(0);
    while (token.size() % 4 != 0);
  };
  text("DDS:Auth:PKI-DH:1.0");
  number(token, 2, 4);
  text("dds.cert.algo");
  text("EC-prime256v1");
  text("dds.cert.sn");
  text("/O=Fieldcast/OU=plant/CN=" + subject.common_name());
  number(list, 0x1001, 2);
  number(list, static_cast<std::uint32_t>(token.size()), 2);
  list.insert(list.end(), token.begin(), token.end());
  number(list, 1, 4);
  data.insert(data.end(), list.begin(), list.end());
  const std::uint8_t flags = inline_qos ? 7 : 5;
  bytes.insert(bytes.end(), {0x15, flags, static_cast<std::uint8_t>(data.size()), 0});
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

ParticipantPrefix sender_of(const Bytes& message) {
  ParticipantPrefix prefix{};
  std::copy_n(message.begin() + 8, prefix.size(), prefix.begin());
  return prefix;
}

const security::Subject kMes =
    security::subject_for({.role = security::MemberRole::kPlant, .name = "mes"});

TEST(IncomingFilter, TheSubjectInAnAnnouncementIsStored) {
  for (const Bytes& bytes :
       {announcement(kMes), announcement(kMes, false), announcement(kMes, true, true)}) {
    IncomingFilter filter(true);
    EXPECT_EQ(filter.subject_of(sender_of(bytes)), "");
    EXPECT_TRUE(filter.takes(bytes));
    EXPECT_EQ(filter.subject_of(sender_of(bytes)),
              "/O=Fieldcast/OU=plant/CN=" + kMes.common_name());
  }
}

TEST(IncomingFilter, ASubjectWithAnotherHashThanTheGuidIsNotStored) {
  Bytes bytes = announcement(kMes);
  bytes[8] ^= 1;
  IncomingFilter filter(true);
  EXPECT_TRUE(filter.takes(bytes));
  EXPECT_EQ(filter.subject_of(sender_of(bytes)), "");
}

// Also runs under the sanitizers, which detect reads beyond the end of a message.
TEST(IncomingFilter, AnAnnouncementOfAnyBytesIsReadWithinTheMessage) {
  std::mt19937 random(1);
  IncomingFilter filter(true);
  std::size_t stored = 0;
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = announcement(kMes, i % 2 == 0, i % 3 == 0);
    bytes[14] = static_cast<std::uint8_t>(i);  // each is a participant of its own
    bytes[15] = static_cast<std::uint8_t>(i >> 8);
    for (unsigned n = random() % 4; n > 0; --n)
      bytes[20 + random() % (bytes.size() - 20)] = static_cast<std::uint8_t>(random());
    if (random() % 2 == 0) bytes.resize(20 + random() % (bytes.size() - 19));
    bytes.shrink_to_fit();
    (void)filter.takes(bytes);
    stored += filter.subject_of(sender_of(bytes)).empty() ? 0 : 1;
  }
  EXPECT_GT(stored, 1000U);
  EXPECT_LT(stored, 19'000U);
}

}  // namespace
}  // namespace fieldcast
