#include "bridge/program/engineer_desk.hpp"

#include <boost/asio/io_context.hpp>

#include "bridge/log.hpp"
#include "bridge/port/connection.hpp"
#include "bridge/program/tls.hpp"

namespace fieldcast::program {

namespace asio = boost::asio;
using asio::ip::tcp;

EngineerRules rules_of(const EngineersSpec& spec) {
  EngineerRules rules;
  rules.login_needed = !on_loopback(spec.listen);
  rules.heartbeat = spec.heartbeat;
  rules.idle = spec.idle;
  rules.handshake = spec.handshake;
  return rules;
}

EngineerDesk::EngineerDesk(asio::io_context& io, EngineersSpec spec, std::shared_ptr<DeviceBook> devices, const Hooks& hooks)
    : io_(io),
      spec_(std::move(spec)),
      hooks_(hooks),
      around_{io, std::move(devices), hooks,
              [this](const auto& over) {
                clients_.erase(over);
                if (clients_.empty() && closed_) std::exchange(closed_, {})();
              }},
      rules_(rules_of(spec_)),
      listener_(io, [this](tcp::socket socket) { came(std::move(socket)); }),
      ticking_(io) {}

EngineerDesk::~EngineerDesk() = default;

tl::expected<void, std::string> EngineerDesk::listen() {
  if (!spec_.certificate.empty()) {
    auto made = TlsServer::make(spec_.certificate, spec_.key);
    if (!made) return tl::make_unexpected(made.error());
    tls_ = std::move(*made);
  }
  auto listening = listener_.open(spec_.listen);
  if (!listening) return listening;
  tick();
  return {};
}

std::uint16_t EngineerDesk::port() const { return listener_.port(); }

void EngineerDesk::came(tcp::socket socket) {
  const std::string address = address_of(socket);
  if (clients_.size() + greeting_ >= kMaxClients) return refuse(address, "too many clients are connected");
  boost::system::error_code ignored;
  socket.non_blocking(true, ignored);
  tune_socket(socket.native_handle());
  if (!tls_) return welcome(socket_stream(std::move(socket)), address);
  ++greeting_;
  tls_->shake_hands(std::move(socket), rules_.handshake, [this, address](TlsResult stream) {
    --greeting_;
    if (!stream) return refuse(address, stream.error());
    if (!closing_) welcome(std::move(*stream), address);
  });
}

void EngineerDesk::welcome(std::unique_ptr<ByteStream> stream, const std::string& address) {
  const auto client = std::make_shared<EngineerConnection>(around_, std::move(stream), address, rules_);
  clients_.insert(client);
  client->start();
}

void EngineerDesk::refuse(const std::string& address, const std::string& reason) {
  log_warning("program", address + ": " + reason);
  if (hooks_.audit) hooks_.audit({address, "", 0, 0, "refused: " + reason});
}

void EngineerDesk::tick() {
  for (const auto& client : clients_) client->tick();
  ticking_.expires_after(std::chrono::seconds{1});
  ticking_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled && !closing_) tick();
  });
}

void EngineerDesk::close(const std::string& reason, std::function<void()> done) {
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
