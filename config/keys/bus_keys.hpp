// The keys of a bus, of its port, of its `capture` and of its `defaults`.
#pragma once

#include "config/cascade.hpp"
#include "config/keys/key.hpp"

namespace fieldcast::config {

// What `defaults` of a bus fills: rules of the bus, and what flows down to its devices.
struct BusDefaults {
  BusSpec& bus;
  DeviceDefaults& devices;
};

[[nodiscard]] const Rows<BusSpec>& bus_rows();
[[nodiscard]] const Rows<CaptureSpec>& capture_rows();
[[nodiscard]] const Rows<BusDefaults>& bus_default_rows();

}  // namespace fieldcast::config
