// Runs the bridge's bus engine on a port in this process, without DDS and configuration. Use it on
// one thread; the bus has its own.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/process/command_line.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"
#include "tools/cli/model/address_notation.hpp"
#include "tools/cli/terminal/interrupt.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

class LineCapture;

class DirectBus {
 public:
  static constexpr Duration kOpenLimit = std::chrono::seconds{5};

  // `trace`: prints the bytes, one line each. `capture` must outlive the bus; it may be null.
  // REQUIRES: `bus` is valid as from the loader.
  DirectBus(const BusSpec& bus, bool trace, LineCapture* capture = nullptr);
  ~DirectBus();  // closes the port
  DirectBus(const DirectBus&) = delete;
  DirectBus& operator=(const DirectBus&) = delete;

  // The error is one human-readable line; empty if `interrupt` was raised.
  [[nodiscard]] tl::expected<void, std::string> open(const Interrupt& interrupt);
  // Waits for the result; empty if `interrupt` was raised. REQUIRES: open() was successful.
  [[nodiscard]] std::optional<CommandResult> run(fieldcast::Command command,
                                                 const Interrupt& interrupt);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct DirectRun {
  std::string command;  // for messages: "read"
  const BusSpec& bus;
  std::string capture;  // new capture file; empty: none
  bool trace = false;
};
// Opens the bus and calls `work`. Returns its exit code, or that of a port that does not open.
[[nodiscard]] ExitCode on_direct_bus(const DirectRun& run, const Interrupt& interrupt,
                                     std::ostream& err,
                                     const std::function<ExitCode(DirectBus& bus)>& work);

inline constexpr std::uint32_t kLowestBaud = 50, kHighestBaud = 4'000'000;  // for --baud

// Port and protocol on the command line: `fieldcast read /dev/ttyUSB0 --baud 9600 --format 8N1
// --address 3 holding:100`.
struct LineOptions {
  std::string port;      // "/dev/ttyUSB0", "10.0.0.7:502", "tls:10.0.0.7:802"
  std::string protocol;  // empty: modbus-rtu, or modbus-tcp for HOST:PORT
  // Default: the factory settings of the protocol's devices.
  std::optional<std::uint32_t> baud;
  std::string format;         // "8N1"
  std::string address = "1";  // of the device; declared protocols also have long ones and texts
  std::vector<std::string> settings;  // "NAME=VALUE": options of the protocol
  Duration timeout = std::chrono::milliseconds{500};
  std::uint32_t retries = 1;
  TlsSpec tls;              // with "tls:"
  std::string server_name;  // with "tls:"; empty: its host
};

// "ttyUSB0" becomes /dev/ttyUSB0; "./NAME" is a file of the working directory. HOST:PORT, a path,
// or another name is returned unchanged.
[[nodiscard]] std::string full_port(const std::string& port);

// REQUIRES: `options` lives until the parse.
void add_line_options(CommandLine& line, LineOptions& options);

[[nodiscard]] std::string protocol_of(const LineOptions& options);

// `factory`: default line format.
[[nodiscard]] tl::expected<PortSpec, std::string> port_of(const LineOptions& options,
                                                          const LineFormat& factory);

// A bus with one device "device" without channels; every address may be read and written.
[[nodiscard]] tl::expected<BusSpec, std::string> bus_of(const LineOptions& options,
                                                        const NamedProtocol& protocol);

}  // namespace fieldcast::cli
