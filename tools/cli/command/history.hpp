// `fieldcast history`: the stored samples of channels, as lines, CSV or JSON lines. Reads the
// store, needs no bridge.
#pragma once

#include <iosfwd>

#include "core/model/pattern.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/store_source.hpp"

namespace fieldcast::cli {

struct HistoryOptions {
  StoreSource source;
  Pattern pattern;
  TimeSpan span;
  bool csv = false;
  bool json = false;
};

// kOk when there were samples, kNothing with the reason when not. Throws StoreError.
[[nodiscard]] ExitCode history(const HistoryOptions& options, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
