// Opening of a port by a TCP connection: resolves the name, connects and shakes hands for TLS,
// within the configured time. On its bus's io thread.
#pragma once

#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/net/tls_engine.hpp"
#include "bridge/port/stream_port.hpp"

namespace fieldcast {

// Finds the addresses of a host name on a thread that is never joined: the C library waits up to
// half a minute for name servers and cannot be interrupted. The end of an io_context waits for the
// resolver of Asio, so a bus could not stop meanwhile. Addresses need no thread.
class NameLookup {
 public:
  // Not empty, or the reason: "host name 'plc-7': Name or service not known".
  using Found = tl::expected<std::vector<boost::asio::ip::address>, std::string>;
  static constexpr unsigned kMost = 256;  // threads of this process; a further lookup fails

  explicit NameLookup(boost::asio::io_context& io) : io_(io) {}
  ~NameLookup() { cancel(); }
  NameLookup(const NameLookup&) = delete;
  NameLookup& operator=(const NameLookup&) = delete;

  // Calls `done` once on the io thread, not inside this call and not after cancel().
  void start(const std::string& host, std::function<void(const Found&)> done);
  // REQUIRES: the io_context exists.
  void cancel();

 private:
  struct Pending;
  boost::asio::io_context& io_;
  std::shared_ptr<Pending> pending_;  // shared with the thread
};

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
  void connect(const std::vector<boost::asio::ip::address>& addresses);
  void start_tls();
  void shake_hands(ByteView received);
  void shaken(bool open);
  void finish();
  [[nodiscard]] std::string with_fence(std::string reason) const;

  const Target target_;
  NameLookup names_;
  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer limit_;
  std::unique_ptr<TlsEngine> tls_;  // during its handshake
  Bytes sending_;
  std::array<std::uint8_t, 4096> received_;
  bool connected_ = false;
};

}  // namespace fieldcast
