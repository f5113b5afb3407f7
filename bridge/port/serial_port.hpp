// A serial device: real UART, USB adapter or pseudo-terminal. Lives on its bus's io thread.
//
// Opening and closing are done at once on the io thread: a driver takes microseconds for it, a USB
// adapter some milliseconds.
#pragma once

#include "bridge/port/port.hpp"

namespace fieldcast {

class SerialPort final : public Port {
 public:
  SerialPort(boost::asio::io_context& io, SerialPortSpec spec);
  ~SerialPort() override;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  void open(PortListener& listener) override;
  void write(ByteView bytes) override;
  void expect(std::uint32_t characters) override;
  void poll() override;
  void close() override;
  FileDescriptor lend() override;
  void take_back() override;

 private:
  class Session;
  boost::asio::io_context& io_;
  SerialPortSpec spec_;
  std::shared_ptr<Session> session_;  // shared with the handlers under way
};

}  // namespace fieldcast
