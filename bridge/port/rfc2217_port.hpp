// A serial line at a server of RFC 2217. The server sets the line; the port opens when all settings
// are in force, and closes when the server reports another value. On its bus's io thread.
#pragma once

#include "bridge/port/stream_port.hpp"

namespace fieldcast {

class Rfc2217Port final : public StreamPort {
 public:
  Rfc2217Port(boost::asio::io_context& io, Rfc2217PortSpec spec)
      : io_(io), spec_(std::move(spec)) {}
  ~Rfc2217Port() override { close(); }

  void change_line(const telnet::LineChange& change, const telnet::LineChangeDone& done) override;

 private:
  std::shared_ptr<PortOpening> make_opening(PortListener& listener) override;

  boost::asio::io_context& io_;
  Rfc2217PortSpec spec_;
};

}  // namespace fieldcast
