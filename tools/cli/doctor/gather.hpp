// Reads facts from /proc, /sys, the ports and the disk. Opens no port. Main thread.
#pragma once

#include <filesystem>

#include "core/model/spec.hpp"
#include "tools/cli/doctor/facts.hpp"

namespace fieldcast::cli {

// `root` replaces "/" for files; then system calls about this machine are skipped. `spec` may be
// null. Unreadable facts stay empty.
[[nodiscard]] MachineFacts gather_facts(const std::filesystem::path& root, const BridgeSpec* spec);

}  // namespace fieldcast::cli
