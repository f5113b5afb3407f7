// Some minutes of a standby group at a bus of each protocol of a line, and that each invariant
// finds what breaks it.
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

// Days that showed a fault when it was there.
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

// What another master was answered was taken for an answer to this one.
INSTANTIATE_TEST_SUITE_P(AnswersOfTheOtherMaster, GroupDaysThatFailed,
                         testing::Values(Found{"omron-hostlink C-mode", 38, 3min},
                                         Found{"omron-hostlink C-mode", 101, 3min}),
                         seed_of);
// Each of several masters in a row began the refresh of a slow channel anew.
INSTANTIATE_TEST_SUITE_P(HandedOverAgainAndAgain, GroupDaysThatFailed,
                         testing::Values(Found{"dtc", 116, 5min}, Found{"dtc", 42, 8min}), seed_of);
// A member that joined anew ran what it had held before, whose result it had not heard.
INSTANTIATE_TEST_SUITE_P(HeldFromBefore, GroupDaysThatFailed,
                         testing::Values(Found{"dtc", 65, 6min}), seed_of);

// After a cut whose other master was killed the station ignored the samples of the one that
// remained.
INSTANTIATE_TEST_SUITE_P(OnlyTheStationHeardTheOtherMaster, GroupDaysThatFailed,
                         testing::Values(Found{"s7-freeport", 576, 6min},
                                         Found{"modbus-rtu", 185, 8min}),
                         seed_of);
// A member that had followed samples, and had not heard their master, became master of a smaller
// term.
INSTANTIATE_TEST_SUITE_P(OnlySamplesWereHeard, GroupDaysThatFailed,
                         testing::Values(Found{"modbus-ascii", 163, 27min}), seed_of);
// A command reached only a member that did not become master.
INSTANTIATE_TEST_SUITE_P(ReachedOneMemberAlone, GroupDaysThatFailed,
                         testing::Values(Found{"modbus-rtu", 44, 1min},
                                         Found{"mitsubishi-fx", 576, 1min}),
                         seed_of);
// A bridge stood still for 4 s while a device was asked, and left that device alone for ten times
// as long.
INSTANTIATE_TEST_SUITE_P(AskedWhileItStoodStill, GroupDaysThatFailed,
                         testing::Values(Found{"s7-freeport", 16000010, 15min}), seed_of);

// A member got a command behind its result, before it had joined.
INSTANTIATE_TEST_SUITE_P(ReceivedBehindItsResult, GroupDaysThatFailed,
                         testing::Values(Found{"modbus-ascii", 905, 30min}), seed_of);

// A member that had joined anew in the same process, and been cut off at once, did not know any
// more that there was another one, which was master out of its sight and then killed.
INSTANTIATE_TEST_SUITE_P(CutOffWhenItJoinedAnew, GroupDaysThatFailed,
                         testing::Values(Found{"modbus-ascii", 3130, 5min}), seed_of);

// Within some days, of which others may find something else first.
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
