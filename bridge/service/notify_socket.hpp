// Reports the state of the program to the service manager with the datagrams of sd_notify(3). Does
// nothing without a service manager ($NOTIFY_SOCKET is not set). Never waits and never fails; a
// datagram that the manager does not receive is lost. Main thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class NotifySocket {
 public:
  // `address`: a path, or "@name" of an abstract socket; empty: no reports.
  explicit NotifySocket(std::string address);

  // The configuration is loaded and every bus has its thread.
  void ready(std::string_view status);
  // Until the next ready(), the configuration is reloaded. `now` is of the monotonic clock.
  void reloading(Instant now);
  void stopping();
  // Feeds the watchdog.
  void alive();
  // One line for `systemctl status`.
  void status(std::string_view text);

 private:
  void send(const std::string& message);

  std::string address_;
  FileDescriptor socket_;
};

// $NOTIFY_SOCKET; empty without a service manager.
[[nodiscard]] std::string notify_address();

// Time without alive() after which the service manager ends the process ($WATCHDOG_USEC, unless
// $WATCHDOG_PID is another process); `std::nullopt` without a watchdog.
[[nodiscard]] std::optional<Duration> watchdog_limit();

}  // namespace fieldcast
