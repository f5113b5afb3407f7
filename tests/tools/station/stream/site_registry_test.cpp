#include "tools/station/stream/site_registry.hpp"

#include <gtest/gtest.h>

#include "tests/tools/station/stream/stream_support.hpp"

namespace fieldcast::web {
namespace {

using test::at;

TEST(SiteRegistry, AReportIsRead) {
  const auto report = site_report_from(
      R"({"schema":1,"site":"north","at":100,"started_at":1,"backlog_records":12,)"
      R"("backlog_bytes":34,"oldest_at":null,"samples":5,"late_samples":6,"lost_samples":7})");
  ASSERT_TRUE(report);
  EXPECT_EQ(report->at, UtcTime{100});
  EXPECT_EQ(report->backlog_records, 12U);
  EXPECT_EQ(report->oldest_at, UtcTime{});
  EXPECT_EQ(report->lost_samples, 7U);
}

TEST(SiteRegistry, AReportOfAnotherVersionIsRefused) {
  EXPECT_FALSE(site_report_from(R"({"schema":2,"at":100})"));
  EXPECT_FALSE(site_report_from("poison"));
  EXPECT_FALSE(site_report_from("[1]"));
}

TEST(SiteRegistry, ASilentSiteIsReportedOnce) {
  SiteRegistry sites;
  sites.heard("north", at(0));
  auto news = sites.news(at(1));
  ASSERT_EQ(news.changed.size(), 1U);
  EXPECT_TRUE(news.changed[0].connected);
  EXPECT_TRUE(news.silent.empty());
  EXPECT_TRUE(sites.news(at(29)).changed.empty());
  news = sites.news(at(30));
  ASSERT_EQ(news.changed.size(), 1U);
  EXPECT_FALSE(news.changed[0].connected);
  EXPECT_EQ(news.silent, std::vector<std::string>{"north"});
  EXPECT_TRUE(sites.news(at(60)).silent.empty());
  sites.heard("north", at(61));
  news = sites.news(at(62));
  ASSERT_EQ(news.changed.size(), 1U);
  EXPECT_TRUE(news.changed[0].connected);
}

TEST(SiteRegistry, ASiteThatIsHeardAllTheTimeIsReportedSeldom) {
  SiteRegistry sites;
  std::size_t reported = 0;
  for (std::int64_t second = 0; second < 20; ++second) {
    sites.heard("north", at(second));
    reported += sites.news(at(second)).changed.size();
  }
  EXPECT_EQ(reported, 4U);
}

TEST(SiteRegistry, AReservedSiteIsNotASiteOfTheStream) {
  SiteRegistry sites;
  sites.reserve({"north"});
  sites.heard("north", at(1));
  sites.reported("north", {.at = at(0)}, at(2));
  sites.refused("north");
  EXPECT_TRUE(sites.is_reserved("north"));
  EXPECT_FALSE(sites.is_reserved("south"));
  const auto news = sites.news(at(60));
  EXPECT_TRUE(news.changed.empty());
  EXPECT_TRUE(news.silent.empty());
}

TEST(SiteRegistry, TheClockOfASiteIsComparedWithThatOfTheServer) {
  SiteRegistry sites;
  sites.reported("north", {.at = at(0), .backlog_records = 3}, at(2));
  const auto news = sites.news(at(2));
  ASSERT_EQ(news.changed.size(), 1U);
  EXPECT_EQ(news.changed[0].clock_ahead, std::chrono::seconds{2});
  EXPECT_EQ(news.changed[0].backlog_records, 3U);
  EXPECT_EQ(news.changed[0].heard_at, at(2));
}

TEST(SiteRegistry, FurtherSitesAreLeftOut) {
  SiteRegistry sites;
  for (std::size_t i = 0; i <= SiteRegistry::kMaxSites; ++i)
    sites.heard("site-" + std::to_string(i), at(0));
  EXPECT_EQ(sites.news(at(0)).changed.size(), SiteRegistry::kMaxSites);
}

}  // namespace
}  // namespace fieldcast::web
