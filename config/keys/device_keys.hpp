#pragma once

#include "config/cascade.hpp"
#include "config/keys/key.hpp"

namespace fieldcast::config {

[[nodiscard]] const Rows<DeviceDefaults>& device_rows();
[[nodiscard]] const Rows<DeviceDefaults>& template_rows();
[[nodiscard]] const Rows<DeviceDefaults>& template_default_rows();

}  // namespace fieldcast::config
