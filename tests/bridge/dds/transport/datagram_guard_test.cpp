// The rules of the guard that need memory, in virtual time.
#include "bridge/dds/guard/datagram_guard.hpp"

#include <gtest/gtest.h>

#include <map>

#include "bridge/dds/guard/rtps_cursor.hpp"
#include "tests/bridge/dds/transport/recorded_datagrams.hpp"
#include "tests/bridge/dds/transport/rtps_datagrams.hpp"
#include "tests/campaign/rtps_mutation.hpp"

namespace fieldcast {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): parts of datagrams

ParticipantPrefix numbered(std::uint32_t number) {
  ParticipantPrefix prefix = kSender;
  for (std::size_t i = 0; i < 4; ++i) prefix[8 + i] = static_cast<std::uint8_t>(number >> 8 * i);
  return prefix;
}

struct Checked {
  explicit Checked(const RtpsLimits& limits = {}) : guard(limits) {}

  std::string cause_of(const Datagram& datagram, std::uint8_t address = 1) {
    const auto verdict = guard.check(datagram, {address}, now, scratch);
    bytes.assign(verdict.bytes.begin(), verdict.bytes.end());
    before = verdict.before;
    return verdict.fault ? std::string(to_text(*verdict.fault)) : "none";
  }
  void wait(Duration time) { now += time; }

  DatagramGuard guard;
  Instant now{std::chrono::seconds{1000}};
  Datagram scratch, bytes, before;
};

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

// CVE-2025-65016: the library counts up to the first number of a HEARTBEAT, one by one.
TEST(DatagramGuard, AHeartbeatThatJumpsFarIsRefused) {
  constexpr auto kFarthest = DatagramGuard::kFarthest, kJump = DatagramGuard::kJump;
  Checked one;
  EXPECT_EQ(one.cause_of(heartbeat(kFarthest + 1, kFarthest + 1, 1)), "SEQUENCE_NUMBER");
  EXPECT_EQ(one.cause_of(heartbeat(1, 100, 1)), "none");
  EXPECT_EQ(one.cause_of(heartbeat(1, 100 + kJump, 2)), "none");
  EXPECT_EQ(one.cause_of(heartbeat(1, 101 + 2 * kJump, 3)), "SEQUENCE_NUMBER");
  one.wait(std::chrono::seconds{110});  // the writer was silent, and went on meanwhile
  EXPECT_EQ(one.cause_of(heartbeat(1, 101 + 2 * kJump, 3)), "none");
}

// CVE-2025-65016 in small steps: the library counts each number, so jumps in a row are bounded too.
TEST(DatagramGuard, JumpsInARowShareOneCredit) {
  constexpr auto kJump = DatagramGuard::kJump;
  Checked one;
  ASSERT_EQ(one.cause_of(heartbeat(1, 100, 1)), "none");
  ASSERT_EQ(one.cause_of(heartbeat(1, 100 + kJump, 2)), "none");
  for (std::uint32_t i = 0; i < 8; ++i)
    EXPECT_EQ(one.cause_of(heartbeat(1, 100 + (2 + i) * kJump, 3 + i)), "SEQUENCE_NUMBER");
}

// A writer of 20 000 messages a second, each with a heartbeat, is not refused after a jump.
TEST(DatagramGuard, AFastWriterRegainsItsCredit) {
  Checked one;
  ASSERT_EQ(one.cause_of(heartbeat(1, 1, 1)), "none");
  ASSERT_EQ(one.cause_of(heartbeat(1, 1 + DatagramGuard::kJump, 2)), "none");
  for (std::uint32_t i = 1; i < 10'000; ++i) {
    one.wait(std::chrono::microseconds{50});
    ASSERT_EQ(one.cause_of(heartbeat(1, 1 + DatagramGuard::kJump + i, 2 + i)), "none");
  }
}

