// The service manager (systemd): reports of the program, and its watchdog.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// $NOTIFY_SOCKET; empty without a service manager.
[[nodiscard]] std::string notify_address();

// Time without a report after which the service manager ends the process ($WATCHDOG_USEC, unless
// $WATCHDOG_PID is another process); `std::nullopt` without a watchdog.
[[nodiscard]] std::optional<Duration> watchdog_limit();

// Decides whether the watchdog may be fed: only if the thread of every bus turns. Pure.

// Last turn of a bus's thread, which turns at least once a second.
struct BusTurn {
  std::string bus;
  Instant at{};
};

struct StandingBus {
  std::string bus;
  Duration standing{};
};

// Returns the bus with the oldest turn before `limit`, or `std::nullopt` if all turn.
[[nodiscard]] std::optional<StandingBus> standing_bus(const std::vector<BusTurn>& turns,
                                                      Instant now, Duration limit);

// Reports the state of the program to the service manager (sd_notify(3)) and feeds the watchdog, if
// $NOTIFY_SOCKET is set. Never waits and never fails; datagrams may be lost. Main thread.
class Service {
 public:
  // A bus hangs if its thread has not turned for half of the watchdog's limit, but at least for
  // this time: a thread may be late on a busy machine.
  static constexpr Duration kLeastStanding = std::chrono::seconds{3};

  // `notify_address`: a path, or "@name" (abstract); empty: none. `watchdog`: see watchdog_limit().
  Service(std::string notify_address, std::optional<Duration> watchdog);

  // The configuration is loaded and every bus has its thread.
  void ready(std::string_view status);
  // Until the next ready(), the configuration is reloaded. `now` is of the monotonic clock.
  void reloading(Instant now);
  void stopping() { send("STOPPING=1\nSTATUS=stopping"); }
  // One line for `systemctl status`.
  void status(std::string_view text);

  // Returns how long the main thread may sleep, at most `longest`.
  [[nodiscard]] Duration sleep(Duration longest) const;
  [[nodiscard]] bool watched() const { return watchdog_.has_value(); }
  // Feeds the watchdog if every bus turns. Otherwise logs the hanging bus once, and its recovery.
  void look(const std::vector<BusTurn>& turns, Instant now);

 private:
  void send(const std::string& message);

  std::string address_;
  FileDescriptor socket_;
  std::optional<Duration> watchdog_;
  std::string standing_;  // the bus that was logged; empty: all turn
};

}  // namespace fieldcast
