// A serial device: UART, USB adapter or pseudo-terminal. Lives on its bus's io thread.
//
// Opens and closes on the io thread: this lasts microseconds, or some milliseconds with a USB
// adapter.
#pragma once

#include <optional>
#include <string>

#include "bridge/port/stream_port.hpp"

namespace fieldcast {

class SerialPort final : public StreamPort {
 public:
  SerialPort(boost::asio::io_context& io, SerialPortSpec spec) : io_(io), spec_(std::move(spec)) {}
  ~SerialPort() override { close(); }

  void expect(std::uint32_t characters) override;

 private:
  std::shared_ptr<PortOpening> make_opening(PortListener& listener) override;

  boost::asio::io_context& io_;
  SerialPortSpec spec_;
};

// One master on a line: exclusive lock of a serial device, and its holder if the lock fails.

// Locks the open device with flock(LOCK_EX) and TIOCEXCL. Returns `std::nullopt` on success,
// otherwise one line with the holder if /proc shows it: "in use by mbpoll (process 1234)". The lock
// ends with the descriptor.
[[nodiscard]] std::optional<std::string> lock_port(int fd, const std::string& path);

// Returns a process that has the device open or locked: "mbpoll (process 1234)"; empty if none is
// visible (processes of other users are not).
[[nodiscard]] std::string port_user(const std::string& path);

}  // namespace fieldcast
