// Where engineers' clients connect: plain TCP on the loopback, TLS wherever a certificate is
// configured. Lives on the server's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <unordered_set>

#include "bridge/log/repeat_filter.hpp"
#include "bridge/net/listener.hpp"
#include "bridge/program/engineer_connection.hpp"
#include "bridge/program/silent_connections.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {
class TlsServer;
}

namespace fieldcast::program {

// Off the loopback a login is demanded, on it when the spec says so.
[[nodiscard]] EngineerRules rules_of(const EngineersSpec& spec);

class EngineerServer {
 public:
  // Clients in all; and clients that neither logged in nor were given a device, in all and from one
  // address. One more displaces one of these, or is refused.
  static constexpr std::size_t kMaxClients = 256, kMaxSilent = 128, kMaxSilentOfOne = 32;

  EngineerServer(boost::asio::io_context& io, EngineersSpec spec,
                 std::shared_ptr<DeviceRegistry> devices, const Hooks& hooks);
  ~EngineerServer();

  // The error is one line: why nobody can connect.
  [[nodiscard]] tl::expected<void, std::string> listen();
  [[nodiscard]] std::uint16_t port() const;  // listened at
  // Ends every pairing; `done` is called when the last client is gone, which takes two seconds at
  // the most.
  void close(const std::string& reason, std::function<void()> done);

 private:
  void came(boost::asio::ip::tcp::socket socket);
  void welcome(std::unique_ptr<ByteStream> stream, const std::string& address);
  void refuse(const std::string& address, const std::string& reason);
  void displaced(const std::string& address);
  void tick();

  boost::asio::io_context& io_;
  const EngineersSpec spec_;
  const Hooks& hooks_;
  EngineerConnection::Surroundings around_;
  const EngineerRules rules_;
  Listener listener_;
  boost::asio::steady_timer ticking_;
  std::unique_ptr<TlsServer> tls_;
  std::unordered_set<std::shared_ptr<EngineerConnection>> clients_;
  SilentConnections silent_{kMaxSilent, kMaxSilentOfOne};  // of clients_, and of TLS handshakes
  std::map<const EngineerConnection*, SilentConnections::Id> ids_;
  RepeatFilter displacements_;
  std::size_t greeting_ = 0;  // TLS handshakes under way
  std::function<void()> closed_;
  bool closing_ = false;
};

}  // namespace fieldcast::program
