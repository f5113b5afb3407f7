// `fieldcast watch`: newest samples as a screen (docs/screens.md), lines, or JSON lines.
#pragma once

#include <optional>

#include "core/base/time.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/cli/domain/connection.hpp"

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

}  // namespace fieldcast::cli
