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
