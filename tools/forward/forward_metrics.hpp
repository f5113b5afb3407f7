// The metrics of a forwarder for Prometheus: one row of a table for each. Pure.
#pragma once

#include <string>

#include "bridge/metrics/metrics_text.hpp"
#include "tools/forward/outlet/site_status.hpp"

namespace fieldcast::forward {

[[nodiscard]] std::string metrics_text(const SiteStatus& status, MetricsFormat format);

}  // namespace fieldcast::forward
