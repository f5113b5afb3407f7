// How a forwarder reaches InfluxDB. A plain value.
#pragma once

#include <string>

#include "tools/forward/outlet/http/http_spec.hpp"

namespace fieldcast::forward {

struct InfluxdbSpec {
  HttpSpec http{.server = "http://127.0.0.1:8086"};
  std::string database = "fieldcast";  // version 1
  std::string organization, bucket;    // version 2: instead of the database
  bool create = false;                 // the database of version 1
  friend bool operator==(const InfluxdbSpec&, const InfluxdbSpec&) = default;
};

}  // namespace fieldcast::forward
