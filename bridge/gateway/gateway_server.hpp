// Serves the Modbus TCP clients of one bus, within the limits of GatewaySpec. Owns an io thread, so
// that clients cannot delay the bus. If the server cannot listen, it logs that once and retries;
// the bus runs.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "core/gateway/client_session.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/command.hpp"

namespace fieldcast {

class GatewayServer {
 public:
  static constexpr Duration kTryAgain = std::chrono::milliseconds{250};
  // A client that does not read its responses is not read either.
  static constexpr std::size_t kMaxUnsent = 16 * 1024;

  // Called on the server's thread; must not block.
  struct Uses {
    // Passes the command to the bus; its result arrives at complete(). Returns the result if the
    // bus does not get it.
    std::function<std::optional<CommandResult>(const Command&)> submit;
    std::function<void(const gateway::Counters&)> report;  // once a second
  };
  // REQUIRES: bus.gateway holds a value.
  GatewayServer(const BusSpec& bus, Uses uses);
  ~GatewayServer();  // closes every connection; no function of `uses` is called afterwards
  GatewayServer(const GatewayServer&) = delete;
  GatewayServer& operator=(const GatewayServer&) = delete;

  // Listens from now on. Call once, when results reach complete().
  void start();
  void complete(const CommandResult& result);  // any thread
  // Returns the port, or 0 if it does not listen yet. Any thread.
  [[nodiscard]] std::uint16_t port() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fieldcast
