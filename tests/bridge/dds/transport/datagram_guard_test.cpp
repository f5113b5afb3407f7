// The rules of the guard that need memory: participants, endpoints, fragments, addresses.
#include <gtest/gtest.h>

#include "tests/bridge/dds/transport/checked_guard.hpp"

namespace fieldcast {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): parts of datagrams

TEST(DatagramGuard, WhatIsValidReachesTheLibraryAsItCame) {
  Checked one;
  for (const NamedDatagram& valid : valid_datagrams()) {
    EXPECT_EQ(one.cause_of(valid.bytes), "none") << valid.name;
    EXPECT_TRUE(one.before.empty()) << valid.name;
    if (std::string(valid.name) == "endpoint") continue;  // the next test
    EXPECT_EQ(one.bytes, valid.bytes) << valid.name;
  }
}

TEST(DatagramGuard, TheDescriptionOfATypeReachesTheLibraryAsPadding) {
  Checked one;
  const Datagram whole = endpoint(1);
  ASSERT_EQ(one.cause_of(whole), "none");
  ASSERT_EQ(one.bytes.size(), whole.size());
  std::vector<std::size_t> different;
  for (std::size_t i = 0; i < whole.size(); ++i)
    if (whole[i] != one.bytes[i]) different.push_back(i);
  ASSERT_EQ(different.size(), 1U) << "0x0075 has an upper half of 0";
  EXPECT_EQ(whole[different[0]], 0x75);
  EXPECT_EQ(one.bytes[different[0]], 0);
  EXPECT_EQ(one.cause_of(one.bytes), "none") << "it is a valid datagram still";
}

TEST(SharedGuard, CountsRefusedDatagramsByCause) {
  SharedGuard guard{RtpsLimits{}};
  Datagram scratch;
  const RtpsFaultCounts before = refused_datagrams();
  for (const Datagram& one : {sample(0), sample(0), Datagram{}, sample(1)})
    (void)guard.check(one, {}, scratch);
  RtpsFaultCounts expected = before;
  expected[static_cast<std::size_t>(RtpsFault::kSequenceNumber)] += 2;
  expected[static_cast<std::size_t>(RtpsFault::kHeader)] += 1;
  EXPECT_EQ(refused_datagrams(), expected);
}

