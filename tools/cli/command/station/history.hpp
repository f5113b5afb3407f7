#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/model/channel_pattern.hpp"
#include "tools/cli/command/base/command.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/terminal/interrupt.hpp"

namespace fieldcast::cli {

struct HistoryOptions {
  StoreSource source;
  Pattern pattern;
  TimeSpan span;
  std::optional<Duration> every;
  std::optional<std::uint32_t> points;  // maximum for each channel
  bool local = false;                   // times of this machine's time zone, not UTC
  std::string gzip;                     // new compressed file; empty: standard output
  bool csv = false;
  bool json = false;
};

// Returns kOk, kNothing with the reason, or kInterrupted after a whole line. `interrupt` may be
// null. Throws StoreError.
[[nodiscard]] ExitCode history(const HistoryOptions& options, const Streams& to,
                               const Interrupt* interrupt = nullptr);

}  // namespace fieldcast::cli
