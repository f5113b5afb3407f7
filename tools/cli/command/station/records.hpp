// `fieldcast devices` and `fieldcast audit`: print records of the store. Need no bridge.
#pragma once

#include <iosfwd>

#include "tools/cli/domain/connection.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct DevicesOptions {
  StoreSource source;
  bool json = false;
};
struct AuditOptions {
  StoreSource source;
  TimeSpan span;
  bool json = false;
};

// Return kOk if there are records, else kNothing. Throw StoreError.
[[nodiscard]] ExitCode devices(const DevicesOptions& options, std::ostream& out, std::ostream& err);
[[nodiscard]] ExitCode audit(const AuditOptions& options, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
