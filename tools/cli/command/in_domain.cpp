#include "tools/cli/command/in_domain.hpp"

#include <ostream>

namespace fieldcast::cli {

ExitCode in_domain(const ConnectionOptions& connection, const Streams& streams,
                   const DomainCommand& command) {
  Interrupt interrupt;  // before DDS starts its threads
  const auto spec = resolve(connection);
  if (!spec) {
    streams.err << spec.error() << '\n';
    return ExitCode::kUsage;
  }
  return command(*spec, interrupt);
}

}  // namespace fieldcast::cli
