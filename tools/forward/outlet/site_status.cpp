#include "tools/forward/outlet/site_status.hpp"

#include <fmt/format.h>

namespace fieldcast::forward {

std::string to_json(const SiteStatus& status) {
  const std::string oldest =
      status.oldest_at.nanoseconds == 0 ? "null" : std::to_string(status.oldest_at.nanoseconds);
  // The loader allows no character in a site's name that JSON escapes.
  return fmt::format(
      R"({{"schema":1,"site":"{}","at":{},"started_at":{},"backlog_records":{},"backlog_bytes":{},)"
      R"("oldest_at":{},"samples":{},"late_samples":{},"lost_samples":{},"thinned_samples":{},)"
      R"("devices":{}}})",
      status.site, status.at.nanoseconds, status.started_at.nanoseconds, status.backlog_records,
      status.backlog_bytes, oldest, status.acknowledged_samples, status.late_samples,
      status.lost_samples + status.dropped_samples, status.thinned_samples, status.devices);
}

}  // namespace fieldcast::forward
