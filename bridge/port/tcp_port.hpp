// A TCP client: for a Modbus TCP device, or a serial server that forwards the bytes of a line.
// Lives on its bus's io thread.
#pragma once

#include "bridge/port/stream_port.hpp"

namespace fieldcast {

class TcpPort final : public StreamPort {
 public:
  TcpPort(boost::asio::io_context& io, TcpPortSpec spec) : io_(io), spec_(std::move(spec)) {}
  ~TcpPort() override { close(); }

 private:
  std::shared_ptr<PortOpening> make_opening(PortListener& listener) override;

  boost::asio::io_context& io_;
  TcpPortSpec spec_;
};

}  // namespace fieldcast
