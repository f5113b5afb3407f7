// `fieldcast acquire`: reads on demand, of a channel, of all channels of a device, or with --at of
// addresses.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>

#include "tools/cli/connection.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct AcquireOptions {
  ConnectionOptions connection;
  std::string target;       // BUS/DEVICE or BUS/DEVICE/CHANNEL
  std::string at;           // an address in the PLC's own notation; empty: channels
  std::uint32_t count = 1;  // values at the address
  std::string byte;         // of a wider item, for an 8-bit type
  std::string type;  // of the values at the address; empty: what the address implies, or uint16
  bool json = false;
  Duration timeout = std::chrono::seconds{5};
};

// The code of the worst result. Throws DdsError.
[[nodiscard]] ExitCode acquire(const AcquireOptions& options, const DdsSpec& spec,
                               Interrupt& interrupt, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
