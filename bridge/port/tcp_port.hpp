// A TCP client: a Modbus TCP device, or a serial server that carries the bytes of a line. Lives on
// its bus's io thread.
#pragma once

#include "bridge/port/port.hpp"

namespace fieldcast {

class Connection;

class TcpPort final : public Port {
 public:
  TcpPort(boost::asio::io_context& io, TcpPortSpec spec);
  ~TcpPort() override;
  TcpPort(const TcpPort&) = delete;
  TcpPort& operator=(const TcpPort&) = delete;

  void open(PortListener& listener) override;
  void write(ByteView bytes) override;
  void expect(std::uint32_t) override {
  }  // the network delivers answers in one piece, or at its own rhythm
  void poll() override;
  void close() override;
  FileDescriptor lend() override;
  void take_back() override;

 private:
  class Session;
  [[nodiscard]] Connection* connected();
  boost::asio::io_context& io_;
  TcpPortSpec spec_;
  std::shared_ptr<Session> session_;  // shared with the handlers under way
};

}  // namespace fieldcast
