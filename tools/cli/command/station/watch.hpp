// `fieldcast watch`: newest samples as a screen (docs/screens.md), lines, or JSON lines.
#pragma once

#include <iosfwd>
#include <optional>

#include "core/base/time.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct WatchOptions {
  ConnectionOptions connection;
  Pattern pattern;
  bool json = false;
  bool plain = false;               // lines, also in a terminal
  bool unicode = false;             // the terminal supports Unicode
  bool once = false;                // prints every matching channel once, sorted by name
  std::optional<Duration> time;     // ends after this; with `once`: the longest wait
  std::optional<Duration> refresh;  // requested refresh while the command runs
};

// Returns kOk if samples arrived or Ctrl-C ended an endless watch; else kNothing or kNoBridge.
// Throws DdsError.
[[nodiscard]] ExitCode watch(const WatchOptions& options, const Connection& connection,
                             Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
