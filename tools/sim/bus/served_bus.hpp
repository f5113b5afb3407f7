// A simulated bus where the bridge finds it: the pseudo-terminal at its serial path, or the TCP
// port of its address.
//
// Owns descriptors and conversations; borrows the SimBus. Driven by the plant loop on its one
// thread: descriptors that became readable, and instants that have come.
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

// Where a bus tells which descriptors it waits for; the loop implements it.
class Watcher {
 public:
  virtual ~Watcher() = default;
  virtual void watch(int fd) = 0;
  virtual void forget(int fd) = 0;  // before it is closed
};

class ServedBus {
 public:
  virtual ~ServedBus() = default;
  // Opens the port; or why not, for people.
  [[nodiscard]] virtual tl::expected<void, std::string> open(Instant now) = 0;
  // Where a master finds it: "/tmp/line-1 -> /dev/pts/5", "127.0.0.1:1502".
  [[nodiscard]] virtual std::string location() const = 0;
  virtual void on_readable(int fd, Instant now) = 0;
  // Does what is due and says when it wants to be called next; kNever: not before something is
  // readable.
  virtual Instant on_time(Instant now) = 0;
};

[[nodiscard]] std::unique_ptr<ServedBus> serve(SimBus& bus, Watcher& watcher);

}  // namespace fieldcast::sim
