// The device templates of this installation, for a list to choose from.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/files/template_match.hpp"

namespace fieldcast::web {

struct DeviceTemplate {
  config::TemplateHead head;
  std::string maker, model;  // from the comment "# Device:   MAKER MODEL", or its description
  std::string text;
};

// Pure.
[[nodiscard]] DeviceTemplate device_template_of(std::string name, std::string text);
// Adds "templates" to each device of the reply to a scan: names of those that match its identity.
// Pure.
[[nodiscard]] std::string with_templates(const std::string& scan,
                                         const std::vector<DeviceTemplate>& templates);

// Reads the files at the first call. Sorted by maker and model. The io thread.
[[nodiscard]] const std::vector<DeviceTemplate>& device_templates();

}  // namespace fieldcast::web
