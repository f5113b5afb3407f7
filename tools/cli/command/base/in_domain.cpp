#include "tools/cli/command/base/in_domain.hpp"

#include <ostream>

namespace fieldcast::cli {

ExitCode in_domain(const ConnectionOptions& options, const Streams& streams,
                   const DomainCommand& command) {
  Interrupt interrupt;  // before DDS starts its threads
  const auto connection = resolve(options);
  if (!connection) {
    streams.err << connection.error() << '\n';
    return ExitCode::kUsage;
  }
  return command(*connection, interrupt);
}

}  // namespace fieldcast::cli
