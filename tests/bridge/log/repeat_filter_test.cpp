#include <gtest/gtest.h>

#include "bridge/log/log_lines.hpp"

namespace fieldcast {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

const Instant kStart{std::chrono::hours{1}};

TEST(RepeatFilter, FirstOccurrenceIsLoggedTheNextAreCounted) {
  RepeatFilter filter;
  EXPECT_TRUE(filter.occurred("a", kStart).log);
  EXPECT_FALSE(filter.occurred("a", kStart + seconds{1}).log);
  EXPECT_FALSE(filter.occurred("a", kStart + minutes{9}).log);
}

TEST(RepeatFilter, KeysAreIndependent) {
  RepeatFilter filter;
  EXPECT_TRUE(filter.occurred("a", kStart).log);
  EXPECT_TRUE(filter.occurred("b", kStart).log);
}

TEST(RepeatFilter, AfterTenMinutesTheNextOccurrenceReportsHowMany) {
  RepeatFilter filter;
  (void)filter.occurred("a", kStart);
  for (int i = 1; i <= 5; ++i) (void)filter.occurred("a", kStart + seconds{i});
  const auto verdict = filter.occurred("a", kStart + minutes{10});
  EXPECT_TRUE(verdict.log);
  EXPECT_EQ(verdict.suppressed, 5u);
  EXPECT_FALSE(filter.occurred("a", kStart + minutes{11}).log);
}

TEST(RepeatFilter, RecoveryReportsHowManyAndRestarts) {
  RepeatFilter filter;
  (void)filter.occurred("a", kStart);
  (void)filter.occurred("a", kStart + seconds{1});
  const auto over = filter.recovered("a");
  EXPECT_TRUE(over.log);
  EXPECT_EQ(over.suppressed, 1u);
  EXPECT_TRUE(filter.occurred("a", kStart + seconds{2}).log);
}

TEST(RepeatFilter, RecoveryOfWhatNeverFailedIsSilent) {
  RepeatFilter filter;
  EXPECT_FALSE(filter.recovered("a").log);
}

TEST(RepeatFilter, SummariesListWhatWasCountedOnceEach) {
  RepeatFilter filter;
  (void)filter.occurred("a", kStart);
  (void)filter.occurred("a", kStart + seconds{1});
  (void)filter.occurred("quiet", kStart);
  EXPECT_TRUE(filter.summaries(kStart + minutes{9}).empty());
  const auto due = filter.summaries(kStart + minutes{10});
  ASSERT_EQ(due.size(), 1u);
  EXPECT_EQ(due[0].key, "a");
  EXPECT_EQ(due[0].suppressed, 1u);
  EXPECT_TRUE(filter.summaries(kStart + minutes{30}).empty());
}

TEST(RepeatFilter, MemoryIsBoundedAndTheQuietestKeyGoesFirst) {
  RepeatFilter filter;
  (void)filter.occurred("oldest", kStart);
  for (std::size_t i = 1; i < RepeatFilter::kMaxKeys; ++i) {
    (void)filter.occurred("k" + std::to_string(i), kStart + seconds{1});
  }
  EXPECT_FALSE(filter.occurred("k1", kStart + seconds{2}).log);
  EXPECT_TRUE(filter.occurred("one more", kStart + seconds{2}).log);
  EXPECT_FALSE(filter.occurred("k1", kStart + seconds{3}).log);
  EXPECT_TRUE(filter.occurred("oldest", kStart + seconds{3}).log);
}

}  // namespace
}  // namespace fieldcast
