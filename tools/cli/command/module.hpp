// `fieldcast module`: connects a serial line of this machine to a bridge as a dialling module.
#pragma once

#include <iosfwd>
#include <string>
#include <tl/expected.hpp>

#include "bridge/program/module/module_client.hpp"
#include "core/model/port_spec.hpp"
#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {

struct ModuleArguments {
  std::string server, number, prefix, line, format, authorities, certificate, key, secret_file;
  std::uint32_t baud = 19200;
  bool tls = false;
};

[[nodiscard]] tl::expected<program::ModuleOptions, std::string> options_of(
    const ModuleArguments& given);
[[nodiscard]] tl::expected<SerialPortSpec, std::string> serial_line_of(
    const ModuleArguments& given);

// Runs until SIGINT or SIGTERM.
[[nodiscard]] ExitCode module(const ModuleArguments& given, std::ostream& out, std::ostream& err);

}  // namespace fieldcast::cli
