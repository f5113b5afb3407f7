// How a line is reached and what is spoken on it, said on the command line instead of in a
// configuration: `fieldcast read /dev/ttyUSB0 --baud 9600 --format 8N1 --address 3 holding:100`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/command_line.hpp"
#include "core/model/spec.hpp"
#include "tools/cli/model/named_protocol.hpp"

namespace fieldcast::cli {

struct LineOptions {
  std::string port;      // "/dev/ttyUSB0", "10.0.0.7:502"
  std::string protocol;  // empty: modbus-rtu, or modbus-tcp for HOST:PORT
  // Without them as the protocol's devices come from the factory.
  std::optional<std::uint32_t> baud;
  std::string format;  // "8N1"
  std::uint32_t address = 1;
  std::vector<std::string> settings;  // "NAME=VALUE": the protocol's own options
  Duration timeout = std::chrono::milliseconds{500};
  std::uint32_t retries = 1;
};

// The path of a serial port that is given by its name alone: "ttyUSB0" is /dev/ttyUSB0, a file of
// the working directory is "./NAME". HOST:PORT, a path, and any other name are returned unchanged.
[[nodiscard]] std::string full_port(const std::string& port);

// REQUIRES: options live until the parse.
void add_line_options(CommandLine& line, LineOptions& options);

// The protocol that was said, or the usual one of the port.
[[nodiscard]] std::string protocol_of(const LineOptions& options);

// The port alone. `factory`: the line where none is said. The error is one line.
[[nodiscard]] tl::expected<PortSpec, std::string> port_of(const LineOptions& options,
                                                          const LineFormat& factory);

// One bus named as the port, one device "device" without channels, which may be read and written
// at any address. The error is one line.
[[nodiscard]] tl::expected<BusSpec, std::string> bus_of(const LineOptions& options,
                                                        const NamedProtocol& protocol);

}  // namespace fieldcast::cli
