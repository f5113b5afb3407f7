#pragma once

#include "config/channel/channel_keys.hpp"
#include "config/document/map_reader.hpp"

namespace fieldcast::config {

// `defaults` of a bus, for the bus itself and for its devices.
struct BusDefaults {
  BusSpec& bus;
  DeviceDefaults& devices;
};

[[nodiscard]] const Rows<BusSpec>& bus_rows();
[[nodiscard]] const Rows<CaptureSpec>& capture_rows();
[[nodiscard]] const Rows<BusDefaults>& bus_default_rows();

[[nodiscard]] const Rows<DeviceDefaults>& device_rows();
[[nodiscard]] const Rows<DeviceDefaults>& template_rows();
[[nodiscard]] const Rows<DeviceDefaults>& template_default_rows();

}  // namespace fieldcast::config
