#include <gtest/gtest.h>

#include "bridge/log/log_lines.hpp"

namespace fieldcast {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

const Instant kStart{std::chrono::hours{1}};

unsigned lines_of(LineBudget& budget, unsigned occurrences, const std::string& kind, Instant now) {
  unsigned lines = 0;
  for (unsigned i = 0; i < occurrences; ++i) lines += budget.occurred(kind, now).log ? 1 : 0;
  return lines;
}

TEST(LineBudget, TheFirstLinesOfAKindAreWrittenTheRestIsCounted) {
  LineBudget budget;
  EXPECT_EQ(lines_of(budget, 30'000, "a", kStart), LineBudget::kLines);
  EXPECT_TRUE(budget.summaries(kStart + minutes{9}).empty());
  const auto summaries = budget.summaries(kStart + minutes{10});
  ASSERT_EQ(summaries.size(), 1u);
  EXPECT_EQ(summaries[0].key, "a");
  EXPECT_EQ(summaries[0].suppressed, 30'000 - LineBudget::kLines);
  EXPECT_TRUE(budget.summaries(kStart + minutes{11}).empty());
}

TEST(LineBudget, TheNextLineOfAKindSaysWhatWasCounted) {
  LineBudget budget;
  lines_of(budget, LineBudget::kLines + 5, "a", kStart);
  const auto verdict = budget.occurred("a", kStart + minutes{10});
  EXPECT_TRUE(verdict.log);
  EXPECT_EQ(verdict.suppressed, 5u);
}

TEST(LineBudget, KindsDoNotTakeEachOthersLines) {
  LineBudget budget;
  lines_of(budget, 100, "a", kStart);
  EXPECT_TRUE(budget.occurred("b", kStart).log);
}

TEST(LineBudget, MoreKindsThanItKnowsShareOneBudget) {
  LineBudget budget;
  unsigned lines = 0;
  for (unsigned i = 0; i < 10'000; ++i)
    lines += budget.occurred("kind " + std::to_string(i), kStart + seconds{i % 60}).log ? 1 : 0;
  EXPECT_EQ(lines, LineBudget::kMaxKinds + LineBudget::kLines);
}

}  // namespace
}  // namespace fieldcast
