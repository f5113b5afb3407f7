// The outlet for Prometheus: remote write. A repeated sample has the same series, time and value,
// which the server accepts without storing it again.
#pragma once

#include <memory>

#include "tools/forward/outlet/outlet.hpp"
#include "tools/forward/outlet/prometheus/prometheus_spec.hpp"

namespace fieldcast::forward {

[[nodiscard]] std::unique_ptr<Outlet> make_prometheus(const PrometheusSpec& spec,
                                                      OutletContext context);

}  // namespace fieldcast::forward
