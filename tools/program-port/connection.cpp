#include "tools/program-port/connection.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <cstdio>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/process/secret.hpp"
#include "config/sections/port_text.hpp"
#include "core/base/duration_text.hpp"
#include "core/base/message_text.hpp"
#include "core/program/frame.hpp"
#include "tools/program-port/list_session.hpp"
#include "tools/program-port/local_port.hpp"
#include "tools/program-port/port_session.hpp"

namespace fieldcast::port {
namespace {

using program::PortEnd;

constexpr DurationBounds kHeartbeat{std::chrono::milliseconds{500}, std::chrono::minutes{10}, true};
constexpr std::uint32_t kMostBaud = 4'000'000;

CommandLine::Option describe_server(CommandLine& line, Connection& given) {
  return line.text("--server", given.server, "HOST:PORT where the bridge listens for engineers");
}

void describe_login(CommandLine& line, Connection& given) {
  line.text("--user", given.user, "a user of the bridge with the role programmer");
  line.text("--password-file", given.password_file,
            "its first line is the password; readable by you alone");
  line.flag("--tls", given.tls, "the bridge speaks TLS, as it must off the loopback");
  line.text("--ca", given.authorities,
            "PEM file with who signs the bridge's certificate; default: the system's");
  line.text("--certificate", given.certificate,
            "PEM file with your certificate, where the bridge asks for one");
  line.text("--key", given.key, "its private key; readable by you alone");
}

}  // namespace

void describe_connection(CommandLine& line, Connection& given) {
  line.set_footer(
      "Ends with Ctrl-C, or when the device or the bridge disconnects.\n"
      "Exit codes: 0 stopped, 1 failure, 2 command line, 3 refused, 4 no serial port, 5 bridge "
      "unreachable or disconnected, 6 device lost.");
  describe_server(line, given).required();
  line.text("--device", given.device, "number of the device").required();
  line.text(kLocalPortOption.name, given.port, kLocalPortOption.help).required();
  line.text("--line", given.line,
            "data bits, parity and stop bits of the PLC's line, such as 7E2, where it is a "
            "serial line of the bridge: a virtual port does not report those that the software "
            "sets; default: as the bridge's configuration has them");
  line.number("--baud", given.baud, 1, kMostBaud,
              "baud rate of the PLC's line; default: as the software sets it, if the port reports "
              "that, else as the bridge's configuration has it")
      .needs("--line");
  describe_login(line, given);
  line.flag(
      "--markers", given.markers,
      "marker frames: instructions that end in CR, as older bridges know them; default: any bytes");
  line.text("--heartbeat", given.heartbeat,
            "time between heartbeats; a bridge that is silent for 3.5 of them is disconnected")
      .show_default();
  line.flag("--reconnect", given.reconnect,
            "connect again when the bridge or the device is lost or not there, after 1 s and up to "
            "1 min, or when the software sends again; the port stays open. A refused login ends "
            "the program");
  line.text("--log", given.log, "file to which all lines are appended, with their time");
  line.flag("--json", given.json, "say everything as JSON lines");
}

CommandLine::Option describe_list(CommandLine& line, Connection& given) {
  line.set_footer(
      "Exit codes: 0 listed, 1 failure, 2 command line, 3 refused, 5 bridge unreachable or "
      "disconnected.");
  const auto server = describe_server(line, given);
  describe_login(line, given);
  line.flag("--json", given.json, "JSON lines");
  return server;
}

namespace {

ExitCode fail(ExitCode code, const std::string& text) {
  std::fprintf(stderr, "fieldcast-port: %s\n", text.c_str());
  return code;
}

tl::expected<Secret, std::string> password_of(const std::string& path) {
  auto password = read_secret_line(path, Readers::kOwner);
  if (password && password->size() > program::kMaxLoginText)
    return tl::make_unexpected(path + ": a password of more than 128 bytes");
  return password;
}

ExitCode exit_code_of(const PortEnd& end) {
  switch (end.kind) {
    case PortEnd::Kind::kStopped: return kStopped;
    case PortEnd::Kind::kRefused: return kRefused;
    case PortEnd::Kind::kDeviceLost: return kDeviceLost;
    case PortEnd::Kind::kBridgeGone: return kBridgeGone;
    case PortEnd::Kind::kProtocol: return kTrouble;
  }
  return kTrouble;
}

using Usage = tl::expected<void, std::string>;

Usage read_line(const Connection& given, PortOptions& options) {
  if (given.line.empty()) return {};
  options.rules.baud = given.baud;
  options.rules.format = config::format_from(given.line);
  if (!options.rules.format)
    return tl::make_unexpected(
        fmt::format("--line '{}' is no format such as 8N1, 7E1 or 7E2", given.line));
  if (given.markers)
    return tl::make_unexpected(
        "--line cannot be sent to a bridge that speaks marker frames only (--markers)");
  return {};
}

Usage read_certificate(const Connection& given, PortOptions& options) {
  if (given.certificate.empty() != given.key.empty())
    return tl::make_unexpected("--certificate and --key go together");
  if (given.certificate.empty()) return {};
  if (!options.bridge.tls) return tl::make_unexpected("a certificate is shown with --tls alone");
  options.bridge.own = {.certificate = given.certificate, .key = given.key};
  return check_secret_file(given.key, Readers::kOwner);
}

Usage read_login(const Connection& given, PortOptions& options) {
  if (given.user.empty() != given.password_file.empty())
    return tl::make_unexpected("--user and --password-file go together");
  if (given.user.empty()) return {};
  if (!options.bridge.tls && !on_loopback({options.bridge.host, 0}))
    return tl::make_unexpected("a password is not sent without --tls");
  if (given.user.size() > program::kMaxLoginText) return tl::make_unexpected("--user is too long");
  auto password = password_of(given.password_file);
  if (!password) return tl::make_unexpected(password.error());
  options.rules.user = given.user;
  options.rules.password = std::string(password->text());
  return {};
}

// Without the device and its port.
tl::expected<PortOptions, std::string> bridge_of(const Connection& given) {
  const auto server = config::host_port_from(given.server);
  if (!server)
    return tl::make_unexpected(fmt::format("--server '{}' names no host and port", given.server));
  PortOptions options;
  options.bridge.host = server->first;
  options.bridge.port = server->second;
  options.bridge.tls = given.tls || !given.authorities.empty();
  options.bridge.authorities = given.authorities;
  return read_certificate(given, options)
      .and_then([&] { return read_login(given, options); })
      .map([&] { return std::move(options); });
}

tl::expected<PortOptions, std::string> options_of(const Connection& given) {
  auto options = bridge_of(given);
  if (!options) return options;
  if (!program::is_device_number(given.device))
    return tl::make_unexpected(fmt::format("--device '{}' is no device number: {}", given.device,
                                           program::kDeviceNumberForm));
  options->rules.number = given.device;
  options->rules.by_length = !given.markers;
  const auto heartbeat = read_duration(given.heartbeat, kHeartbeat);
  if (!heartbeat)
    return tl::make_unexpected("--heartbeat: " + fault_text(given.heartbeat, heartbeat.error()));
  options->rules.heartbeat = *heartbeat;
  options->reconnect = given.reconnect;
  return read_line(given, *options).map([&] { return *std::move(options); });
}

tl::expected<FileDescriptor, std::string> opened_log(const std::string& path) {
  if (path.empty()) return FileDescriptor{};
  FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644));
  if (!file)
    return tl::make_unexpected(
        fmt::format("--log {}: cannot be written: {}", path, errno_text(errno)));
  return file;
}

