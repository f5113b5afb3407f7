#include "tools/station/web/station_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <utility>

#include "bridge/base/check.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "core/access/network.hpp"

namespace fieldcast::web {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::seconds kHousekeeping{30};

}  // namespace

StationServer::StationServer(asio::io_context& io, Site& site, MakeLiveProtocol make,
                             const StationLimits& limits)
    : io_(io),
      site_(site),
      make_(std::move(make)),
      limits_(limits),
      http_(io, *this, limits),
      live_table_(limits.live),
      house_(io),
      farewell_(io) {
  site_.on_ended([this](std::uint64_t id) { end_logins(id); });
  keep_house();
}

StationServer::~StationServer() {
  site_.on_ended({});
  http_.close();
  for (const auto& [socket, kept] : live_) socket->drop();
}

void StationServer::handle(RawRequest request, Reply reply) {
  site_.handle(std::move(request), std::move(reply));
}

HttpResponse StationServer::refusal(unsigned status, std::string_view error,
                                    std::string_view hint) const {
  return site_.refusal(status, error, hint);
}

bool StationServer::has_login(const RawRequest& request) { return site_.has_login(request); }
std::size_t StationServer::body_limit(const RawRequest& head, std::size_t usual) {
  return std::max(usual, site_.body_limit(head));
}

tl::expected<HttpService::TakeStream, HttpResponse> StationServer::upgrade(
    const RawRequest& request) {
  auto who = site_.upgrade(request);
  if (!who) return tl::make_unexpected(std::move(who.error()));
  if (auto refused = refuse_live(*who)) return tl::make_unexpected(*std::move(refused));
  return [this, who = *who](std::unique_ptr<ByteStream> stream, std::string head) {
    open_live({std::move(stream), std::move(head), who});
  };
}

std::optional<HttpResponse> StationServer::refuse_live(const Site::Upgrade& who) {
  if (!make_) return site_.refusal(404, "no WebSocket here", "this station has no live values");
  const auto of_one = std::ranges::count_if(live_, [&](const auto& each) {
    const Site::Upgrade& other = each.first->who();
    return other.login != 0 && other.caller.user == who.caller.user;
  });
  const bool too_many_of_one =
      who.login != 0 && static_cast<std::size_t>(of_one) >= limits_.live_of_one;
  const bool fits = live_table_
                        .admission({access::address_group(who.caller.peer), who.login != 0},
                                   ConnectionTable::Phase::kWorking)
                        .admitted;
  if (fits && !too_many_of_one) return std::nullopt;
  ++live_refused_;
  log_counted(LogLevel::kWarning, "web", "WebSockets beyond the limit",
              fmt::format("{} at {}: {} are open", who.caller.user, who.caller.peer, live_.size()));
  return site_.refusal(503, "too many open pages",
                       too_many_of_one ? "close other pages of yours" : "try again later");
}

// REQUIRES: refuse_live() has just admitted the request.
void StationServer::open_live(LiveRequest request) {
  const std::uint64_t id = ++last_live_;
  const auto admission =
      live_table_.open(id, {access::address_group(request.who.caller.peer), request.who.login != 0},
                       ConnectionTable::Phase::kWorking, steady_now());
  FIELDCAST_CHECK(admission.admitted && !admission.evicted);
  const auto socket =
      LiveSocket::open(io_, std::move(request), make_, limits_.socket,
                       [this, id, alive = std::weak_ptr(alive_)](LiveSocket* closed) {
                         if (alive.expired()) return;
                         live_table_.close(id);
                         live_.erase(closed);
                         look_for_end();
                       });
  live_.emplace(socket.get(), socket);
}

void StationServer::end_logins(std::uint64_t id) {
  for (const auto& [socket, kept] : live_) {
    if (socket->who().login == id) socket->end("the login has ended");
  }
}

// An open page counts as use of its login. The end of an expired login closes its pages.
void StationServer::keep_house() {
  house_.expires_after(kHousekeeping);
  house_.async_wait([this](error_code cancelled) {
    if (cancelled) return;
    const Instant now = steady_now();
    for (const auto& [socket, kept] : live_) site_.book().touch(socket->who().login, now);
    site_.book().end_expired(now);
    keep_house();
  });
}

void StationServer::close(std::function<void()> done) {
  done_ = std::move(done);
  house_.cancel();
  http_.close();
  for (const auto& [socket, kept] : live_) socket->end("the station stops");
  farewell_.expires_after(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(limits_.farewell));
  farewell_.async_wait([this](error_code cancelled) {
    if (cancelled) return;
    const auto live = live_;
    for (const auto& [socket, kept] : live) socket->drop();
  });
  look_for_end();
}

void StationServer::look_for_end() {
  if (!done_ || !live_.empty()) return;
  farewell_.cancel();
  asio::post(io_, std::exchange(done_, {}));
}

StationCounters StationServer::counters() const {
  StationCounters all{http_.counters(), live_.size()};
  all.turned_away += live_refused_;
  return all;
}

}  // namespace fieldcast::web
