// fieldcast-port: connects a virtual serial port to a PLC behind a bridge while it runs.
#include <fmt/format.h>

#include <cstdio>

#include "bridge/base/write_faults.hpp"
#include "bridge/process/command_line.hpp"
#include "bridge/process/secret.hpp"
#include "config/sections/port.hpp"
#include "core/base/duration_text.hpp"
#include "core/program/frame.hpp"
#include "tools/program-port/port_session.hpp"

namespace {

using namespace fieldcast;
using program::PortEnd;

enum ExitCode : int {
  kStopped = 0,
  kTrouble = 1,
  kUsage = 2,
  kRefused = 3,
  kNoPort = 4,
  kBridgeGone = 5,
  kDeviceLost = 6
};

constexpr DurationBounds kHeartbeat{std::chrono::milliseconds{500}, std::chrono::minutes{10}, true};

struct Arguments {
  std::string server, device, link, line, user, password_file, authorities, certificate, key;
  std::string heartbeat = "5s";
  bool tls = false, markers = false, json = false;
};

void describe(CommandLine& line, Arguments& given) {
  line.set_footer(
      "Ends with Ctrl-C, or when the device or the bridge disconnects; the port is removed.\n"
      "Exit codes: 0 stopped, 1 failure, 2 command line, 3 refused, 4 no virtual port, 5 bridge "
      "unreachable or disconnected, 6 device "
      "lost.");
  line.text("--server", given.server, "HOST:PORT where the bridge listens for engineers")
      .required();
  line.text("--device", given.device, "number of the device").required();
  line.text("--link", given.link,
            "where the virtual port appears, such as /tmp/plc; never over a file that is not ours")
      .required();
  line.text("--line", given.line,
            "data bits, parity and stop bits of the PLC's line, such as 7E2, where it is a "
            "serial line of the bridge: a virtual "
            "port reports the baud rate that the software sets, but not these; default: as the "
            "bridge's configuration has them");
  line.text("--user", given.user, "a user of the bridge with the role programmer");
  line.text("--password-file", given.password_file,
            "its first line is the password; readable by you alone (chmod 600)");
  line.flag("--tls", given.tls, "the bridge speaks TLS, as it must off the loopback");
  line.text("--ca", given.authorities,
            "PEM file with who signs the bridge's certificate; default: the system's");
  line.text("--certificate", given.certificate,
            "PEM file with your certificate, where the bridge asks for one");
  line.text("--key", given.key, "its private key; readable by you alone (chmod 600)");
  line.flag(
      "--markers", given.markers,
      "marker frames: instructions that end in CR, as older bridges know them; default: any bytes");
  line.text("--heartbeat", given.heartbeat,
            "time between heartbeats; a bridge that is silent for 3.5 of them is disconnected")
      .show_default();
  line.flag("--json", given.json, "say everything as JSON lines");
}

int fail(ExitCode code, const std::string& text) {
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

Usage read_line(const Arguments& given, port::PortOptions& options) {
  if (given.line.empty()) return {};
  options.rules.format = config::format_from(given.line);
  if (!options.rules.format)
    return tl::make_unexpected(
        fmt::format("--line '{}' is no format such as 8N1, 7E1 or 7E2", given.line));
  if (given.markers)
    return tl::make_unexpected(
        "--line cannot be sent to a bridge that speaks marker frames only (--markers)");
  return {};
}

Usage read_certificate(const Arguments& given, port::PortOptions& options) {
  if (given.certificate.empty() != given.key.empty())
    return tl::make_unexpected("--certificate and --key go together");
  if (given.certificate.empty()) return {};
  if (!options.tls) return tl::make_unexpected("a certificate is shown with --tls alone");
  options.own = {.certificate = given.certificate, .key = given.key};
  return check_secret_file(given.key, Readers::kOwner);
}

Usage read_login(const Arguments& given, port::PortOptions& options) {
  if (given.user.empty() != given.password_file.empty())
    return tl::make_unexpected("--user and --password-file go together");
  if (given.user.empty()) return {};
  if (!options.tls && !on_loopback({options.host, 0}))
    return tl::make_unexpected("a password is not sent without --tls");
  if (given.user.size() > program::kMaxLoginText) return tl::make_unexpected("--user is too long");
  auto password = password_of(given.password_file);
  if (!password) return tl::make_unexpected(password.error());
  options.rules.user = given.user;
  options.rules.password = std::string(password->text());
  return {};
}

tl::expected<port::PortOptions, std::string> options_of(const Arguments& given) {
  const auto server = config::host_port_from(given.server);
  if (!server)
    return tl::make_unexpected(fmt::format("--server '{}' names no host and port", given.server));
  if (!program::is_device_number(given.device))
    return tl::make_unexpected(fmt::format("--device '{}' is no device number: {}", given.device,
                                           program::kDeviceNumberForm));
  port::PortOptions options;
  options.host = server->first;
  options.server_port = server->second;
  options.tls = given.tls || !given.authorities.empty();
  options.authorities = given.authorities;
  options.rules.number = given.device;
  options.rules.by_length = !given.markers;
  const auto heartbeat = read_duration(given.heartbeat, kHeartbeat);
  if (!heartbeat)
    return tl::make_unexpected("--heartbeat: " + fault_text(given.heartbeat, heartbeat.error()));
  options.rules.heartbeat = *heartbeat;
  return read_line(given, options)
      .and_then([&] { return read_certificate(given, options); })
      .and_then([&] { return read_login(given, options); })
      .map([&] { return std::move(options); });
}

int run(const Arguments& given) {
  auto options = options_of(given);
  if (!options) return fail(kUsage, options.error());
  auto pty = sim::PtyPort::open(given.link);
  if (!pty) return fail(kNoPort, pty.error());
  port::PortReport report(given.json, given.device, given.link);
  boost::asio::io_context io{1};
  port::PortSession session(io, *std::move(options), std::move(*pty), report);
  session.start();
  io.run();
  const ExitCode code = exit_code_of(session.end());
  return code == kStopped ? code : fail(code, session.end().text);
}

}  // namespace

int main(int argc, char** argv) {
  make_writes_fail_not_kill();
  guard_memory();
  Arguments given;
  CommandLine line("fieldcast-port",
                   "Makes a virtual serial port at PATH that leads to a PLC behind a bridge: "
                   "programming software opens it as a COM port.");
  describe(line, given);
  if (const auto fault = line.parse_or_print(argc, argv)) return *fault ? kUsage : kStopped;
  try {
    return run(given);
  } catch (const std::exception& error) { return fail(kTrouble, error.what()); }
}
