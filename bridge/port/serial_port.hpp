// A serial device: UART, USB adapter or pseudo-terminal. Opens and closes on its bus's io thread,
// in microseconds, or some milliseconds with a USB adapter.
#pragma once

#include <optional>
#include <string>

#include "bridge/port/stream_port.hpp"

namespace fieldcast {

class SerialPort final : public StreamPort {
 public:
  SerialPort(boost::asio::io_context& io, SerialPortSpec spec) : io_(io), spec_(std::move(spec)) {}
  ~SerialPort() override { close(); }

  void receive_at(std::uint32_t baud, std::size_t characters) override;
  void sleep_until(Instant until) override;

 private:
  std::shared_ptr<PortOpening> make_opening(PortListener& listener) override;

  boost::asio::io_context& io_;
  SerialPortSpec spec_;
};

// Locks the open device with flock(LOCK_EX) and TIOCEXCL until it is closed. Returns empty, or one
// line with the holder if known: "in use by mbpoll (process 1234)".
[[nodiscard]] std::optional<std::string> lock_port(int fd, const std::string& path);

// A visible process that has the device open or locked: "mbpoll (process 1234)"; or empty.
[[nodiscard]] std::string port_user(const std::string& path);

}  // namespace fieldcast
