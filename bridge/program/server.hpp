// A device that is leased to an engineer, for display. Plain values.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/program/module/hooks.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast::program {

struct LeasedDevice {
  std::string number;
  std::string bus, device;  // names; a module without a bus: "dial-in" and its number
  std::string who;          // the user and the address, or the address alone
};

}  // namespace fieldcast::program

// The programming server of a bridge: connects engineers with dialled-in modules and devices of the
// buses. Owns its io thread. Its functions are for the main thread.

namespace fieldcast {
class BusRunner;
class DialInRegistry;
}  // namespace fieldcast

namespace fieldcast::program {

class Server {
 public:
  // The registry and the objects of the hooks outlive the server; it outlives every added bus.
  Server(Hooks hooks, DialInRegistry& registry);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // Listens at the configured addresses, if any. The error is one line. REQUIRES: not started.
  // Modules that stop() kept stay connected, unless modules can no longer dial in.
  [[nodiscard]] tl::expected<void, std::string> start(const ProgramSpec& spec);
  // Disconnects clients, and modules unless kept for the next start(). Lasts two seconds at most.
  // With kKeep it continues to accept modules.
  enum class Modules : std::uint8_t { kLetGo, kKeep };
  void stop(Modules modules = Modules::kLetGo);

  [[nodiscard]] std::vector<LeasedDevice> leased() const;
  // Takes the device back; the engineer and the audit get the reason. False: nobody has it.
  // Any thread but that of the hooks.
  bool end_session(const std::string& bus, const std::string& device, const std::string& reason);

  // Adds the devices of a bus, also before start(). Remove it before its runner stops.
  void add_bus(const BusSpec& bus, std::shared_ptr<BusRunner> runner);
  void remove_bus(const std::string& bus);

  // Ports that it listens on, for tests that let the system choose. 0: none.
  [[nodiscard]] std::uint16_t engineers_port() const;
  [[nodiscard]] std::uint16_t engineers_port(std::size_t at) const;  // 1: the first single device
  [[nodiscard]] std::uint16_t modules_port() const;

 private:
  void stop_engineers();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::program

namespace fieldcast::program {

// Describes who may use the programming port, for the start and --check. Values; any thread.

// "modules dial in at 0.0.0.0:4951: TLS with a certificate of plant.pem, from 10.0.0.0/8; a second
// one of a number is refused"
[[nodiscard]] std::string to_text(const ModulesSpec& modules);
// "engineers connect at 0.0.0.0:4950: TLS, a login with the password of a user"
[[nodiscard]] std::string to_text(const EngineersSpec& engineers);
// "device P1 is programmed at 127.0.0.1:4961 by RFC 2217: no TLS, no login"
[[nodiscard]] std::string to_text(const EngineersSpec& engineers, const EngineerPortSpec& port);

// The first configured file that cannot be used.
struct AccessFault {
  std::string key;  // of `program:` in the configuration: "modules.secrets"
  std::string text;
};
[[nodiscard]] std::optional<AccessFault> check_files(const ProgramSpec& program);

}  // namespace fieldcast::program
