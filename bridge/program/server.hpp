// The programming server of a bridge: connects engineers with dialled-in modules and devices of the
// buses. Owns its io thread. Its functions are for the main thread.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/program/leased_device.hpp"
#include "bridge/program/module/hooks.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast {
class BusRunner;
class DialInRegistry;
}  // namespace fieldcast

namespace fieldcast::program {

class Server {
 public:
  // The registry and the objects used by the hooks must outlive the server; the server must outlive
  // every added bus.
  Server(Hooks hooks, DialInRegistry& registry);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // Listens at the configured addresses, if any. The error is one line. REQUIRES: not started.
  // Modules that stop() kept stay connected, unless modules can no longer dial in.
  [[nodiscard]] tl::expected<void, std::string> start(const ProgramSpec& spec);
  // Disconnects clients, and also modules unless they are kept for the next start(). Lasts two
  // seconds at most. The server may be started again. With kKeep it continues to accept modules.
  enum class Modules : std::uint8_t { kLetGo, kKeep };
  void stop(Modules modules = Modules::kLetGo);

  [[nodiscard]] std::vector<LeasedDevice> leased() const;

  // Adds the devices of a bus for engineers. Remove a bus before its runner stops. May be called
  // before start().
  void add_bus(const BusSpec& bus, std::shared_ptr<BusRunner> runner);
  void remove_bus(const std::string& bus);

  // Ports that it listens on, for tests that let the system choose. 0: none.
  [[nodiscard]] std::uint16_t engineers_port() const;
  [[nodiscard]] std::uint16_t modules_port() const;

 private:
  void stop_engineers();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::program
