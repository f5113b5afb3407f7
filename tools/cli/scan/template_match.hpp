// Device templates that fit what a device reports of itself. Pure functions, except for the reader
// that is passed in.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/loader.hpp"

namespace fieldcast::cli {

// The head of a template, as far as it describes the device.
struct TemplateHead {
  std::string name;                    // "schneider-pm5000"
  std::string description;             // "Power meter Schneider PM5000"
  std::string device;                  // the comment "# Device:"; empty: there is none
  std::vector<std::string> protocols;  // empty: any
};

// The heads of all templates in the directories, by name. A file that cannot be read is left out.
[[nodiscard]] std::vector<TemplateHead> template_heads(const config::FileReader& reader,
                                                       const config::LoadOptions& options);
[[nodiscard]] TemplateHead template_head(std::string name, std::string_view text);

// The templates of a protocol whose maker and model stand in the identity ("Siemens, PAC3200,
// 2.1"). A word with letters and digits names a model; a longer model number may begin with that
// of the template. The longest such word decides; several templates can share it.
[[nodiscard]] std::vector<std::string> matching_templates(std::string_view identity,
                                                          std::string_view protocol,
                                                          const std::vector<TemplateHead>& heads);

}  // namespace fieldcast::cli
