// `fieldcast watch`: the newest samples as a screen (docs/screens.md), as lines, or as JSON lines.
#pragma once

#include <iosfwd>
#include <optional>

#include "core/base/time.hpp"
#include "core/model/pattern.hpp"
#include "tools/cli/connection.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct WatchOptions {
  ConnectionOptions connection;
  Pattern pattern;
  bool json = false;
  bool plain = false;               // lines, also in a terminal
  bool unicode = false;             // the terminal shows more than ASCII
  bool once = false;                // every matching channel once, in the order of names
  std::optional<Duration> time;     // ends after this; with once: the longest wait
  std::optional<Duration> refresh;  // keeps the channels this fresh while it runs
};

// kOk when samples came (and for an endless watch that Ctrl-C ends), kNothing or kNoBridge when
// not. Throws DdsError.
[[nodiscard]] ExitCode watch(const WatchOptions& options, const Connection& connection,
                             Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
