// A serial device: UART, USB adapter or pseudo-terminal. Lives on its bus's io thread.
//
// Opens and closes on the io thread: this lasts microseconds, or some milliseconds with a USB
// adapter.
#pragma once

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

}  // namespace fieldcast
