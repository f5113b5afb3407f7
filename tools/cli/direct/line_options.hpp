// Port and protocol on the command line: `fieldcast read /dev/ttyUSB0 --baud 9600 --format 8N1
// --address 3 holding:100`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/base/command_line.hpp"
#include "core/model/bus_spec.hpp"
#include "tools/cli/model/named_protocol.hpp"

namespace fieldcast::cli {

struct LineOptions {
  std::string port;      // "/dev/ttyUSB0", "10.0.0.7:502"
  std::string protocol;  // empty: modbus-rtu, or modbus-tcp for HOST:PORT
  // Default: the factory settings of the protocol's devices.
  std::optional<std::uint32_t> baud;
  std::string format;  // "8N1"
  std::uint32_t address = 1;
  std::vector<std::string> settings;  // "NAME=VALUE": options of the protocol
  Duration timeout = std::chrono::milliseconds{500};
  std::uint32_t retries = 1;
};

// "ttyUSB0" becomes /dev/ttyUSB0; "./NAME" is a file of the working directory. HOST:PORT, a path,
// or another name is returned unchanged.
[[nodiscard]] std::string full_port(const std::string& port);

// REQUIRES: `options` lives until the parse.
void add_line_options(CommandLine& line, LineOptions& options);

[[nodiscard]] std::string protocol_of(const LineOptions& options);

// `factory`: default line format. The error is one line.
[[nodiscard]] tl::expected<PortSpec, std::string> port_of(const LineOptions& options,
                                                          const LineFormat& factory);

// A bus with one device "device" without channels; every address may be read and written. The error
// is one line.
[[nodiscard]] tl::expected<BusSpec, std::string> bus_of(const LineOptions& options,
                                                        const NamedProtocol& protocol);

}  // namespace fieldcast::cli
