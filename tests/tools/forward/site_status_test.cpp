#include "tools/forward/outlet/site_status.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace fieldcast::forward {
namespace {

TEST(SiteStatus, IsJsonForTheCentre) {
  SiteStatus status{.site = "north",
                    .at = {1'764'360'000'000'000'007},
                    .started_at = {5},
                    .backlog_records = 12,
                    .backlog_bytes = 3'000,
                    .oldest_at = {9},
                    .thinned_samples = 4,
                    .dropped_samples = 2,
                    .acknowledged_samples = 100,
                    .late_samples = 10,
                    .lost_samples = 1,
                    .devices = 3};
  const auto json = nlohmann::json::parse(to_json(status));
  EXPECT_EQ(json.at("schema"), 1);
  EXPECT_EQ(json.at("site"), "north");
  EXPECT_EQ(json.at("at"), 1'764'360'000'000'000'007) << "all digits";
  EXPECT_EQ(json.at("backlog_records"), 12);
  EXPECT_EQ(json.at("oldest_at"), 9);
  EXPECT_EQ(json.at("samples"), 100);
  EXPECT_EQ(json.at("lost_samples"), 3) << "dropped from the queue, or never in it";
  status.oldest_at = {};
  EXPECT_TRUE(nlohmann::json::parse(to_json(status)).at("oldest_at").is_null());
}

}  // namespace
}  // namespace fieldcast::forward
