// The device templates of this installation, for a list to choose from.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fieldcast::web {

struct DeviceTemplate {
  std::string name;          // as in `template: NAME`
  std::string maker, model;  // from the comment "# Device:   MAKER MODEL", or its description
  std::string protocol;      // "modbus-rtu, modbus-tcp"
  std::string text;
};

// Pure.
[[nodiscard]] DeviceTemplate device_template_of(std::string name, std::string text);

// Reads the files at the first call. Sorted by maker and model. The io thread.
[[nodiscard]] const std::vector<DeviceTemplate>& device_templates();

}  // namespace fieldcast::web
