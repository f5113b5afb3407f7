#include "tools/import/options_fault.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/loader/loader.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/import/points/writer.hpp"

namespace fieldcast::importing {
namespace {

// Line in configuration_of() that uses the options.
struct OptionLine {
  unsigned line;
  std::string_view options;
};
constexpr std::array kOptionLines{OptionLine{1, "--bridge"},
                                  OptionLine{4, "--port, --baud, --format"},
                                  OptionLine{5, "--protocol"}, OptionLine{8, "--address"}};

// Missing options get values that a list may still replace.
std::string configuration_of(const ImportOptions& options) {
  Port port = options.port;
  const bool said = !port.serial.empty() || !port.tcp.empty();
  const ProtocolEntry* entry = find_protocol(options.protocol);
  const bool no_line = !port.line.baud && port.line.format.empty();
  const bool network = entry != nullptr ? entry->network_only : options.protocol.empty() && no_line;
  if (!said) (network ? port.tcp : port.serial) = network ? "127.0.0.1:502" : "/dev/ttyUSB0";
  std::string protocol = options.protocol;
  if (protocol.empty()) protocol = port.tcp.empty() ? "modbus-rtu" : "modbus-tcp";
  if (!port.tcp.empty() && protocol == "modbus-tcp") port.line = {};  // as arrange() does
  return fmt::format(
      "bridge: {}\nbuses:\n  - name: check\n    port: {{ {} }}\n    protocol: {}\n    devices:\n"
      "      - name: check\n        address: {}\n        channels: []\n",
      yaml_text(options.bridge), port_text(port), protocol, options.address.value_or(1));
}

}  // namespace

std::optional<std::string> fault_of_options(const ImportOptions& options) {
  constexpr std::string_view kName = "options";
  config::FileReader nothing;
  nothing.read = [](const std::string&) -> tl::expected<std::string, config::FileError> {
    return tl::unexpected(config::FileError::kMissing);
  };
  const auto loaded = config::load_text(configuration_of(options), std::string(kName), nothing);
  if (loaded) return std::nullopt;
  for (const config::Fault& fault : loaded.error()) {
    const auto said = std::ranges::find(kOptionLines, fault.line, &OptionLine::line);
    if (said == kOptionLines.end()) continue;
    return fmt::format("{}: {}{}", said->options, fault.what,
                       fault.allowed.empty() ? "" : "; allowed: " + fault.allowed);
  }
  return std::nullopt;
}

}  // namespace fieldcast::importing
