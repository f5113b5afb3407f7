#pragma once

#include "config/channel/cascade.hpp"
#include "config/document/key.hpp"

namespace fieldcast::config {

[[nodiscard]] const Rows<DeviceDefaults>& device_rows();
[[nodiscard]] const Rows<DeviceDefaults>& template_rows();
[[nodiscard]] const Rows<DeviceDefaults>& template_default_rows();

}  // namespace fieldcast::config
