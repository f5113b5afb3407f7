// Opening of a port by a TCP connection: resolves the name, connects and shakes hands for TLS,
// within the configured time. On its bus's io thread.
#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <optional>
#include <string>

#include "bridge/net/tls_engine.hpp"
#include "bridge/port/stream_port.hpp"

namespace fieldcast {

class TcpOpening : public PortOpening {
 public:
  struct Target {
    std::string host;
    std::uint16_t port = 0;
    Duration timeout{};
    bool one_client = false;  // `fence: one-client`
    std::optional<TlsSpec> tls{};
    std::string certified_name{};  // of the server, with TLS
  };
  TcpOpening(boost::asio::io_context& io, PortListener& listener, Target target);

  void begin() override;

 protected:
  // Ends in opened() or fail(), inside this call or later. `tls` is null without TLS.
  virtual void connected(FileDescriptor socket, std::unique_ptr<TlsEngine> tls) = 0;
  void cancel() override;
  void give_up(std::string reason) { fail(std::move(reason), Cause::kPortUnreachable); }
  [[nodiscard]] const Target& target() const { return target_; }

 private:
  void connect(const boost::asio::ip::tcp::resolver::results_type& endpoints);
  void start_tls();
  void shake_hands(ByteView received);
  void shaken(bool open);
  void finish();
  [[nodiscard]] std::string with_fence(std::string reason) const;

  const Target target_;
  boost::asio::ip::tcp::resolver resolver_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer limit_;
  std::unique_ptr<TlsEngine> tls_;  // during its handshake
  Bytes sending_;
  std::array<std::uint8_t, 4096> received_;
  bool connected_ = false;
};

}  // namespace fieldcast
