// How far the guard lets the library count because of HEARTBEATs and GAPs.
#include <gtest/gtest.h>

#include <map>

#include "bridge/dds/guard/rtps_cursor.hpp"
#include "tests/bridge/dds/transport/checked_guard.hpp"
#include "tests/bridge/dds/transport/recorded_datagrams.hpp"
#include "tests/campaign/rtps_mutation.hpp"

namespace fieldcast {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace): parts of datagrams

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
