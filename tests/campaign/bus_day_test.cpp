// Runs a few short days of every protocol, and shows that each check finds its injected fault.
#include "tests/campaign/bus_day.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;
using Sabotage = BusDay::Sabotage;

class BusDays : public testing::TestWithParam<std::size_t> {};

TEST_P(BusDays, HoldEveryInvariant) {
  const StormKind& kind = storm_kinds()[GetParam()];
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    BusDay day(kind, seed, 2h);
    day.run();
    EXPECT_FALSE(day.violation()) << "seed " << seed << ": " << day.violation().value_or("");
    const DayCounts counts = day.counts();
    EXPECT_GT(counts.good, 100u);
    EXPECT_GT(counts.results, 10u);
  }
}

INSTANTIATE_TEST_SUITE_P(Protocols, BusDays, testing::Range<std::size_t>(0, storm_kinds().size()),
                         [](const auto& chosen) {
                           std::string name = storm_kinds()[chosen.param].name;
                           std::erase_if(name, [](char c) { return !std::isalnum(c); });
                           return name;
                         });

// Days that showed a fault of an earlier version.
struct Found {
  std::string protocol;
  std::uint64_t seed;
  Duration length = 3h;
  friend void PrintTo(const Found& found, std::ostream* out) {
    *out << found.protocol << ' ' << found.seed;
  }
};
class BusDaysThatFailed : public testing::TestWithParam<Found> {};

TEST_P(BusDaysThatFailed, Hold) {
  const auto kinds = storm_kinds();
  const auto kind = std::ranges::find(kinds, GetParam().protocol, &StormKind::name);
  BusDay day(*kind, GetParam().seed, GetParam().length);
  day.run();
  EXPECT_FALSE(day.violation()) << day.violation().value_or("");
}

// A late response set an offline device online, but the device was not read after that.
INSTANTIATE_TEST_SUITE_P(BackByALateResponse, BusDaysThatFailed,
                         testing::Values(Found{"s7-ppi", 3}, Found{"modbus-tcp", 8}),
                         [](const auto& chosen) {
                           return "seed" + std::to_string(chosen.param.seed);
                         });
// Noise during a request contained an acknowledgement, and the next request overlapped it.
INSTANTIATE_TEST_SUITE_P(NoiseDuringTheRequest, BusDaysThatFailed,
                         testing::Values(Found{"s7-ppi", 11}), [](const auto& chosen) {
                           return "seed" + std::to_string(chosen.param.seed);
                         });

// Retries to a device that failed repeatedly made the bus learn a pause of a second.
INSTANTIATE_TEST_SUITE_P(APauseThatWasNotNeeded, BusDaysThatFailed,
                         testing::Values(Found{"mitsubishi-fx", 31, 24h}), [](const auto& chosen) {
                           return "seed" + std::to_string(chosen.param.seed);
                         });

// Each probe of a slow device was sent in a pause of the wire that was too short for it.
INSTANTIATE_TEST_SUITE_P(ProbedInShortPauses, BusDaysThatFailed,
                         testing::Values(Found{"modbus-rtu-declared", 229, 24h}),
                         [](const auto& chosen) {
                           return "seed" + std::to_string(chosen.param.seed);
                         });
// A timeout after a refusal was handled as a refusal, and no response was pending.
INSTANTIATE_TEST_SUITE_P(SilenceBehindARefusal, BusDaysThatFailed,
                         testing::Values(Found{"mitsubishi-fx", 442, 24h}), [](const auto& chosen) {
                           return "seed" + std::to_string(chosen.param.seed);
                         });

// A late response and the next one arrived together, and both had values of one channel.
INSTANTIATE_TEST_SUITE_P(TwoSamplesOfAnInstant, BusDaysThatFailed,
                         testing::Values(Found{"mitsubishi-mc 3E", 4001, 24h}),
                         [](const auto& chosen) {
                           return "seed" + std::to_string(chosen.param.seed);
                         });

std::string violation_of(Sabotage what) {
  BusDay day(storm_kinds()[0], 1, 24h);
  day.sabotage(what);
  day.run();
  return day.violation().value_or("nothing was found");
}

TEST(BusDaySabotage, EachInvariantFindsWhatBreaksIt) {
  EXPECT_NE(violation_of(Sabotage::kValue).find("as good, it holds"), std::string::npos);
  EXPECT_NE(violation_of(Sabotage::kSilence).find("silent for"), std::string::npos);
  EXPECT_NE(violation_of(Sabotage::kNoResult).find("no result"), std::string::npos);
  EXPECT_NE(violation_of(Sabotage::kTwoResults).find("a second result"), std::string::npos);
  EXPECT_NE(violation_of(Sabotage::kOverlap).find("into the one before"), std::string::npos);
  EXPECT_NE(violation_of(Sabotage::kMemory).find("memory grew"), std::string::npos);
}

TEST(BusDay, IsTheSameDayWithItsTranscript) {
  BusDay day(storm_kinds()[0], 7, 1h), again(storm_kinds()[0], 7, 1h);
  again.keep_transcript();
  day.run();
  again.run();
  EXPECT_EQ(day.counts().requests, again.counts().requests);
  EXPECT_EQ(day.counts().samples, again.counts().samples);
  EXPECT_TRUE(day.transcript().empty());
  EXPECT_LE(again.transcript().size(), BusDay::kTranscriptLines);
  EXPECT_TRUE(std::ranges::any_of(
      again.transcript(), [](const std::string& text) { return text.find("  >> ") != text.npos; }));
}

}  // namespace
}  // namespace fieldcast::test
