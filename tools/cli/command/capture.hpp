// `fieldcast capture BUS --out FILE.pcapng`: what passes on the wire of a bus of a bridge on this
// machine, for Wireshark. Needs no DDS.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct CaptureOptions {
  std::string bus;
  std::string out;     // "-": standard output
  std::string bridge;  // where several have a bus of this name; empty: the one that has it
  std::optional<Duration> time;
  std::uint64_t size = 0;  // bytes of the file; 0: no bound
};

// "250kB", "10MB", "1GB", "5000": bytes; 0 for what is none of these.
[[nodiscard]] std::uint64_t bytes_from(const std::string& text);

// kOk also after Ctrl-C, which is how a capture without an end ends. kNoBridge, kNothing: no such
// bus. kTrouble: the file cannot be written, or the bridge was lost; what came is whole.
[[nodiscard]] ExitCode capture(const CaptureOptions& options, const Interrupt& interrupt,
                               std::ostream& err);

}  // namespace fieldcast::cli
