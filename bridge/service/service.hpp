// The bridge as a service: what its service manager is told, and when the watchdog is fed. Does
// nothing where there is none. Main thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/service/notify_socket.hpp"
#include "bridge/service/standing_bus.hpp"

namespace fieldcast {

class Service {
 public:
  // A bus stands when its thread has not turned for half of the watchdog's limit, but not before
  // this: on a busy machine a thread may be late.
  static constexpr Duration kLeastStanding = std::chrono::seconds{3};

  // `watchdog`: after how long without food the manager ends the process; none: it does not watch.
  Service(std::string notify_address, std::optional<Duration> watchdog)
      : socket_(std::move(notify_address)), watchdog_(watchdog) {}

  void ready(const std::string& status) { socket_.ready(status); }
  void status(const std::string& text) { socket_.status(text); }
  void reloading(Instant now) { socket_.reloading(now); }
  void stopping() { socket_.stopping(); }

  // How long the main thread may sleep, if it likes to sleep for `longest`.
  [[nodiscard]] Duration sleep(Duration longest) const;
  [[nodiscard]] bool watched() const { return watchdog_.has_value(); }
  // Feeds the watchdog, or logs which bus stands: once, and once more when all turn again.
  void look(const std::vector<BusTurn>& turns, Instant now);

 private:
  NotifySocket socket_;
  std::optional<Duration> watchdog_;
  std::string standing_;  // the bus that was logged; empty: all turn
};

}  // namespace fieldcast
