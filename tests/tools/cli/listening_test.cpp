#include <gtest/gtest.h>

#include "tools/cli/domain/domain_view.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;

constexpr Instant kBegan{100s};

Connection sites() { return Connection{std::vector<DdsSite>{{"north", {}}, {"south", {}}}}; }

TEST(Listening, ToNobodyTakesAsLongAsABridgeMay) {
  const Listening alone(Connection{DdsSpec{}}, kBegan);
  EXPECT_FALSE(alone.anybody());
  EXPECT_EQ(alone.over_at(), kBegan + kBridgeWait);
}

TEST(Listening, IsOverWhenNothingNewCame) {
  Listening alone(Connection{DdsSpec{}}, kBegan);
  alone.news("line", kBegan + 1s);
  EXPECT_EQ(alone.over_at(), kBegan + 1s + kQuietTime);
  alone.news("press", kBegan + 1500ms);
  EXPECT_EQ(alone.over_at(), kBegan + 1500ms + kQuietTime);
  EXPECT_EQ(alone.silent_text(), "");
}

TEST(Listening, WaitsForEachSite) {
  Listening both(sites(), kBegan);
  both.news("north:line", kBegan + 1s);
  EXPECT_EQ(both.over_at(), kBegan + kBridgeWait);
  EXPECT_TRUE(both.heard_site_of("north:other"));
  EXPECT_FALSE(both.heard_site_of("south:line"));
  EXPECT_EQ(both.silent_text(), "no bridge found in site south");
  EXPECT_EQ(both.silent_sites(), std::vector<std::string>{"south"});
  both.news("south:line", kBegan + 2s);
  EXPECT_EQ(both.over_at(), kBegan + 2s + kQuietTime);
  EXPECT_EQ(both.silent_text(), "");
}

TEST(Listening, LetsWhoTellsLateGoOn) {
  Listening both(sites(), kBegan);
  both.news("north:line", kBegan + 4800ms);
  EXPECT_EQ(both.over_at(), kBegan + 4800ms + kQuietTime);
}

TEST(Listening, ABusWithoutASiteIsOfAnybody) {
  Listening both(sites(), kBegan);
  EXPECT_FALSE(both.heard_site_of("line"));
  both.news("north:line", kBegan + 1s);
  EXPECT_TRUE(both.heard_site_of("line"));
}

}  // namespace
}  // namespace fieldcast::cli
