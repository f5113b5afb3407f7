// Listens in a DDS domain for the clocks of its bridges. Joins the domain and leaves it; sends
// nothing. Main thread.
#pragma once

#include <filesystem>

#include "core/model/spec.hpp"
#include "tools/cli/doctor/findings.hpp"
#include "tools/cli/domain/connection.hpp"

namespace fieldcast::cli {

// A bridge writes its time once a second; the second message of each bus is the first that counts.
inline constexpr Duration kListenForClocks = std::chrono::seconds{4};

// Sets `clocks` or `clocks_unknown` of the facts. Lasts kListenForClocks, less after Ctrl-C.
void gather_clocks(const ConnectionOptions& options, MachineFacts& facts);

// Reads facts from /proc, /sys, the ports and the disk. Opens no port. Main thread.
// `root` replaces "/" for files; then system calls about this machine are skipped. `spec` may be
// null. Unreadable facts stay empty.
[[nodiscard]] MachineFacts gather_facts(const std::filesystem::path& root, const BridgeSpec* spec);

}  // namespace fieldcast::cli
