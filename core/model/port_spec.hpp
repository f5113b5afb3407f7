// The port of a bus, with all defaults. A new port type is a struct with the same functions and an
// alternative of PortSpec. Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/time.hpp"
#include "core/frame/line.hpp"
#include "core/model/tls_spec.hpp"

namespace fieldcast {

// Protection against a second master if the bridges of a standby group cannot communicate.
enum class Fence : std::uint8_t {
  kNone,
  kListen,     // a bridge listens before it sends; the sending one is never silent for long
  kLock,       // the lock of the port, for bridges on one host
  kOneClient,  // a serial server that accepts one connection
};
[[nodiscard]] std::string_view to_text(Fence fence);  // "none", "listen", "lock", "one-client"

// See core/bus/wire/fence_setup.hpp for the resulting times.
struct FenceSpec {
  std::optional<Fence> kind;  // empty if not configured
  // kListen: maximum time between two requests of the sending bridge.
  Duration hold = std::chrono::milliseconds{100};
  [[nodiscard]] bool is(Fence fence) const { return kind == fence; }
  friend bool operator==(const FenceSpec&, const FenceSpec&) = default;
};

struct SerialPortSpec {
  std::string path;
  LineFormat line;
  bool rs485 = false;       // kernel direction control (TIOCSRS485)
  bool low_latency = true;  // ASYNC_LOW_LATENCY if the driver supports it
  bool exclusive = true;    // flock() and TIOCEXCL
  FenceSpec fence{};

  static constexpr bool kOverNetwork = false;
  [[nodiscard]] static bool has_datagrams() { return false; }
  [[nodiscard]] static bool has_tls() { return false; }
  [[nodiscard]] std::string name() const { return path; }  // "/dev/ttyUSB0"
  [[nodiscard]] std::optional<LineFormat> known_line() const { return line; }
  friend bool operator==(const SerialPortSpec&, const SerialPortSpec&) = default;
};

struct TcpPortSpec {
  std::string host;
  std::uint16_t port = 502;
  // Of the serial line behind a serial server; empty for a plain TCP device.
  std::optional<LineFormat> line;
  Duration connect_timeout = std::chrono::seconds{3};
  FenceSpec fence{};
  bool datagrams = false;  // UDP: each frame is a datagram
  std::optional<TlsSpec> tls{};
  std::string server_name{};  // in the server's certificate; empty: `host`

  static constexpr bool kOverNetwork = true;
  [[nodiscard]] bool has_datagrams() const { return datagrams; }
  [[nodiscard]] bool has_tls() const { return tls.has_value(); }
  // Of the server's certificate.
  [[nodiscard]] const std::string& certified_name() const {
    return server_name.empty() ? host : server_name;
  }
  [[nodiscard]] std::string name() const {
    return (datagrams ? "udp " : tls ? "tls " : "") + host + ':' + std::to_string(port);
  }
  [[nodiscard]] std::optional<LineFormat> known_line() const { return line; }
  friend bool operator==(const TcpPortSpec&, const TcpPortSpec&) = default;
};

// A serial line at a server of RFC 2217, which sets the line as configured here.
struct Rfc2217PortSpec {
  std::string host;
  std::uint16_t port = 2217;
  LineFormat line;
  Duration connect_timeout = std::chrono::seconds{3};
  FenceSpec fence{};

  static constexpr bool kOverNetwork = true;
  [[nodiscard]] static bool has_datagrams() { return false; }
  [[nodiscard]] static bool has_tls() { return false; }
  [[nodiscard]] std::string name() const { return "rfc2217 " + host + ':' + std::to_string(port); }
  [[nodiscard]] std::optional<LineFormat> known_line() const { return line; }
  friend bool operator==(const Rfc2217PortSpec&, const Rfc2217PortSpec&) = default;
};

struct DialInPortSpec {
  std::string number;
  std::optional<LineFormat> line;  // of the serial line behind the module
  FenceSpec fence{};               // unused: a module has one connection

  static constexpr bool kOverNetwork = true;
  [[nodiscard]] static bool has_datagrams() { return false; }
  [[nodiscard]] static bool has_tls() { return false; }
  [[nodiscard]] std::string name() const { return "dial-in " + number; }
  [[nodiscard]] std::optional<LineFormat> known_line() const { return line; }
  friend bool operator==(const DialInPortSpec&, const DialInPortSpec&) = default;
};

using PortSpec = std::variant<SerialPortSpec, TcpPortSpec, Rfc2217PortSpec, DialInPortSpec>;

[[nodiscard]] std::string to_text(const LineFormat& line);  // "115200 8N1"

// "/dev/ttyUSB0", "10.0.0.7:502", "rfc2217 10.0.0.7:4001", "dial-in 17".
[[nodiscard]] std::string name_of(const PortSpec& port);
[[nodiscard]] std::string to_text(const PortSpec& port);

[[nodiscard]] bool over_network(const PortSpec& port);
[[nodiscard]] bool has_line(const PortSpec& port);
[[nodiscard]] bool has_datagrams(const PortSpec& port);
[[nodiscard]] bool has_tls(const PortSpec& port);

[[nodiscard]] const FenceSpec& fence_of(const PortSpec& port);

// The line for wire times: the port's own or, for plain TCP, a nominal fast one.
[[nodiscard]] LineFormat line_of(const PortSpec& port);

}  // namespace fieldcast
