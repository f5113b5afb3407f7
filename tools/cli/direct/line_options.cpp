#include "tools/cli/direct/line_options.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "config/sections/port.hpp"
#include "core/model/bus_spec.hpp"
#include "tools/cli/text/text_table.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::uint32_t kLowestBaud = 50, kHighestBaud = 4'000'000;
constexpr std::uint32_t kHighestAddress = 65535;

bool is_path(const std::string& port) { return full_port(port).find('/') != std::string::npos; }

tl::expected<std::map<std::string, std::string>, std::string> settings_of(
    const LineOptions& options) {
  std::map<std::string, std::string> settings;
  for (const std::string& setting : options.settings) {
    const auto equals = setting.find('=');
    if (equals == 0 || equals == std::string::npos)
      return tl::unexpected(fmt::format("--set '{}' is not NAME=VALUE", printable(setting)));
    settings[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
  return settings;
}

}  // namespace

std::string full_port(const std::string& port) {
  if (port.find_first_of("/:") != std::string::npos) return port;
  std::error_code ignored;
  if (std::filesystem::exists(port, ignored)) return "./" + port;
  const std::string device = "/dev/" + port;
  return port.starts_with("tty") || std::filesystem::exists(device, ignored) ? device : port;
}

void add_line_options(CommandLine& line, LineOptions& options) {
  line.text("PORT", options.port, "A serial port (/dev/ttyUSB0, ttyUSB0) or HOST:PORT").required();
  line.text("--protocol", options.protocol,
            std::string(kProtocolHelp) + " (modbus-rtu; for HOST:PORT modbus-tcp)");
  line.number("--baud", options.baud, kLowestBaud, kHighestBaud,
              "Of the line (what the protocol's devices have from the factory)");
  line.text("--format", options.format, "Data bits, parity, stop bits: 8N1, 8E1, 7E2, ..");
  line.number("--address", options.address, 0, kHighestAddress, "Of the device (1)");
  line.texts("--set", options.settings, "NAME=VALUE: an option of the protocol; once for each")
      .one_each();
  line.duration("--timeout", options.timeout, CommandLine::kShortest,
                "To the first byte of a response (500ms)");
  line.number("--retries", options.retries, 0, 10, "More tries after no response (1)");
}

std::string protocol_of(const LineOptions& options) {
  if (!options.protocol.empty()) return options.protocol;
  return is_path(options.port) ? "modbus-rtu" : "modbus-tcp";
}

tl::expected<PortSpec, std::string> port_of(const LineOptions& options, const LineFormat& factory) {
  LineFormat line = factory;
  if (!options.format.empty()) {
    const auto format = config::format_from(options.format);
    if (!format)
      return tl::unexpected(fmt::format("format '{}' is unknown; write 8N1, 8E1, 8O1, 8N2, 7E2, ..",
                                        printable(options.format)));
    line = *format;
    line.baud = factory.baud;
  }
  if (options.baud) line.baud = *options.baud;
  if (is_path(options.port)) {
    SerialPortSpec port;
    port.path = full_port(options.port);
    port.line = line;
    return port;
  }
  const auto host = config::host_port_from(options.port);
  if (!host)
    return tl::unexpected(fmt::format("'{}' is neither a serial port (/dev/ttyUSB0) nor HOST:PORT",
                                      printable(options.port)));
  TcpPortSpec port;
  port.host = host->first;
  port.port = host->second;
  if (options.baud || !options.format.empty()) port.line = line;
  return port;
}

tl::expected<BusSpec, std::string> bus_of(const LineOptions& options,
                                          const NamedProtocol& protocol) {
  const LineFormat factory =
      protocol.built_in != nullptr ? protocol.built_in->factory_line : LineFormat{};
  auto port = port_of(options, factory);
  if (!port) return tl::unexpected(std::move(port.error()));
  if (protocol.built_in != nullptr && protocol.built_in->network_only && !over_network(*port))
    return tl::unexpected(fmt::format("{} needs HOST:PORT; on a serial port it is {}",
                                      protocol.name(), protocol.built_in->instead));
  BusSpec bus;
  bus.name = "line";
  bus.port = *std::move(port);
  DeviceSpec& device = bus.devices.emplace_back();
  device.name = "device";
  device.protocol = protocol.name();
  device.declaration = protocol.declaration;
  device.timeout = options.timeout;
  device.retries = options.retries;
  device.allow_raw_read = device.allow_raw_write = true;
  device.link.address = static_cast<std::uint16_t>(options.address);
  auto settings = settings_of(options);
  if (!settings) return tl::unexpected(std::move(settings.error()));
  device.link.options = *std::move(settings);
  const auto made = make_protocol(device, line_of(bus.port));
  if (!made) {
    const OptionFault& fault = made.error();
    const std::string option = fault.option.empty() ? "--address" : "--set " + fault.option;
    return tl::unexpected(fmt::format("{}: {}; allowed: {}", printable(option),
                                      printable(fault.what), fault.allowed));
  }
  const Traits& traits = (*made)->traits();
  if (options.address < traits.lowest_address || options.address > traits.highest_address)
    return tl::unexpected(fmt::format("--address {}: devices of {} have {} to {}", options.address,
                                      protocol.name(), traits.lowest_address,
                                      traits.highest_address));
  return bus;
}

}  // namespace fieldcast::cli
