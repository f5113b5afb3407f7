#include <fcntl.h>
#include <fmt/format.h>

#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <memory>
#include <ostream>
#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/port/serial_line.hpp"
#include "bridge/process/secret.hpp"
#include "bridge/program/module/module_client.hpp"
#include "config/sections/port.hpp"
#include "core/model/port_spec.hpp"
#include "core/program/frame.hpp"
#include "tools/cli/command/base/command.hpp"

namespace fieldcast::cli {
namespace {

using Wrong = tl::unexpected<std::string>;

struct ModuleArguments {
  std::string server, number, prefix, line, format, authorities, certificate, key, secret_file;
  std::uint32_t baud = 19200;
  bool tls = false;
};

tl::expected<FileDescriptor, std::string> open_line(const SerialPortSpec& spec) {
  FileDescriptor line(::open(spec.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!line.valid()) return Wrong(spec.path + ": " + errno_text(errno));
  if (const auto set = set_up_line(line.get(), spec); !set)
    return Wrong(spec.path + ": " + set.error());
  return line;
}

tl::expected<program::ModuleOptions, std::string> options_of(const ModuleArguments& given) {
  program::ModuleOptions options;
  const auto server = config::host_port_from(given.server);
  if (!server) return Wrong(fmt::format("--server '{}' names no host and port", given.server));
  if (!program::is_device_number(given.number))
    return Wrong(fmt::format("--number '{}' is no device number: {}", given.number,
                             program::kDeviceNumberForm));
  options.host = server->first;
  options.port = server->second;
  options.number = given.number;
  options.prefix = given.prefix;
  options.tls = given.tls || !given.authorities.empty() || !given.certificate.empty();
  options.authorities = given.authorities;
  if (given.certificate.empty() != given.key.empty())
    return Wrong("--certificate and --key go together");
  if (!given.certificate.empty()) {
    options.own = {.certificate = given.certificate, .key = given.key};
    if (const auto closed = check_secret_file(given.key, Readers::kOwnerAndGroup); !closed)
      return Wrong(closed.error());
  }
  if (given.secret_file.empty()) return options;
  auto secret = read_secret_line(given.secret_file, Readers::kOwnerAndGroup);
  if (!secret) return Wrong(secret.error());
  options.secret = *std::move(secret);
  return options;
}

tl::expected<SerialPortSpec, std::string> serial_line_of(const ModuleArguments& given) {
  SerialPortSpec line;
  line.path = given.line;
  const auto format = config::format_from(given.format.empty() ? "8N1" : given.format);
  if (!format)
    return Wrong(fmt::format("--format '{}' is no format such as 8N1, 7E1 or 7E2", given.format));
  line.line = *format;
  line.line.baud = given.baud;
  return line;
}

// Runs until SIGINT or SIGTERM.
ExitCode module(const ModuleArguments& given, const Streams& to) {
  auto options = options_of(given);
  const auto line = serial_line_of(given);
  if (!options || !line) {
    to.err << (options ? line.error() : options.error()) << '\n';
    return ExitCode::kUsage;
  }
  boost::asio::io_context io{1};
  const auto client = std::make_shared<program::ModuleClient>(
      io, *std::move(options), [&] { return open_line(*line); },
      [&](const std::string& text) { to.out << given.number << ": " << text << std::endl; });
  boost::asio::signal_set signals(io, SIGINT, SIGTERM);
  signals.async_wait([&](boost::system::error_code fault, int) {
    if (!fault) client->stop();
  });
  client->start();
  io.run();
  return ExitCode::kOk;
}

void describe_module(CommandLine& line, ModuleArguments& given) {
  line.text("--server", given.server, "HOST:PORT where the bridge listens for modules").required();
  line.text("--number", given.number, "The number that it sends").required();
  line.text("--line", given.line, "The serial line, such as /dev/ttyUSB0").required();
  line.number("--baud", given.baud, 300, 4'000'000, "Of the line").show_default();
  line.text("--format", given.format, "Of the line: 8N1, 7E2, .. (8N1)");
  line.text("--prefix", given.prefix, "Before the number, as the bridge's `prefix` has it");
  line.flag("--tls", given.tls, "The bridge speaks TLS");
  line.text("--ca", given.authorities,
            "PEM file with who signs the bridge's certificate (the system's)");
  line.text("--certificate", given.certificate, "PEM file with the module's certificate");
  line.text("--key", given.key, "Its private key; nobody else may read it");
  line.text("--secret-file", given.secret_file,
            "The secret is its first line; nobody else may read it");
}

}  // namespace

CommandRow module_command() {
  return command_row("module", "Dial in at a bridge with a serial line of this machine",
                     describe_module, module);
}

}  // namespace fieldcast::cli
