#include "tools/station/web/http_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast::web {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kHousekeeping{30};
// Limits the kernel's buffer for a slow client: data beyond it would be outdated on arrival.
constexpr int kSendBuffer = 256 * 1024;

}  // namespace

HttpServer::HttpServer(asio::io_context& io, Site& site, MakeLiveProtocol make,
                       const ServerLimits& limits)
    : io_(io),
      site_(site),
      make_(std::move(make)),
      limits_(limits),
      shared_{io,
              site,
              limits.http,
              [this](const Site::Upgrade& who) { return refuse_live(who); },
              [this](LiveRequest request) { open_live(std::move(request)); },
              [this](std::uint64_t id, bool logged_in) {
                return admit(session_table_.work(id, logged_in));
              },
              [this](std::uint64_t id) { session_table_.wait(id, steady_now()); },
              [this](std::uint64_t id) {
                session_table_.close(id);
                sessions_.erase(id);
                look_for_end();
              }},
      handshake_table_(limits.handshakes),
      session_table_(limits.connections),
      live_table_(limits.live),
      house_(io),
      farewell_(io) {
  site_.on_ended([this](std::uint64_t id) { end_logins(id); });
  keep_house();
}

HttpServer::~HttpServer() {
  site_.on_ended({});
  closing_ = true;
  if (tls_) tls_->close();
  const auto sessions = std::exchange(sessions_, {});
  for (const auto& [key, session] : sessions) session->close();
  for (const auto& [socket, kept] : live_) socket->drop();
}

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
  error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  std::string peer = host_of(address_of(socket));
  if (tls_) return shake_hands(std::move(socket), std::move(peer));
  accept(socket_stream(std::move(socket)), std::move(peer));
}

void HttpServer::shake_hands(tcp::socket socket, std::string peer) {
  const std::uint64_t id = ++last_id_;
  const auto admission = handshake_table_.open(id, {address_group(peer)},
                                               ConnectionTable::Phase::kWaiting, steady_now());
  if (admission.evicted) {
    ++turned_away_;
    const auto end = std::move(handshakes_.at(*admission.evicted));
    handshakes_.erase(*admission.evicted);
    end();
  }
  auto end = tls_->shake_hands(std::move(socket), limits_.handshake,
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
  if (!admit(session_table_.open(id, {address_group(peer)}, ConnectionTable::Phase::kWaiting,
                                 steady_now())))
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

std::optional<HttpResponse> HttpServer::refuse_live(const Site::Upgrade& who) {
  if (!make_) return site_.refusal(404, "no WebSocket here", "this station has no live values");
  const auto of_one = std::ranges::count_if(live_, [&](const auto& each) {
    const Site::Upgrade& other = each.first->who();
    return other.login != 0 && other.caller.user == who.caller.user;
  });
  const bool too_many_of_one =
      who.login != 0 && static_cast<std::size_t>(of_one) >= limits_.live_of_one;
  const bool has_room = live_table_
                            .admission({address_group(who.caller.peer), who.login != 0},
                                       ConnectionTable::Phase::kWorking)
                            .admitted;
  if (has_room && !too_many_of_one) return std::nullopt;
  ++turned_away_;
  log_counted(LogLevel::kWarning, "web", "WebSockets beyond the limit",
              fmt::format("{} at {}: {} are open", who.caller.user, who.caller.peer, live_.size()));
  return site_.refusal(503, "too many open pages",
                       too_many_of_one ? "close other pages of yours" : "try again later");
}

// REQUIRES: refuse_live() has just admitted the request.
void HttpServer::open_live(LiveRequest request) {
  const std::uint64_t id = ++last_id_;
  const auto admission =
      live_table_.open(id, {address_group(request.who.caller.peer), request.who.login != 0},
                       ConnectionTable::Phase::kWorking, steady_now());
  FIELDCAST_CHECK(admission.admitted && !admission.evicted);
  const auto socket = LiveSocket::open(io_, std::move(request), make_, limits_.socket,
                                       [this, id, alive = std::weak_ptr(alive_)](LiveSocket* gone) {
                                         if (alive.expired()) return;
                                         live_table_.close(id);
                                         live_.erase(gone);
                                         look_for_end();
                                       });
  live_.emplace(socket.get(), socket);
}

void HttpServer::end_logins(std::uint64_t id) {
  for (const auto& [socket, kept] : live_) {
    if (socket->who().login == id) socket->end("the login has ended");
  }
}

// An open page counts as use of its login. The end of an expired login closes its pages.
void HttpServer::keep_house() {
  house_.expires_after(kHousekeeping);
  house_.async_wait([this](error_code cancelled) {
    if (cancelled) return;
    const Instant now = steady_now();
    for (const auto& [socket, kept] : live_) site_.book().touch(socket->who().login, now);
    site_.book().end_expired(now);
    keep_house();
  });
}

void HttpServer::close(std::function<void()> done) {
  closing_ = true;
  done_ = std::move(done);
  house_.cancel();
  if (tls_) tls_->close();
  forget_handshakes();
  for (const auto& [socket, kept] : live_) socket->end("the station stops");
  const auto sessions = sessions_;
  for (const auto& [key, session] : sessions) session->close();
  farewell_.expires_after(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(limits_.farewell));
  farewell_.async_wait([this](error_code cancelled) {
    if (cancelled) return;
    const auto live = live_;
    for (const auto& [socket, kept] : live) socket->drop();
  });
  look_for_end();
}

void HttpServer::look_for_end() {
  if (!done_ || !sessions_.empty() || !live_.empty()) return;
  farewell_.cancel();
  asio::post(io_, std::exchange(done_, {}));
}

ServerCounters HttpServer::counters() const {
  return {accepted_,
          shared_.requests,
          shared_.faults,
          turned_away_,
          sessions_.size() + handshakes_.size(),
          live_.size()};
}

}  // namespace fieldcast::web
