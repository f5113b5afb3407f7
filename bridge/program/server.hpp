// The programming server of a bridge: engineers on one side, modules that dial in and the devices
// of the buses on the other. Owns its io thread. Its functions are for the main thread.
#pragma once

#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/program/hooks.hpp"
#include "bridge/program/leased_device.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {
class BusRunner;
class DialInRegistry;
}  // namespace fieldcast

namespace fieldcast::program {

class Server {
 public:
  // The registry and what the hooks use outlive the server; the server outlives every bus that was
  // added.
  Server(Hooks hooks, DialInRegistry& registry);
  ~Server();  // stop()
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // Listens where the spec says, nowhere if it says nothing. The error is one line. REQUIRES: not
  // started. Modules that stop() kept stay connected, unless nothing dials in any more.
  [[nodiscard]] tl::expected<void, std::string> start(const ProgramSpec& spec);
  // Ends the connections of clients, and of modules unless these are kept for a start that follows.
  // Takes two seconds at most. It may be started again. With kKeep it listens to modules meanwhile,
  // and others may dial in.
  enum class Modules : std::uint8_t { kLetGo, kKeep };
  void stop(Modules modules = Modules::kLetGo);

  // The devices that are leased to engineers now.
  [[nodiscard]] std::vector<LeasedDevice> leased() const;

  // Devices of a bus that engineers may ask for. A bus is removed before its runner stops. May be
  // called before start().
  void add_bus(const BusSpec& bus, std::shared_ptr<BusRunner> runner);
  void remove_bus(const std::string& bus);

  // Where it listens: for tests that let the system choose. 0: nowhere.
  [[nodiscard]] std::uint16_t engineers_port() const;
  [[nodiscard]] std::uint16_t modules_port() const;

 private:
  void stop_engineers();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast::program
