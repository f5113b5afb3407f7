// Serves a simulated bus at the pseudo-terminal or TCP port that the bridge opens. Owns descriptors
// and BusLines, not the SimBus. Driven by the thread of the plant loop.
#pragma once

#include <memory>
#include <string>

#include "bridge/base/file_descriptor.hpp"
#include "tools/sim/bus/sim_bus.hpp"
#include "tools/sim/port/pty_port.hpp"

namespace fieldcast::sim {

class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void watch(int fd) = 0;
  virtual void forget(int fd) = 0;  // call before closing it
};

class ServedBus {
 public:
  virtual ~ServedBus() = default;
  [[nodiscard]] virtual tl::expected<void, std::string> open(Instant now) = 0;
  // Address for a master: "/tmp/line-1 -> /dev/pts/5", "127.0.0.1:1502".
  [[nodiscard]] virtual std::string location() const = 0;
  virtual void on_readable(int fd, Instant now) = 0;
  virtual Instant on_time(Instant now) = 0;
};

[[nodiscard]] std::unique_ptr<ServedBus> serve(SimBus& bus, Watcher& watcher);

}  // namespace fieldcast::sim
