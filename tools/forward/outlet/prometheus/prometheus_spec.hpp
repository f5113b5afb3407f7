// How a forwarder reaches Prometheus. A plain value.
#pragma once

#include "tools/forward/outlet/http/http_spec.hpp"

namespace fieldcast::forward {

struct PrometheusSpec {
  HttpSpec http{.server = "http://127.0.0.1:9090/api/v1/write"};
  friend bool operator==(const PrometheusSpec&, const PrometheusSpec&) = default;
};

}  // namespace fieldcast::forward
