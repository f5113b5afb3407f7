// Accepts engineers' clients: plain TCP on the loopback, or TLS. Runs on the server's io thread.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <string>
#include <tl/expected.hpp>
#include <unordered_set>

#include "bridge/log/log_lines.hpp"
#include "bridge/net/byte_stream.hpp"
#include "bridge/program/engineer_connection.hpp"
#include "bridge/program/module/relay_end.hpp"
#include "core/access/network.hpp"
#include "core/model/program_spec.hpp"

namespace fieldcast {
class TlsServer;
}

namespace fieldcast::program {

// Off the loopback a login is always required, on the loopback if the spec requires it.
// `port`: null for the port of `fieldcast-port`.
[[nodiscard]] EngineerRules rules_of(const EngineersSpec& spec,
                                     const EngineerPortSpec* port = nullptr);

class EngineerServer {
 public:
  // Limits for all clients, and for clients that have neither logged in nor were given a device, in
  // total and from one address. A further client displaces one of the latter, or is refused.
  static constexpr std::size_t kMaxClients = 256, kMaxSilent = 128, kMaxSilentOfOne = 32;

  // `port`: a port of one device, or null.
  EngineerServer(boost::asio::io_context& io, const EngineersSpec& spec,
                 const EngineerPortSpec* port, std::shared_ptr<DeviceRegistry> devices,
                 const Hooks& hooks);
  ~EngineerServer();

  // The error is one line: the reason why no client can connect.
  [[nodiscard]] tl::expected<void, std::string> listen();
  [[nodiscard]] std::uint16_t port() const;  // that it listens on
  // Ends the session of the device. False: no client of this port has it.
  bool end_session(const std::string& bus, const std::string& device, const std::string& reason);
  // Ends every pairing; calls `done` when the last client has disconnected, after 2 s at most.
  void close(const std::string& reason, std::function<void()> done);

 private:
  void came(boost::asio::ip::tcp::socket socket);
  void welcome(std::unique_ptr<ByteStream> stream, const std::string& address);
  void refuse(const std::string& address, const std::string& reason);
  void displaced(const std::string& address);
  void tick();

  const EngineersSpec spec_;
  const ListenSpec listen_;
  std::vector<access::Network> from_;  // empty: any address
  const Hooks& hooks_;
  EngineerConnection::Surroundings around_;
  const EngineerRules rules_;
  Listener listener_;
  boost::asio::steady_timer ticking_;
  std::unique_ptr<TlsServer> tls_;
  std::unordered_set<std::shared_ptr<EngineerConnection>> clients_;
  // those of clients_ and of TLS handshakes
  SilentConnections silent_{kMaxSilent, kMaxSilentOfOne};
  std::map<const EngineerConnection*, SilentConnections::Id> ids_;
  RepeatFilter displacements_;
  std::size_t greeting_ = 0;  // TLS handshakes in progress
  std::function<void()> closed_;
  bool closing_ = false;
};

}  // namespace fieldcast::program
