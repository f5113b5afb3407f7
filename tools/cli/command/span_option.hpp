// --from and --to: the time that a command looks at in the store.
#pragma once

#include <optional>
#include <string>

#include "bridge/base/command_line.hpp"
#include "tools/cli/store_source.hpp"

namespace fieldcast::cli {

class SpanOption {
 public:
  void describe(CommandLine& line);
  [[nodiscard]] bool given() const { return !from_.empty() || !to_.empty(); }
  // Without either the last hour; a fault when a text is no time or the end is not behind the
  // beginning.
  [[nodiscard]] std::optional<CommandLine::Fault> read(TimeSpan& span) const;

 private:
  std::string from_, to_;
};

}  // namespace fieldcast::cli