// A writer that has run for days begins far ahead. The library counts to its first number in steps.
TEST(DatagramGuard, AFarFirstNumberReachesTheLibraryInSteps) {
  constexpr auto kStep = DatagramGuard::kStep, kMore = DatagramGuard::kCountsPerSecond;
  Checked one;
  const std::int64_t first = kStep + 2 * kMore, last = first + 10;
  const auto step_to = [](std::int64_t number, std::uint32_t count) {
    Datagram step = heartbeat(number + 1, number, count);
    step[21] = 3;  // final: no response
    return step;
  };
  ASSERT_EQ(one.cause_of(heartbeat(first, last, 1)), "none");
  EXPECT_EQ(one.bytes, step_to(kStep, 1));
  EXPECT_FALSE(fault_of(one.bytes, {}).has_value());
  ASSERT_EQ(one.cause_of(heartbeat(first, last, 2)), "none");
  EXPECT_EQ(one.bytes, step_to(kStep, 2)) << "no step is left";
  one.wait(std::chrono::seconds{1});
  ASSERT_EQ(one.cause_of(heartbeat(first, last, 3)), "none");
  EXPECT_EQ(one.bytes, step_to(kStep + kMore, 3));
  one.wait(std::chrono::seconds{1});
  const Datagram whole = heartbeat(first, last, 4);
  ASSERT_EQ(one.cause_of(whole), "none");
  EXPECT_EQ(one.bytes, whole);
}

// The library begins to count when it learns of the writer, and ignores a HEARTBEAT whose count is
// not above the last one.
TEST(DatagramGuard, StepsBeginWithTheAnnouncementOfTheWriter) {
  constexpr auto kStep = DatagramGuard::kStep;
  Checked one;
  const std::uint32_t number = kSamplesWriter[2];
  ASSERT_EQ(one.cause_of(announcement()), "none");
  ASSERT_EQ(one.cause_of(heartbeat(kStep, kStep, 1)), "none");
  one.wait(std::chrono::seconds{5});
  ASSERT_EQ(one.cause_of(endpoint(number)), "none");
  ASSERT_EQ(one.cause_of(heartbeat(2 * kStep + 1, 2 * kStep + 1, 0)), "none") << "ignored";
  ASSERT_EQ(one.cause_of(heartbeat(2 * kStep + 1, 2 * kStep + 1, 2)), "none");
  Datagram expected = heartbeat(kStep + 1, kStep, 2);
  expected[21] = 3;
  EXPECT_EQ(one.bytes, expected);
}

// The library removes a participant whose lease (20 s) has ended, and counts from 0 again.
TEST(DatagramGuard, StepsBeginAgainAfterTheLease) {
  constexpr auto kStep = DatagramGuard::kStep;
  Checked one;
  ASSERT_EQ(one.cause_of(announcement()), "none");
  ASSERT_EQ(one.cause_of(endpoint(kSamplesWriter[2])), "none");
  ASSERT_EQ(one.cause_of(heartbeat(kStep + 1, kStep + 1, 1)), "none");
  one.wait(std::chrono::seconds{1});
  const Datagram further = heartbeat(kStep + 2, kStep + 2, 2);
  ASSERT_EQ(one.cause_of(further), "none");
  EXPECT_EQ(one.bytes, further);
  one.wait(std::chrono::seconds{21});
  ASSERT_EQ(one.cause_of(announcement()), "none");
  ASSERT_EQ(one.cause_of(heartbeat(kStep + 3, kStep + 3, 3)), "none");
  EXPECT_NE(one.bytes, heartbeat(kStep + 3, kStep + 3, 3));
}

// A participant may shorten its lease; the library then removes it earlier.
TEST(DatagramGuard, StepsBeginAgainAfterAShortenedLease) {
  constexpr auto kStep = DatagramGuard::kStep;
  Checked one;
  Datagram shortened = announcement();
  const Datagram lease = words({0x00080002, 20, 0});
  const auto at = std::search(shortened.begin(), shortened.end(), lease.begin(), lease.end());
  ASSERT_NE(at, shortened.end());
  at[4] = 1;
  for (const Datagram& known :
       {announcement(), shortened, endpoint(kSamplesWriter[2]), heartbeat(kStep + 1, kStep + 1, 1)})
    ASSERT_EQ(one.cause_of(known), "none");
  one.wait(std::chrono::seconds{2});
  ASSERT_EQ(one.cause_of(announcement()), "none");
  ASSERT_EQ(one.cause_of(heartbeat(kStep + 3, kStep + 3, 3)), "none");
  EXPECT_NE(one.bytes, heartbeat(kStep + 3, kStep + 3, 3));
}

// Sums how far a library would count that knows every writer and all its readers.
class CountingLibrary {
 public:
  void read(const Datagram& datagram) {
    for_each_submessage(datagram, [&](const SubmessageView& one) {
      if (one.kind != Submessage::kHeartbeat) return true;
      RtpsCursor in(one.bytes.subspan(kSubmessageHeader), one.little);
      in.take(4);
      const auto writer = in.take(4);
      Datagram name(datagram.begin() + 8, datagram.begin() + 20);
      put_all(name, writer);
      const std::int64_t before = in.sequence_number() - 1;
      std::int64_t& counted = counted_[name];
      sum += std::max<std::int64_t>(0, before - counted);
      counted = std::max(counted, before);
      return true;
    });
  }
  std::int64_t sum = 0;

