// Serves a simulated bus at the port that the bridge opens: a pseudo-terminal at its serial path,
// or a listener at its TCP port.
//
// Owns descriptors and BusLines; does not own the SimBus. Driven by the single thread of the plant
// loop.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "tools/sim/bus/sim_bus.hpp"
#include "tools/sim/pty_port.hpp"

namespace fieldcast::sim {

// Registers the descriptors of a bus; implemented by the loop.
class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void watch(int fd) = 0;
  virtual void forget(int fd) = 0;  // call before closing it
};

class ServedBus {
 public:
  virtual ~ServedBus() = default;
  // Opens the port; the error is human-readable.
  [[nodiscard]] virtual tl::expected<void, std::string> open(Instant now) = 0;
  // Address for a master: "/tmp/line-1 -> /dev/pts/5", "127.0.0.1:1502".
  [[nodiscard]] virtual std::string location() const = 0;
  virtual void on_readable(int fd, Instant now) = 0;
  // Does the due work and returns the next due time; kNever: only when a descriptor is readable.
  virtual Instant on_time(Instant now) = 0;
};

[[nodiscard]] std::unique_ptr<ServedBus> serve(SimBus& bus, Watcher& watcher);

}  // namespace fieldcast::sim
