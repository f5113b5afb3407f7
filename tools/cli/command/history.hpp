// `fieldcast history`: the stored samples of channels, or what the channels were in each minute,
// hour or any other stretch of time; as lines, CSV or JSON lines. Reads the store, needs no bridge.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <string>

#include "core/model/pattern.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"
#include "tools/cli/store_source.hpp"
#include "tools/cli/view/time_text.hpp"

namespace fieldcast::cli {

struct HistoryOptions {
  StoreSource source;
  Pattern pattern;
  TimeSpan span;
  // Either, or neither: samples.
  std::optional<Duration> every;
  std::optional<std::uint32_t> points;  // for each channel, at most
  Zone zone = Zone::kUtc;               // of times for people and in CSV
  std::string gzip;  // the new file that is written, compressed; empty: standard output
  bool csv = false;
  bool json = false;
};

// kOk when there was something, kNothing with the reason when not, kInterrupted behind a whole line
// when `interrupt` was raised; it may be null. Throws StoreError.
[[nodiscard]] ExitCode history(const HistoryOptions& options, std::ostream& out, std::ostream& err,
                               const Interrupt* interrupt = nullptr);

}  // namespace fieldcast::cli
