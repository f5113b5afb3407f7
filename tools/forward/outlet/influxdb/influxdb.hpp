// The outlet for InfluxDB: line protocol with gzip. A repeated sample has the same series and time,
// so it replaces itself.
#pragma once

#include <memory>

#include "tools/forward/outlet/influxdb/influxdb_spec.hpp"
#include "tools/forward/outlet/outlet.hpp"

namespace fieldcast::forward {

[[nodiscard]] std::unique_ptr<Outlet> make_influxdb(const InfluxdbSpec& spec,
                                                    OutletContext context);

}  // namespace fieldcast::forward
