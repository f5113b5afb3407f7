// How engineers and modules reach the bridge for programming, and where it listens. Plain values.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/tls_spec.hpp"
#include "core/program/registration.hpp"

namespace fieldcast {

struct ListenSpec {
  std::string host;  // an IP address
  std::uint16_t port = 0;
  friend bool operator==(const ListenSpec&, const ListenSpec&) = default;
};
[[nodiscard]] bool on_loopback(const ListenSpec& listen);

enum class LoginRule : std::uint8_t { kOffLoopback, kAlways };  // when a login is required

enum class LoginProof : std::uint8_t { kPassword, kCertificate, kEither, kBoth };

// A port of one device for programming software without `fieldcast-port`. TLS, login and `idle` are
// those of the engineers.
struct EngineerPortSpec {
  std::string device;  // its number
  ListenSpec listen;
  bool raw = false;               // raw bytes; false: RFC 2217
  std::string user;               // the only one that may log in; empty: any programmer
  std::vector<std::string> from;  // addresses and networks, "10.0.0.0/8"; empty: any
  bool without_security = false;  // explicitly configured
  friend bool operator==(const EngineerPortSpec&, const EngineerPortSpec&) = default;
};

struct EngineersSpec {
  ListenSpec listen;
  TlsSpec tls;
  LoginRule login = LoginRule::kOffLoopback;
  LoginProof proof = LoginProof::kPassword;
  Duration heartbeat = std::chrono::seconds{5};
  Duration idle = std::chrono::minutes{10};
  // Timeout of TLS and of the request for a device; not a key of the configuration.
  Duration handshake = std::chrono::seconds{10};
  std::vector<EngineerPortSpec> ports{};
  friend bool operator==(const EngineersSpec&, const EngineersSpec&) = default;
};

// Action if a second module connects with the same number.
enum class SecondModule : std::uint8_t { kRefuse, kReplace };

struct ModulesSpec {
  ListenSpec listen;
  program::RegistrationRule registration;
  TlsSpec tls;
  // By common name: device numbers of that certificate. Others may only use their common name.
  std::map<std::string, std::vector<std::string>> subjects;
  std::string secrets;            // path of the modules' secrets; empty: none
  std::vector<std::string> from;  // addresses and networks, "10.0.0.0/8"; empty: any
  SecondModule second = SecondModule::kRefuse;
  bool without_security = false;  // explicitly configured
  friend bool operator==(const ModulesSpec&, const ModulesSpec&) = default;
};

struct ProgramSpec {
  std::optional<EngineersSpec> engineers;
  std::optional<ModulesSpec> modules;
  friend bool operator==(const ProgramSpec&, const ProgramSpec&) = default;
};

}  // namespace fieldcast