 private:
  std::map<Datagram, std::int64_t> counted_;
};

// The traffic of rtps_attacks.py for 15 s. Before the guard counted for each reader, this library
// counted 28 000 million numbers.
TEST(DatagramGuard, TheLibraryCountsLittleInHostileTraffic) {
  std::vector<Datagram> corpus = recorded_datagrams();
  ASSERT_FALSE(corpus.empty());
  for (const NamedDatagram& valid : valid_datagrams()) corpus.push_back(valid.bytes);
  for (const std::uint64_t seed : {1, 2, 3}) {
    RtpsMutation mutation(corpus, seed);
    Checked one;
    CountingLibrary library;
    for (std::uint32_t i = 0; i < 75'000; ++i) {
      one.cause_of(i % 10 == 1 ? announcement(numbered(i)) : mutation.next());
      library.read(one.bytes);
      one.wait(std::chrono::microseconds{200});
    }
    EXPECT_GT(library.sum, 0);
    EXPECT_LE(library.sum, DatagramGuard::kStep + 15 * DatagramGuard::kCountsPerSecond) << seed;
  }
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

// The library does not count for a reader that does not exist, or in a message to another
// participant.
TEST(DatagramGuard, StepsCountOnlyWhatTheLibraryCounts) {
  const std::int64_t far = 2 * DatagramGuard::kStep;
  const auto for_reader = [&](const EntityBytes& reader, std::uint32_t count) {
    Datagram named = heartbeat(far, far, count);
    std::ranges::copy(reader, named.begin() + 24);
    return named;
  };
  const auto to = [](std::uint32_t participant, const Datagram& what) {
    const ParticipantPrefix prefix = numbered(participant);
    return joined(of_submessage(0x0e, 1, Datagram(prefix.begin(), prefix.end())), what);
  };
  // Returns whether `counted`, sent twice, makes the guard pass a far number to one reader.
  const auto opens = [&](const Datagram& counted) {
    Checked one;
    one.guard.serve(numbered(7));
    for (const Datagram& known : {announcement(), endpoint(kSamplesWriter[2]), counted})
      EXPECT_EQ(one.cause_of(known), "none");
    one.wait(std::chrono::seconds{4});
    EXPECT_EQ(one.cause_of(counted), "none");
    const Datagram jump = for_reader(kSamplesReader, 0xffffffff);
    EXPECT_EQ(one.cause_of(jump), "none");
    return one.bytes == jump;
  };
  constexpr EntityBytes kEvery{}, kNone{0, 0, 9, 4};
  EXPECT_TRUE(opens(for_reader(kEvery, 1)));
  EXPECT_TRUE(opens(to(7, for_reader(kSamplesReader, 1))));
  EXPECT_FALSE(opens(for_reader(kNone, 1)));
  EXPECT_FALSE(opens(to(8, for_reader(kSamplesReader, 1))));
  EXPECT_FALSE(opens(to(8, for_reader(kEvery, 0xffffffff))));
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

// CVE-2025-64438: the library inserts each number of a GAP into a set.
TEST(DatagramGuard, ALongGapReachesTheLibraryAsAHeartbeat) {
  constexpr auto kMost = DatagramGuard::kMostGapped;
  Checked one;
  ASSERT_EQ(one.cause_of(heartbeat(1, kMost + 50, 7)), "none");
  const Datagram allowed = gap(1, kMost);
  ASSERT_EQ(one.cause_of(allowed), "none");
  EXPECT_EQ(one.bytes, allowed);
  const Datagram more = gap(kMost, kMost + 10);
  ASSERT_EQ(one.cause_of(more), "none");
  // Final, so that no response follows; it has all from the end of the range on.
  Datagram expected = heartbeat(kMost + 10, kMost + 50, 8);
  expected[21] = 3;
  EXPECT_EQ(one.bytes, expected);
  EXPECT_FALSE(fault_of(one.bytes, {}).has_value());
  EXPECT_EQ(one.cause_of(gap(1, kMost + 52 + DatagramGuard::kJump)), "GAP");
}

}  // namespace
}  // namespace fieldcast