program::LineSettings settings_of(const PortOptions& options) {
  program::LineSettings line{.baud = options.rules.baud};
  if (const auto& format = options.rules.format) {
    line.data_bits = format->data_bits;
    line.parity = format->parity;
    line.stop_bits = format->stop_bits;
  }
  return line;
}

}  // namespace

std::optional<std::string> fault_of(const Connection& given) {
  const auto options = options_of(given);
  return options ? std::nullopt : std::optional(options.error());
}

ExitCode run_connection(const Connection& given) {
  const auto log = opened_log(given.log);
  if (!log) return fail(kUsage, log.error());
  PortReport report(given.json, given.device, given.port, log->get());
  const auto failed = [&report](ExitCode code, const std::string& text) {
    report.note(fmt::format("ended with exit code {}: {}", static_cast<int>(code), text));
    return fail(code, text);
  };
  auto options = options_of(given);
  if (!options) return failed(kUsage, options.error());
  auto port = open_local_port(given.port, settings_of(*options));
  if (!port) return failed(kNoPort, port.error());
  if (const std::string remark = (*port)->remark(); !remark.empty()) report.state("port", remark);
  try {
    boost::asio::io_context io{1};
    PortSession session(io, *std::move(options), std::move(*port), report);
    session.start();
    io.run();
    const ExitCode code = exit_code_of(session.end());
    return code == kStopped ? code : failed(code, session.end().text);
  } catch (const std::exception& error) { return failed(kTrouble, error.what()); }
}

ExitCode run_list(const Connection& given) {
  const auto options = bridge_of(given);
  if (!options) return fail(kUsage, options.error());
  try {
    boost::asio::io_context io{1};
    ListSession session(io, options->bridge, {options->rules.user, options->rules.password});
    session.start();
    io.run();
    if (!session.result()) {
      const PortEnd& end = session.result().error();
      return fail(exit_code_of(end), printable(end.text));
    }
    for (const std::string& line : lines_of(*session.result(), given.json))
      std::printf("%s\n", line.c_str());
    return kStopped;
  } catch (const std::exception& error) { return fail(kTrouble, error.what()); }
}

}  // namespace fieldcast::port
