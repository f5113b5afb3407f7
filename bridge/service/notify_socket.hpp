// Tells the service manager how the program is: the datagrams of sd_notify(3). Without a service
// manager ($NOTIFY_SOCKET is not set) it says nothing. Never waits and never fails: a datagram that
// the manager does not take is lost. Main thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

class NotifySocket {
 public:
  // `address`: a path, or "@name" of an abstract socket; empty: nobody is told.
  explicit NotifySocket(std::string address);

  // The configuration is loaded and every bus has its thread.
  void ready(std::string_view status);
  // Between this and the next ready() the configuration is taken up anew; `now` is of the
  // monotonic clock.
  void reloading(Instant now);
  void stopping();
  // The watchdog is fed.
  void alive();
  // One line for `systemctl status`.
  void status(std::string_view text);

 private:
  void send(const std::string& message);

  std::string address_;
  FileDescriptor socket_;
};

// $NOTIFY_SOCKET; empty where no service manager listens.
[[nodiscard]] std::string notify_address();

// How long the service manager waits for alive() before it ends the process ($WATCHDOG_USEC, unless
// $WATCHDOG_PID names another process); none: it does not watch.
[[nodiscard]] std::optional<Duration> watchdog_limit();

}  // namespace fieldcast
