// Fuzzes the station's server with any bytes of a client, cut as the input says: requests,
// WebSocket handshake, frames. The station must send HTTP/1.1, require a login for protected data,
// accept commands only from its own pages, limit messages, and release everything when the client
// disconnects.
//
// Input: size of a piece and whether every client has all rights (1), then the stream.
#include <boost/asio/io_context.hpp>
#include <cstdlib>

#include "bridge/base/clock.hpp"
#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/tools/station/web/memory_stream.hpp"
#include "tools/station/web/station_server.hpp"

namespace fieldcast::web {
namespace {

constexpr std::size_t kMaxMessage = 4 * 1024;
constexpr std::size_t kMaxBody = 64 * 1024;

using fuzz::require;

class Protocol final : public LiveProtocol {
 public:
  explicit Protocol(LivePeer& peer) : peer_(peer) {}
  void on_open(Instant now) override {
    peer_.send_text("{}");
    on_taken(now);
  }
  void on_text(std::string_view message, Instant) override {
    require(!closed_ && message.size() <= kMaxMessage);
    message.size() % 7 == 3 ? peer_.close("enough") : peer_.send_text(std::string(message));
  }
  void on_taken(Instant) override {
    require(!closed_);
    if (++frames_ < 5) peer_.send_binary(std::make_shared<const std::string>(1000, 'b'));
  }
  void on_wake(Instant) override { require(!closed_); }
  void on_closed() override { closed_ = true; }

 private:
  LivePeer& peer_;
  int frames_ = 0;
  bool closed_ = false;
};

void run_one(ByteView data) {
  if (data.empty()) return;
  const bool open = data[0] % 2 == 1;
  const std::size_t piece = data[0] / 2 + 1u;
  std::string_view rest(reinterpret_cast<const char*>(data.data()) + 1, data.size() - 1);
  const bool own_page = rest.find("http://127.0.0.1:8090") != rest.npos;
  boost::asio::io_context io;
  Site site({.listen = {"127.0.0.1", 8090}}, {steady_now, [] { return UtcTime{}; }}, {});
  if (open) site.set_local_role(Role::kOperator);
  site.routes().add({Method::kGet, "/values", Access::kViewer,
                     [&](const HttpRequest&, const Caller&, const Reply& reply) {
                       require(open);
                       reply({});
                     }});
  site.routes().add({Method::kPost, "/command", Access::kOperator,
                     [&](const HttpRequest& request, const Caller&, const Reply& reply) {
                       require(open && own_page && request.body.size() <= kMaxBody);
                       HttpResponse response;
                       response.body = request.body;
                       reply(std::move(response));
                     }});
  StationLimits limits;
  limits.socket.handshake = std::chrono::milliseconds{1};
  const auto make = [&](const Caller&, LivePeer& peer) {
    require(open && own_page);
    return std::make_unique<Protocol>(peer);
  };
  StationServer server(io, site, make, limits);
  const auto link = std::make_shared<MemoryLink>();
  server.http().accept(std::make_unique<MemoryStream>(io, link), "127.0.0.1");
  while (!rest.empty() && !link->station_closed) {
    link->to_station += rest.substr(0, piece);
    rest.remove_prefix(std::min(piece, rest.size()));
    link->wake();
    io.poll();
    io.restart();
  }
  link->client_gone = true;
  link->wake();
  io.poll();
  io.restart();
  // If both sides close at the same time, only the time limit may end the close.
  for (int i = 0; i < 100 && !link->station_closed; ++i)
    io.run_one_for(std::chrono::milliseconds{20});
  io.poll();
  require(link->to_client.empty() || link->to_client.starts_with("HTTP/1.1 "));
  require(link->station_closed);
  require(server.counters().open == 0 && server.counters().live == 0);
}

}  // namespace
}  // namespace fieldcast::web

FIELDCAST_FUZZ_TARGET(fieldcast::web::run_one)
