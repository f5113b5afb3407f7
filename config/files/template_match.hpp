// Finds device templates for the identity of a device. Pure functions, except for the passed
// reader.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/files/file_reader.hpp"

namespace fieldcast::config {

// The lines of a template that describe the device.
struct TemplateHead {
  std::string name;                    // "schneider-pm5000"
  std::string description;             // "Power meter Schneider PM5000"
  std::string device;                  // the comment "# Device:"; empty: none
  std::vector<std::string> protocols;  // empty: any
};

// Reads all templates of the directories, sorted by name. Skips unreadable files.
[[nodiscard]] std::vector<TemplateHead> template_heads(const FileReader& reader,
                                                       const LoadOptions& options);
[[nodiscard]] TemplateHead template_head(std::string name, std::string_view text);

// Templates for the protocol whose manufacturer and model are in the identity ("Siemens, PAC3200,
// 2.1"). A word with letters and digits is a model number; it may be a prefix of the number in the
// identity. Returns all templates with the longest match.
[[nodiscard]] std::vector<std::string> matching_templates(std::string_view identity,
                                                          std::string_view protocol,
                                                          const std::vector<TemplateHead>& heads);

}  // namespace fieldcast::config
