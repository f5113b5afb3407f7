// The bridge as a service: reports to the service manager and feeds the watchdog. Does nothing
// without a service manager. Main thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/service/notify_socket.hpp"
#include "bridge/service/standing_bus.hpp"

namespace fieldcast {

class Service {
 public:
  // A bus hangs if its thread has not turned for half of the watchdog's limit, but at least for
  // this time: a thread may be late on a busy machine.
  static constexpr Duration kLeastStanding = std::chrono::seconds{3};

  // `watchdog`: time without a report after which the manager ends the process.
  Service(std::string notify_address, std::optional<Duration> watchdog)
      : socket_(std::move(notify_address)), watchdog_(watchdog) {}

  void ready(const std::string& status) { socket_.ready(status); }
  void status(const std::string& text) { socket_.status(text); }
  void reloading(Instant now) { socket_.reloading(now); }
  void stopping() { socket_.stopping(); }

  // Returns how long the main thread may sleep, at most `longest`.
  [[nodiscard]] Duration sleep(Duration longest) const;
  [[nodiscard]] bool watched() const { return watchdog_.has_value(); }
  // Feeds the watchdog if every bus turns. Otherwise logs the hanging bus once, and its recovery.
  void look(const std::vector<BusTurn>& turns, Instant now);

 private:
  NotifySocket socket_;
  std::optional<Duration> watchdog_;
  std::string standing_;  // the bus that was logged; empty: all turn
};

}  // namespace fieldcast
