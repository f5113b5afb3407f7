// `fieldcast write`: values into channels, or with --at into addresses of a device.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "tools/cli/connection.hpp"
#include "tools/cli/exit_code.hpp"
#include "tools/cli/interrupt.hpp"

namespace fieldcast::cli {

struct WriteOptions {
  ConnectionOptions connection;
  std::vector<std::string> words;  // BUS/DEVICE/CHANNEL=VALUE ..; with `at`: BUS/DEVICE VALUE ..
  std::string at;                  // an address in the PLC's own notation; empty: channels
  std::string byte;                // of a wider item, for an 8-bit type
  std::string type;  // of the values at the address; empty: what the address implies, or uint16
  bool verify = false;
  bool json = false;
  Duration timeout = std::chrono::seconds{5};
};

// The code of the worst result. Nothing is sent when one of the assignments is refused here. Throws
// DdsError.
[[nodiscard]] ExitCode write(const WriteOptions& options, const DdsSpec& spec, Interrupt& interrupt,
                             std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
