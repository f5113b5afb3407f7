#include "tools/station/web/http_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <utility>

#include "bridge/bus/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast::web {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::chrono::seconds kHousekeeping{30};
// What the kernel keeps for a client that reads slowly: more would be old when it arrives.
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
              [this](HttpSession* session) {
                sessions_.erase(session);
                look_for_end();
              }},
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

void HttpServer::serve(std::unique_ptr<TlsServer> tls) { tls_ = std::move(tls); }

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
  if (handshakes_.size() >= limits_.handshakes) {
    ++turned_away_;
    const auto end = std::move(handshakes_.begin()->second);
    handshakes_.erase(handshakes_.begin());
    end();
  }
  const std::uint64_t id = ++last_handshake_;
  auto end = tls_->shake_hands(std::move(socket), limits_.handshake,
                               [this, id, peer = std::move(peer)](TlsResult stream) {
                                 handshakes_.erase(id);
                                 if (stream) return accept(*std::move(stream), peer);
                                 ++shared_.faults;
                               });
  handshakes_.emplace(id, std::move(end));
}

void HttpServer::accept(std::unique_ptr<ByteStream> stream, std::string peer) {
  ++accepted_;
  if (closing_ || !make_way()) {
    ++turned_away_;
    return stream->close();
  }
  const auto session = std::make_shared<HttpSession>(shared_, std::move(stream), std::move(peer));
  sessions_.emplace(session.get(), session);
  session->start();
}

// For one more connection; false: there is none to spare.
bool HttpServer::make_way() {
  if (sessions_.size() < limits_.connections) return true;
  std::shared_ptr<HttpSession> oldest;
  for (const auto& [key, session] : sessions_) {
    if (session->is_idle() && (!oldest || session->since() < oldest->since())) oldest = session;
  }
  if (!oldest) return false;
  ++turned_away_;
  oldest->close();
  return true;
}

std::optional<HttpResponse> HttpServer::refuse_live(const Site::Upgrade& who) {
  if (!make_) return site_.refusal(404, "no WebSocket here", "this station has no live values");
  const auto of_one = std::ranges::count_if(live_, [&](const auto& each) {
    const Site::Upgrade& other = each.first->who();
    return other.login != 0 && other.caller.user == who.caller.user;
  });
  const bool too_many_of_one =
      who.login != 0 && static_cast<std::size_t>(of_one) >= limits_.live_of_one;
  if (live_.size() < limits_.live && !too_many_of_one) return std::nullopt;
  ++turned_away_;
  log_counted(LogLevel::kWarning, "web", "WebSockets beyond the limit",
              fmt::format("{} at {}: {} are open", who.caller.user, who.caller.peer, live_.size()));
  return site_.refusal(503, "too many open pages",
                       too_many_of_one ? "close other pages of yours" : "try again later");
}

void HttpServer::open_live(LiveRequest request) {
  const auto socket = LiveSocket::open(io_, std::move(request), make_, limits_.socket,
                                       [this, alive = std::weak_ptr(alive_)](LiveSocket* gone) {
                                         if (alive.expired()) return;
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

// An open page is a use of its login; a login that has expired ends its pages.
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
  handshakes_.clear();
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
