// --from and --to: the time span that a command reads from the store.
#pragma once

#include <optional>
#include <string>

#include "bridge/base/command_line.hpp"
#include "tools/cli/domain/store_source.hpp"

namespace fieldcast::cli {

class SpanOption {
 public:
  void describe(CommandLine& line);
  [[nodiscard]] bool given() const { return !from_.empty() || !to_.empty(); }
  // Default: the last hour. Fails if a text is not a time or the end is not after the start.
  [[nodiscard]] std::optional<CommandLine::Fault> read(TimeSpan& span) const;

 private:
  std::string from_, to_;
};

}  // namespace fieldcast::cli