// A plant of 200 participants after a power cut: all start together, at one address.
TEST(DatagramGuard, APlantThatStartsImmediatelyIsNotRefused) {
  Checked one;
  for (std::uint32_t i = 0; i < 200; ++i)
    ASSERT_EQ(one.cause_of(announcement(numbered(i))), "none") << i;
  for (std::uint32_t i = 0; i < 200; ++i)
    for (std::uint32_t n = 0; n < 100; ++n)
      ASSERT_EQ(one.cause_of(endpoint(n, numbered(i))), "none") << i << ' ' << n;
  for (std::uint32_t i = 0; i < 200; ++i)
    ASSERT_EQ(one.cause_of(announcement(numbered(i))), "none") << i << " again";
  EXPECT_EQ(one.guard.participants(), 200U);
  EXPECT_EQ(one.guard.endpoints(), 20'000U);
}

TEST(DatagramGuard, NewParticipantsOfAnAddressAreBoundedInRate) {
  Checked one({.joins_per_second = 10});
  std::uint32_t number = 0;
  for (; number < 40; ++number)
    ASSERT_EQ(one.cause_of(announcement(numbered(number))), "none") << number;
  EXPECT_EQ(one.cause_of(announcement(numbered(number++))), "JOIN_RATE");
  EXPECT_EQ(one.cause_of(announcement(numbered(0))), "none") << "one that is there already";
  EXPECT_EQ(one.cause_of(announcement(numbered(number++)), 2), "none") << "another address";
  one.wait(std::chrono::seconds{1});
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(one.cause_of(announcement(numbered(number++))), "none") << i;
  EXPECT_EQ(one.cause_of(announcement(numbered(number))), "JOIN_RATE");
}

TEST(DatagramGuard, TheOldestWithoutEndpointsMakesRoom) {
  Checked one({.participants = 3});
  for (std::uint32_t i = 0; i < 3; ++i) ASSERT_EQ(one.cause_of(announcement(numbered(i))), "none");
  ASSERT_EQ(one.cause_of(endpoint(1, numbered(0))), "none");
  ASSERT_EQ(one.cause_of(announcement(numbered(3))), "none");
  // The guard reports to the library that number 1 has left: in its name, with its GUID, disposed.
  ASSERT_FALSE(one.before.empty());
  EXPECT_TRUE(std::equal(one.before.begin() + 8, one.before.begin() + 20, numbered(1).begin()));
  const Datagram left =
      list_of({{0x0070, guid_of(numbered(1), kParticipant)}, {0x0071, {0, 0, 0, 3}}});
  EXPECT_TRUE(std::equal(left.rbegin(), left.rend(), one.before.rbegin()));
  EXPECT_EQ(one.guard.participants(), 3U);
  EXPECT_EQ(one.guard.endpoints(), 1U);
}

TEST(DatagramGuard, WhoHasEndpointsStaysAndTheNewOneIsRefused) {
  Checked one({.participants = 2});
  for (std::uint32_t i = 0; i < 2; ++i) {
    ASSERT_EQ(one.cause_of(announcement(numbered(i))), "none");
    ASSERT_EQ(one.cause_of(endpoint(1, numbered(i))), "none");
  }
  EXPECT_EQ(one.cause_of(announcement(numbered(2))), "PARTICIPANTS");
  EXPECT_TRUE(one.before.empty());
  ASSERT_EQ(one.cause_of(goodbye(numbered(0))), "none");
  EXPECT_EQ(one.guard.endpoints(), 1U);
  EXPECT_EQ(one.cause_of(announcement(numbered(2))), "none");
  ASSERT_EQ(one.cause_of(endpoint(1, numbered(2))), "none");
}

// The lease of an announcement is 20 s.
TEST(DatagramGuard, WhoIsSilentBeyondItsLeaseMakesRoom) {
  Checked one({.participants = 2, .endpoints_in_all = 2});
  for (std::uint32_t i = 0; i < 2; ++i) {
    ASSERT_EQ(one.cause_of(announcement(numbered(i))), "none");
    ASSERT_EQ(one.cause_of(endpoint(1, numbered(i))), "none");
    one.wait(std::chrono::seconds{20});
  }
  EXPECT_EQ(one.cause_of(endpoint(2, numbered(1))), "none") << "number 0 is silent for 40 s";
  EXPECT_FALSE(one.before.empty());
  EXPECT_EQ(one.guard.endpoints(), 2U);
  ASSERT_EQ(one.cause_of(announcement(numbered(2))), "none");
  EXPECT_EQ(one.cause_of(announcement(numbered(3))), "none") << "number 2 has no endpoint";
  one.wait(std::chrono::seconds{31});
  EXPECT_EQ(one.cause_of(announcement(numbered(4))), "none");
  EXPECT_EQ(one.guard.endpoints(), 0U) << "number 1 was silent for the longest time";
}

TEST(DatagramGuard, EndpointsAreBoundedForAParticipantAndInAll) {
  Checked one({.endpoints = 3, .endpoints_in_all = 5});
  for (std::uint32_t i = 0; i < 2; ++i) ASSERT_EQ(one.cause_of(announcement(numbered(i))), "none");
  for (std::uint32_t n = 0; n < 3; ++n) ASSERT_EQ(one.cause_of(endpoint(n, numbered(0))), "none");
  EXPECT_EQ(one.cause_of(endpoint(3, numbered(0))), "ENDPOINTS");
  EXPECT_EQ(one.cause_of(endpoint(2, numbered(0))), "none") << "one that is there already";
  for (std::uint32_t n = 0; n < 2; ++n) ASSERT_EQ(one.cause_of(endpoint(n, numbered(1))), "none");
  EXPECT_EQ(one.cause_of(endpoint(2, numbered(1))), "ENDPOINTS") << "in all";
  EXPECT_EQ(one.cause_of(endpoint(1, numbered(9))), "none") << "the library ignores strangers";
  EXPECT_EQ(one.guard.endpoints(), 5U);
}

TEST(DatagramGuard, FragmentedSamplesThatBeginAreBoundedInBytes) {
  Checked one({.sample_bytes = 1 << 20, .fragment_bytes = 2 << 20});
  const auto begun = [](std::int64_t number) {
    return data_frag(1, 1, 1024, 1 << 20, 1024, 28, number);
  };
  ASSERT_EQ(one.cause_of(begun(1)), "none");
  ASSERT_EQ(one.cause_of(begun(2)), "none");
  EXPECT_EQ(one.cause_of(begun(3)), "FRAGMENT_MEMORY");
  EXPECT_EQ(one.cause_of(data_frag(2, 1, 1024, 1 << 20, 1024, 28, 2)), "none") << "begun";
  one.wait(std::chrono::seconds{5});
  EXPECT_EQ(one.cause_of(begun(3)), "none");
  EXPECT_EQ(one.cause_of(begun(4)), "FRAGMENT_MEMORY");
}

// CVE-2026-22590: the library copies the last fragment by the first one's sizes.
TEST(DatagramGuard, BehindAFragmentIsMemoryForAWholeSample) {
  DatagramGuard guard(RtpsLimits{});
  Datagram scratch;
  const Datagram fragment = data_frag(2, 1, 1024, 2000, 976);
  const auto verdict = guard.check(fragment, {}, Instant{std::chrono::seconds{1}}, scratch);
  ASSERT_FALSE(verdict.fault.has_value());
  EXPECT_EQ(verdict.bytes.data(), scratch.data());
  EXPECT_GE(scratch.capacity(), fragment.size() + RtpsLimits{}.sample_bytes);
}

// DDS Security: a changed byte makes a signed message invalid, and its sender is a member.
TEST(DatagramGuard, ASignedMessageReachesTheLibraryAsItCame) {
  const std::int64_t far = 2 * DatagramGuard::kStep;
  Datagram all = of_submessage(0x33, 1, Datagram(20, 1));
  all = joined(joined(all, heartbeat(far, far, 1)), gap(1, far));
  Datagram postfix(16, 3);
  put_all(postfix, words({0}));
  put_submessage(all, 0x34, 1, postfix);
  Checked secured({.secured = true}), plain;
  ASSERT_EQ(secured.cause_of(all), "none");
  EXPECT_EQ(secured.bytes, all);
  // Without DDS Security, the library reads the parts as if nothing protected them.
  plain.cause_of(all);
  EXPECT_NE(plain.bytes, all);
}

// CVE-2023-50257: the library believes each "has left", and each new address of a participant.
TEST(DatagramGuard, DiscoveryOfAParticipantComesFromItsAddress) {
  Checked one;
  ASSERT_EQ(one.cause_of(announcement(), 1), "none");
  ASSERT_EQ(one.cause_of(endpoint(1), 1), "none");
  Datagram disposal =
      data(kPublicationsWriter, 2,
           list_of({{0x0070, guid_of(kSender, {0, 0, 1, 3})}, {0x0071, {0, 0, 0, 3}}}), {});
  Datagram far = from(kSender, heartbeat(90, 90, 9));
  std::copy(kPublicationsWriter.begin(), kPublicationsWriter.end(), far.begin() + 28);
  for (const Datagram& forged : {goodbye(kSender), announcement(), endpoint(2), disposal, far})
    EXPECT_EQ(one.cause_of(forged, 2), "SENDER");
  EXPECT_EQ(one.guard.participants(), 1U);
  EXPECT_EQ(one.guard.endpoints(), 1U);
  EXPECT_EQ(one.cause_of(heartbeat(1, 9, 1), 2), "none") << "not of discovery";
  EXPECT_EQ(one.cause_of(disposal, 1), "none");
  EXPECT_EQ(one.guard.endpoints(), 0U);
  EXPECT_EQ(one.cause_of(goodbye(kSender), 1), "none");
  EXPECT_EQ(one.guard.participants(), 0U);
}

TEST(DatagramGuard, AParticipantSpeaksFromEachAddressAtWhichItReceives) {
  Checked one;
  const DatagramGuard::Address listed{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 192, 168, 0, 7};
  Datagram announced = announcement();
  const Datagram loopback{127, 0, 0, 1};
  const auto at =
      std::search(announced.begin() + 120, announced.end(), loopback.begin(), loopback.end());
  std::copy(listed.end() - 4, listed.end(), at);
  ASSERT_EQ(one.cause_of(announced, 1), "none");
  EXPECT_FALSE(one.guard.check(goodbye(kSender), listed, one.now, one.scratch).fault);
  EXPECT_EQ(one.guard.participants(), 0U);
}

// Its lease is 20 s, and the guard waits 10 s more.
TEST(DatagramGuard, AParticipantWhoseAddressChangesIsHeardAgain) {
  Checked one;
  ASSERT_EQ(one.cause_of(announcement(), 1), "none");
  one.wait(std::chrono::seconds{30});
  EXPECT_EQ(one.cause_of(announcement(), 2), "SENDER");
  one.wait(std::chrono::seconds{1});
  EXPECT_EQ(one.cause_of(announcement(), 2), "none");
  EXPECT_EQ(one.cause_of(goodbye(kSender), 1), "SENDER") << "the address of before";
}

TEST(DatagramGuard, ARelayedAnnouncementComesFromAnyAddress) {
  Checked one({.relayed = true});
  ASSERT_EQ(one.cause_of(announcement(), 1), "none");
  EXPECT_EQ(one.cause_of(goodbye(kSender), 2), "none");
}

// The library would remember the number of the message, and ignore the announcements that follow.
TEST(DatagramGuard, TheLibraryDoesNotReadThatAnUnknownParticipantHasLeft) {
  Checked one;
  Datagram expected = goodbye(kSender);
  EXPECT_EQ(one.cause_of(expected), "none");
  expected[20] = 1;  // PAD
  EXPECT_EQ(one.bytes, expected);
}

// The library keeps its list of missing fragments in 4 bytes of each one.
TEST(DatagramGuard, AShortLastFragmentHasRoomForTheListOfTheLibrary) {
  Checked one;
  for (std::uint32_t rest = 1; rest <= 3; ++rest) {
    ASSERT_EQ(one.cause_of(data_frag(1, 1, 1022, 1022 + rest, 1022)), "none");
    EXPECT_EQ(one.bytes, data_frag(1, 1, 1022, 1028, 1022)) << "the list is at 1024";
    ASSERT_EQ(one.cause_of(data_frag(2, 1, 1024, 1024 + rest, rest)), "none");
    EXPECT_EQ(one.bytes, data_frag(2, 1, 1024, 1028, rest));
    EXPECT_EQ(one.scratch.size(), one.bytes.size() + 8) << "zeros that the library reads";
  }
}

// Announcements need no login, so a sender can have as many participants as the limit allows.
TEST(DatagramGuard, StoredAcknowledgementsOfAllParticipantsAreBounded) {
  constexpr std::uint32_t kParticipants = 80, kPairs = 4'000, kOfOneDatagram = 2'000;
  Checked one;
  for (std::uint32_t participant = 0; participant < kParticipants; ++participant) {
    ASSERT_EQ(one.cause_of(announcement(numbered(participant))), "none") << participant;
    Datagram datagram;
    for (std::uint32_t pair = 0; pair < kPairs; ++pair) {
      if (pair % kOfOneDatagram == 0) datagram = header(numbered(participant));
      Datagram body{0, static_cast<std::uint8_t>(pair >> 8), static_cast<std::uint8_t>(pair), 4};
      put_all(body, kSamplesWriter);
      put_number(body, 1);
      put_all(body, words({0, 1}));  // no missing number, count
      put_submessage(datagram, 0x06, 1, body);
      if ((pair + 1) % kOfOneDatagram != 0) continue;
      ASSERT_EQ(one.cause_of(datagram), "none") << pair;
    }
  }
  EXPECT_GT(one.guard.acknowledged(), 200'000U);
  EXPECT_LT(one.guard.acknowledged(), 270'000U);
  for (std::uint32_t participant = 0; participant < kParticipants; ++participant)
    ASSERT_EQ(one.cause_of(goodbye(numbered(participant))), "none");
  EXPECT_EQ(one.guard.acknowledged(), 0U);
}

// Regression: a station that was suspended beyond its lease received no discovery of the bridge any
// more. The bridge had kept the acknowledgements of a reader that the station had created again.
TEST(DatagramGuard, AReaderThatBeginsAgainReceivesEverythingAgain) {
  Checked one;
  const auto begin = [](Datagram acknowledgement) {
    std::fill_n(acknowledgement.begin() + 32, 12, 0);  // number 0, no missing numbers
    std::copy_n(acknowledgement.end() - 4, 4, acknowledgement.begin() + 44);
    acknowledgement[21] &= 0xfd;  // not final: it requests a HEARTBEAT
    return acknowledgement;
  };
  const auto expect_unchanged = [&](const Datagram& acknowledgement) {
    ASSERT_EQ(one.cause_of(acknowledgement), "none");
    EXPECT_EQ(one.bytes, acknowledgement);
  };
  expect_unchanged(acknack(9, {}, 1));
  expect_unchanged(acknack(3, {0xf8000000}, 2));  // of a participant that the library does not know
  ASSERT_EQ(one.cause_of(announcement()), "none");
  expect_unchanged(acknack(9, {}, 3));
  expect_unchanged(acknack(3, {0xf8000000}, 2));  // it came late
  expect_unchanged(acknack(9, {0x80000000}, 4));
  Datagram below = acknack(3, {0xf8000000}, 5);
  below[21] |= 2;
  ASSERT_EQ(one.cause_of(below), "none");
  EXPECT_EQ(one.bytes, begin(below));
  EXPECT_FALSE(fault_of(one.bytes, {}).has_value());
  expect_unchanged(acknack(3, {0xf8000000}, 6));
  expect_unchanged(acknack(9, {}, 7));
  ASSERT_EQ(one.cause_of(goodbye(kSender)), "none");
  ASSERT_EQ(one.cause_of(announcement()), "none");
  expect_unchanged(acknack(3, {0xf8000000}, 8));
}

}  // namespace
}  // namespace fieldcast
