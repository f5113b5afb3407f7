// `fieldcast capture BUS --out FILE.pcapng`: captures a bus of a bridge on this machine. Needs no
// DDS.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct CaptureOptions {
  std::string bus;
  std::string out;     // "-": standard output
  std::string bridge;  // needed if several bridges have a bus of this name; else empty
  std::optional<Duration> time;
  std::uint64_t size = 0;  // maximum file size in bytes; 0: no limit
};

// "250kB", "10MB", "1GB", "5000"; 0 for other text.
[[nodiscard]] std::uint64_t bytes_from(const std::string& text);

// kOk also after Ctrl-C. kNoBridge, kNothing: no such bus. kTrouble: the file cannot be written or
// the bridge was lost; earlier blocks are complete.
[[nodiscard]] ExitCode capture(const CaptureOptions& options, const Interrupt& interrupt,
                               std::ostream& err);

}  // namespace fieldcast::cli
