// Runs some minutes of a standby group for each serial protocol, and shows that each check finds
// its injected fault.
#include "tests/campaign/group_day.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

std::string name_of_kind(const testing::TestParamInfo<std::size_t>& chosen) {
  std::string name = group_kinds()[chosen.param].name;
  std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
  return name;
}

class GroupDays : public testing::TestWithParam<std::size_t> {};

TEST_P(GroupDays, HoldEveryInvariant) {
  GroupDay day(group_kinds()[GetParam()], 1, 5min);
  day.run();
  EXPECT_FALSE(day.violation()) << day.violation().value_or("");
  EXPECT_GT(day.counts().good, 100u);
  EXPECT_GT(day.counts().takeovers, 1u);
}

INSTANTIATE_TEST_SUITE_P(Protocols, GroupDays, testing::Range<std::size_t>(0, group_kinds().size()),
                         name_of_kind);

// Days that showed a fault of an earlier version.
struct Found {
  std::string protocol;
  std::uint64_t seed;
  Duration length;
  friend void PrintTo(const Found& found, std::ostream* out) {
    *out << found.protocol << ' ' << found.seed;
  }
};
class GroupDaysThatFailed : public testing::TestWithParam<Found> {};

TEST_P(GroupDaysThatFailed, Hold) {
  const auto kinds = group_kinds();
  const auto kind = std::ranges::find(kinds, GetParam().protocol, &StormKind::name);
  ASSERT_NE(kind, kinds.end());
  GroupDay day(*kind, GetParam().seed, GetParam().length);
  day.run();
  EXPECT_FALSE(day.violation()) << day.violation().value_or("");
}

std::string seed_of(const testing::TestParamInfo<Found>& chosen) {
  return "seed" + std::to_string(chosen.param.seed);
}

// A response to another master was matched to a request of this one.
INSTANTIATE_TEST_SUITE_P(ResponsesOfTheSecondMaster, GroupDaysThatFailed,
                         testing::Values(Found{"omron-hostlink C-mode", 38, 3min},
                                         Found{"omron-hostlink C-mode", 101, 3min}),
                         seed_of);
// Several masters in a row each restarted the refresh of a slow channel.
INSTANTIATE_TEST_SUITE_P(HandedOverAgainAndAgain, GroupDaysThatFailed,
                         testing::Values(Found{"dtc", 116, 5min}, Found{"dtc", 42, 8min}), seed_of);
// A rejoined member ran a command that it had held before, because it had missed the result.
INSTANTIATE_TEST_SUITE_P(HeldFromBefore, GroupDaysThatFailed,
                         testing::Values(Found{"dtc", 65, 6min}), seed_of);

// A partition ended after one of its two masters was killed, and the station ignored the samples of
// the remaining one.
INSTANTIATE_TEST_SUITE_P(OnlyTheStationHeardTheOtherMaster, GroupDaysThatFailed,
                         testing::Values(Found{"s7-freeport", 576, 6min},
                                         Found{"modbus-rtu", 185, 8min}),
                         seed_of);
// A member had received a master's samples but not its messages, and became master with a lower
// term.
INSTANTIATE_TEST_SUITE_P(OnlySamplesWereHeard, GroupDaysThatFailed,
                         testing::Values(Found{"modbus-ascii", 163, 27min}), seed_of);
// Only a member that did not become master received a command.
INSTANTIATE_TEST_SUITE_P(ReachedOneMemberAlone, GroupDaysThatFailed,
                         testing::Values(Found{"modbus-rtu", 44, 1min},
                                         Found{"mitsubishi-fx", 576, 1min}),
                         seed_of);
// A bridge was paused for 4 s during a request, and then did not poll the device for ten times as
// long.
INSTANTIATE_TEST_SUITE_P(AskedWhileItStoodStill, GroupDaysThatFailed,
                         testing::Values(Found{"s7-freeport", 16000010, 15min}), seed_of);

// A member received a command after its result, before it had joined.
INSTANTIATE_TEST_SUITE_P(ReceivedBehindItsResult, GroupDaysThatFailed,
                         testing::Values(Found{"modbus-ascii", 905, 30min}), seed_of);

// A member rejoined in the same process and was cut off immediately. It had lost the entry of the
// other member, which was master on the other side and was then killed.
INSTANTIATE_TEST_SUITE_P(CutOffWhenItJoinedAgain, GroupDaysThatFailed,
                         testing::Values(Found{"modbus-ascii", 3130, 5min}), seed_of);

// Expects the violation within some days; a day may show a different violation first.
void expect_found(GroupSabotage what, const std::string& text) {
  std::string found;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    GroupDay day(group_kinds()[0], seed, 8min, what);
    day.run();
    if (day.violation().value_or("").find(text) != std::string::npos) return;
    found += day.violation().value_or("nothing") + "; ";
  }
  ADD_FAILURE() << text << " was not found, but: " << found;
}

TEST(GroupDaySabotage, EachInvariantFindsWhatBreaksIt) {
  expect_found(GroupSabotage::kDeaf, "after another one");
  expect_found(GroupSabotage::kTwoMasters, "two are master for");
  expect_found(GroupSabotage::kOldSample, "of an old master after one of the new");
  expect_found(GroupSabotage::kSequences, "does not count on");
  expect_found(GroupSabotage::kTwoRuns, "has executed");
  expect_found(GroupSabotage::kNoResult, "has no result");
  expect_found(GroupSabotage::kTwoResults, "has 2 results");
  expect_found(GroupSabotage::kValue, "as good, it holds");
  expect_found(GroupSabotage::kSilence, "and silent for");
}

TEST(GroupDay, IsTheSameDayWithItsTranscript) {
  GroupDay day(group_kinds()[0], 3, 2min), again(group_kinds()[0], 3, 2min);
  again.keep_transcript();
  day.run();
  again.run();
  EXPECT_EQ(day.counts().frames, again.counts().frames);
  EXPECT_EQ(day.counts().samples, again.counts().samples);
  EXPECT_TRUE(day.transcript().empty());
  EXPECT_FALSE(again.transcript().empty());
}

}  // namespace
}  // namespace fieldcast::test
