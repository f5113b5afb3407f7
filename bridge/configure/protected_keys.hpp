// Keys of the configuration that only the machine's administrator changes, in the file itself:
// where the bridge listens, its identity and secrets, and the place of its store. Pure.
#pragma once

#include <string>
#include <vector>

#include "config/document/fault.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::configure {

struct ProtectedLine {
  unsigned line = 0;  // from 1
  std::string why;
};
// Lines of the main file. `places`: of the same text as `spec`.
[[nodiscard]] std::vector<ProtectedLine> protected_lines(const BridgeSpec& spec,
                                                         const config::Places& places);

// "dds: how the bridge joins its domain; an administrator changes it in the file": one for each key
// that differs.
[[nodiscard]] std::vector<std::string> changed_protected_keys(const BridgeSpec& present,
                                                              const BridgeSpec& draft);

}  // namespace fieldcast::configure
