#include "tools/forward/forward_metrics.hpp"

#include <gmock/gmock.h>

namespace fieldcast::forward {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

TEST(ForwardMetrics, AreOpenMetrics) {
  const SiteStatus status{.site = "north",
                          .at = {12'500'000'000},
                          .is_connected = true,
                          .backlog_records = 7,
                          .oldest_at = {10'000'000'000},
                          .acknowledged_samples = 42,
                          .open_gaps = 3};
  const std::string text = metrics_text(status, MetricsFormat::kOpenMetrics);
  EXPECT_THAT(text, HasSubstr("fieldcast_forward_connected{site=\"north\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("# TYPE fieldcast_forward_samples counter\n"));
  EXPECT_THAT(text, HasSubstr("fieldcast_forward_samples_total{site=\"north\"} 42\n"));
  EXPECT_THAT(text, HasSubstr("fieldcast_forward_queue_age_seconds{site=\"north\"} 2.5\n"));
  EXPECT_THAT(text, HasSubstr("fieldcast_forward_open_gaps{site=\"north\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("# UNIT fieldcast_forward_queue_bytes bytes\n"));
  EXPECT_THAT(text, EndsWith("# EOF\n"));
}

TEST(ForwardMetrics, AreTheTextFormatOfPrometheus) {
  const std::string text = metrics_text({.site = "north"}, MetricsFormat::kPrometheus);
  EXPECT_THAT(text, HasSubstr("# TYPE fieldcast_forward_samples_total counter\n"));
  EXPECT_THAT(text, HasSubstr("fieldcast_forward_queue_age_seconds{site=\"north\"} 0\n"))
      << "an empty queue";
  EXPECT_THAT(text, Not(HasSubstr("# EOF")));
}

}  // namespace
}  // namespace fieldcast::forward
