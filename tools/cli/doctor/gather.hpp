// Reads the facts for `fieldcast doctor` from /proc, /sys, the ports and the disk. Changes nothing
// and opens no port. Main thread.
#pragma once

#include <filesystem>

#include "core/model/spec.hpp"
#include "tools/cli/doctor/facts.hpp"

namespace fieldcast::cli {

// `root`: directory that replaces "/" for files of the machine. With another root than "/", system
// calls about this machine are skipped. `spec` may be null. Unreadable facts stay empty.
[[nodiscard]] MachineFacts gather_facts(const std::filesystem::path& root, const BridgeSpec* spec);

}  // namespace fieldcast::cli
