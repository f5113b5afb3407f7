#include "bridge/http/http_server.hpp"

#include <boost/asio/socket_base.hpp>
#include <utility>

#include "bridge/base/clock.hpp"
#include "core/access/network.hpp"

namespace fieldcast::web {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

// Limits the kernel's buffer for a slow client: data beyond it would be outdated on arrival.
constexpr int kSendBuffer = 256 * 1024;

}  // namespace

HttpServer::HttpServer(asio::io_context& io, HttpService& service, const ServerLimits& limits)
    : shared_{io,
              service,
              limits.http,
              [this](std::uint64_t id, bool logged_in) {
                return admit(session_table_.work(id, logged_in));
              },
              [this](std::uint64_t id) { session_table_.wait(id, steady_now()); },
              [this](std::uint64_t id) {
                session_table_.close(id);
                sessions_.erase(id);
              }},
      handshake_limit_(limits.handshake),
      handshake_table_(limits.handshakes),
      session_table_(limits.connections) {}

HttpServer::~HttpServer() { close(); }

void HttpServer::serve(std::unique_ptr<TlsServer> tls) {
  tls_ = std::move(tls);
  forget_handshakes();
}

// The closed TLS server does not report the end of its handshakes.
void HttpServer::forget_handshakes() {
  for (const auto& [id, end] : handshakes_) handshake_table_.close(id);
  handshakes_.clear();
}

void HttpServer::accept(tcp::socket socket) {
  boost::system::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  std::string peer = host_of(address_of(socket));
  if (tls_) return shake_hands(std::move(socket), std::move(peer));
  accept(socket_stream(std::move(socket)), std::move(peer));
}

void HttpServer::shake_hands(tcp::socket socket, std::string peer) {
  const std::uint64_t id = ++last_id_;
  const auto admission = handshake_table_.open(id, {access::address_group(peer)},
                                               ConnectionTable::Phase::kWaiting, steady_now());
  if (admission.evicted) {
    ++turned_away_;
    const auto end = std::move(handshakes_.at(*admission.evicted));
    handshakes_.erase(*admission.evicted);
    end();
  }
  auto end = tls_->shake_hands(std::move(socket), handshake_limit_,
                               [this, id, peer = std::move(peer)](TlsResult stream) {
                                 handshakes_.erase(id);
                                 handshake_table_.close(id);
                                 if (stream) return accept(*std::move(stream), peer);
                                 ++shared_.faults;
                               });
  handshakes_.emplace(id, std::move(end));
}

void HttpServer::accept(std::unique_ptr<ByteStream> stream, std::string peer) {
  ++accepted_;
  const std::uint64_t id = ++last_id_;
  if (closing_) {
    ++turned_away_;
    return stream->close();
  }
  if (!admit(session_table_.open(id, {access::address_group(peer)},
                                 ConnectionTable::Phase::kWaiting, steady_now())))
    return stream->close();
  const auto session =
      std::make_shared<HttpSession>(shared_, id, std::move(stream), std::move(peer));
  sessions_.emplace(id, session);
  session->start();
}

bool HttpServer::admit(const ConnectionTable::Admission& admission) {
  if (!admission.admitted || admission.evicted) ++turned_away_;
  if (admission.evicted) {
    const auto session = sessions_.at(*admission.evicted);
    session->close();
  }
  return admission.admitted;
}

void HttpServer::close() {
  closing_ = true;
  if (tls_) tls_->close();
  forget_handshakes();
  const auto sessions = std::exchange(sessions_, {});
  for (const auto& [id, session] : sessions) session->close();
}

ServerCounters HttpServer::counters() const {
  return {accepted_, shared_.requests, shared_.faults, turned_away_,
          sessions_.size() + handshakes_.size()};
}

}  // namespace fieldcast::web
