// Opening of a port by a TCP connection: resolves the name and connects, within the configured
// time. On its bus's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <string>

#include "bridge/port/stream_port.hpp"

namespace fieldcast {

class TcpOpening : public PortOpening {
 public:
  struct Target {
    std::string host;
    std::uint16_t port = 0;
    Duration timeout{};
    bool one_client = false;  // `fence: one-client`
  };
  TcpOpening(boost::asio::io_context& io, PortListener& listener, Target target);

  void begin() override;

 protected:
  // Ends in opened() or fail(), inside this call or later.
  virtual void connected(FileDescriptor socket) = 0;
  void cancel() override;
  void give_up(std::string reason) { fail(std::move(reason), Cause::kPortUnreachable); }
  [[nodiscard]] const Target& target() const { return target_; }

 private:
  void connect(const boost::asio::ip::tcp::resolver::results_type& endpoints);
  [[nodiscard]] std::string with_fence(std::string reason) const;

  const Target target_;
  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer limit_;
  bool connected_ = false;
};

}  // namespace fieldcast
