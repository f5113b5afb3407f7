// Reads what `fieldcast doctor` wants to know from the machine: /proc, /sys, the ports, the disk.
// Changes nothing and opens no port. Main thread.
#pragma once

#include <filesystem>

#include "core/model/spec.hpp"
#include "tools/cli/doctor/facts.hpp"

namespace fieldcast::cli {

// `root` stands for "/" where files of the machine are looked at: a folder with such files is
// looked at instead, and system calls that know but this machine are left out. `spec`: may be null.
// What cannot be read is not known.
[[nodiscard]] MachineFacts gather_facts(const std::filesystem::path& root, const BridgeSpec* spec);

}  // namespace fieldcast::cli
