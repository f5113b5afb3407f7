#include "bridge/program/engineer_server.hpp"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/net/tls.hpp"
#include "bridge/port/stream.hpp"

namespace fieldcast::program {

namespace asio = boost::asio;
using asio::ip::tcp;

EngineerRules rules_of(const EngineersSpec& spec, const EngineerPortSpec* port) {
  EngineerRules rules;
  const bool listed = port != nullptr && !port->from.empty();
  const bool far = !on_loopback(port != nullptr ? port->listen : spec.listen);
  rules.login_needed = spec.login == LoginRule::kAlways || (far && !listed) ||
                       spec.proof == LoginProof::kCertificate || spec.proof == LoginProof::kBoth;
  rules.heartbeat = spec.heartbeat;
  rules.idle = spec.idle;
  rules.handshake = spec.handshake;
  if (port != nullptr) rules.port = LinePort{port->device, !port->raw, port->user};
  return rules;
}

EngineerServer::EngineerServer(asio::io_context& io, const EngineersSpec& spec,
                               const EngineerPortSpec* port,
                               std::shared_ptr<DeviceRegistry> devices, const Hooks& hooks)
    : spec_(spec),
      listen_(port != nullptr ? port->listen : spec.listen),
      hooks_(hooks),
      around_{io, std::move(devices), hooks,
              [this](const auto& over) {
                silent_.remove(ids_[over.get()]);
                ids_.erase(over.get());
                clients_.erase(over);
                if (clients_.empty() && closed_) std::exchange(closed_, {})();
              },
              [this](const auto& proven) { silent_.remove(ids_[proven.get()]); }},
      rules_(rules_of(spec_, port)),
      listener_(io, [this](tcp::socket socket) { came(std::move(socket)); }),
      ticking_(io) {
  if (port == nullptr) return;
  for (const std::string& text : port->from) from_.push_back(*access::Network::parse(text));
}

EngineerServer::~EngineerServer() = default;

tl::expected<void, std::string> EngineerServer::listen() {
  if (!spec_.tls.certificate.empty()) {
    auto made =
        TlsServer::make(spec_.tls, spec_.proof == LoginProof::kEither ? TlsServer::Clients::kMay
                                                                      : TlsServer::Clients::kMust);
    if (!made) return tl::make_unexpected(made.error());
    tls_ = std::move(*made);
  }
  auto listening = listener_.open(listen_);
  if (!listening) return listening;
  tick();
  return {};
}

std::uint16_t EngineerServer::port() const { return listener_.port(); }

void EngineerServer::came(tcp::socket socket) {
  const std::string address = address_of(socket);
  const auto holds = [&](const access::Network& from) { return from.contains(host_of(address)); };
  if (!from_.empty() && std::ranges::none_of(from_, holds))
    return refuse(address, "engineers do not connect from this address");
  if (clients_.size() + greeting_ >= kMaxClients && !silent_.cut_one())
    return refuse(address, "too many clients are connected");
  boost::system::error_code ignored;
  socket.non_blocking(true, ignored);
  tune_socket(socket.native_handle(), kTunnelPatience);
  if (!tls_) return welcome(socket_stream(std::move(socket)), address);
  ++greeting_;
  const auto id = std::make_shared<SilentConnections::Id>();
  const auto cut =
      tls_->shake_hands(std::move(socket), rules_.handshake, [this, address, id](TlsResult stream) {
        --greeting_;
        if (!silent_.remove(*id)) return;  // it was displaced
        if (!stream) return refuse(address, stream.error());
        if (!closing_) welcome(std::move(*stream), address);
      });
  *id = silent_.add(host_of(address), [this, cut, address] {
    cut();
    displaced(address);
  });
}

void EngineerServer::welcome(std::unique_ptr<ByteStream> stream, const std::string& address) {
  const auto client = std::make_shared<EngineerConnection>(around_, std::move(stream), address,
                                                           rules_, spec_.proof);
  clients_.insert(client);
  ids_[client.get()] = silent_.add(host_of(address), [this, weak = std::weak_ptr(client), address] {
    if (const auto silent = weak.lock()) silent->displace();
    displaced(address);
  });
  client->start();
}

// Logs the first displacement and counts the others: no flood of log and audit.
void EngineerServer::displaced(const std::string& address) {
  const auto verdict = displacements_.occurred("silent", steady_now());
  if (!verdict.log) return;
  const std::string more =
      verdict.suppressed == 0 ? "" : fmt::format(" ({} more before)", verdict.suppressed);
  refuse(address, "too many silent connections; the oldest is disconnected" + more);
}

void EngineerServer::refuse(const std::string& address, const std::string& reason) {
  log_counted(LogLevel::kWarning, "program", "connections refused",
              fmt::format("{}: {}", address, reason));
  if (hooks_.audit) hooks_.audit({address, "", 0, 0, "refused: " + reason});
}

void EngineerServer::tick() {
  for (const auto& client : clients_) client->tick();
  ticking_.expires_after(std::chrono::seconds{1});
  ticking_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled && !closing_) tick();
  });
}

bool EngineerServer::end_session(const std::string& bus, const std::string& device,
                                 const std::string& reason) {
  const auto found = std::ranges::find_if(
      clients_, [&](const auto& client) { return client->programs(bus, device); });
  if (found == clients_.end()) return false;
  const auto client = *found;  // end() may remove it from the set
  client->end(reason);
  return true;
}

void EngineerServer::close(const std::string& reason, std::function<void()> done) {
  closing_ = true;
  listener_.close();
  ticking_.cancel();
  if (tls_) tls_->close();
  if (clients_.empty()) return done();
  closed_ = std::move(done);
  const auto clients = clients_;
  for (const auto& client : clients) client->end(reason);
}

}  // namespace fieldcast::program
