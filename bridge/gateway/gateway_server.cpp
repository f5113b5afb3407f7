#include "bridge/gateway/gateway_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/base/io_thread.hpp"
#include "bridge/log/log.hpp"
#include "bridge/net/byte_stream.hpp"
#include "core/access/network.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

constexpr std::size_t kPiece = 1024;  // bytes of one read

// Reads, writes and their limits for one client. The handlers share it.
class Client : public std::enable_shared_from_this<Client> {
 public:
  struct Handlers {
    std::function<void(Client&, ByteView)> bytes;
    std::function<void(const std::string& requester)> closed;  // not after close()
  };
  Client(tcp::socket socket, gateway::ClientSession of_client, Handlers handlers)
      : session(std::move(of_client)),
        stream_(socket_stream(std::move(socket))),
        handlers_(std::move(handlers)) {}

  gateway::ClientSession session;
  Instant last_request = steady_now();

  void read() {
    if (closed_ || reading_ || unsent() > GatewayServer::kMaxUnsent) return;
    reading_ = true;
    stream_->read_some(asio::buffer(piece_), [self = shared_from_this()](auto fault, auto count) {
      self->reading_ = false;
      if (self->closed_) return;
      if (fault) return self->end();
      self->handlers_.bytes(*self, ByteView(self->piece_).first(count));
      self->read();
    });
  }
  void send(ByteView bytes) {
    append(waiting_, bytes);
    write();
  }
  void close() {
    if (std::exchange(closed_, true)) return;
    stream_->close();
  }

 private:
  [[nodiscard]] std::size_t unsent() const { return waiting_.size() + writing_.size(); }
  void end() {
    close();
    handlers_.closed(session.requester());
  }
  void write() {
    if (closed_ || !writing_.empty() || waiting_.empty()) return;
    writing_.swap(waiting_);
    write_rest(0);
  }
  void write_rest(std::size_t from) {
    stream_->write_some(asio::buffer(writing_) + from,
                        [self = shared_from_this(), from](auto fault, auto count) {
                          if (self->closed_) return;
                          if (fault) return self->end();
                          if (from + count < self->writing_.size())
                            return self->write_rest(from + count);
                          self->writing_.clear();
                          self->write();
                          self->read();
                        });
  }

  const std::unique_ptr<ByteStream> stream_;
  const Handlers handlers_;
  std::array<std::uint8_t, kPiece> piece_;
  Bytes waiting_, writing_;
  bool reading_ = false, closed_ = false;
};

}  // namespace

struct GatewayServer::State {
  State(const BusSpec& bus, Uses given)
      : spec(*bus.gateway), units(gateway::units_of(bus)), uses(std::move(given)), name(bus.name) {
    for (const std::string& text : spec.clients) {
      if (const auto network = access::Network::parse(text)) networks.push_back(*network);
    }
  }

  void open();
  void accept(tcp::socket socket);
  void received(Client& client, ByteView bytes);
  // A command that is refused immediately has its response in `out`.
  void submit(Client& client, std::vector<Command> commands, Bytes& out);
  void completed(const CommandResult& result);
  void refuse(const std::string& address, std::string_view reason);
  // Closes the client that has been silent longest; returns false if each has requests in flight.
  bool displace();
  void drop(const std::string& requester);
  void tick();
  void close();

  const GatewaySpec spec;
  const gateway::Units units;
  const Uses uses;
  std::vector<access::Network> networks;
  const std::string name;  // of the bus
  gateway::Counters counters;
  std::map<std::string, std::shared_ptr<Client>> clients;  // by requester
  std::atomic<std::uint16_t> port{0};
  int failures = 0;        // to listen
  IoThread io{"gateway"};  // outlives the members below, and ends before those above
  asio::steady_timer again{io.context()}, ticking{io.context()};
  std::optional<Listener> listener;
};

void GatewayServer::State::open() {
  listener.emplace(io.context(), [this](tcp::socket socket) { accept(std::move(socket)); });
  if (const auto listening = listener->open(spec.listen); !listening) {
    listener.reset();
    // A successor on the same machine may be faster than the kernel, which closes the port of the
    // killed master, so the first failure says nothing.
    if (++failures == 2)
      log_error(name, fmt::format("{}: the gateway is not served, the bus runs; tried again "
                                  "every {} until it succeeds",
                                  listening.error(), to_text(kTryAgain)));
    again.expires_after(kTryAgain);
    return again.async_wait([this](boost::system::error_code cancelled) {
      if (!cancelled) open();
    });
  }
  port = listener->port();
  log_info(name,
           fmt::format("gateway: Modbus TCP clients {} at {}:{}",
                       spec.writes ? "read and write" : "read", spec.listen.host, port.load()));
}

void GatewayServer::State::accept(tcp::socket socket) {
  const std::string address = address_of(socket);
  const bool permitted =
      networks.empty() || std::ranges::any_of(networks, [&](const access::Network& network) {
        return network.contains(host_of(address));
      });
  if (!permitted) return refuse(address, "its address is not permitted (clients)");
  if (clients.size() >= spec.connections && !displace())
    return refuse(address, "too many clients have requests in flight (connections)");
  boost::system::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  socket.non_blocking(true, ignored);
  const std::string requester = "gateway " + address;
  // UTC, so that no command of an earlier client has the same requester and id.
  const auto first_id = static_cast<std::uint64_t>(read_clocks().utc.nanoseconds);
  const auto client = std::make_shared<Client>(
      std::move(socket), gateway::ClientSession(spec, units, requester, first_id, counters),
      Client::Handlers{[this](Client& from, ByteView bytes) { received(from, bytes); },
                       [this](const std::string& closed) { clients.erase(closed); }});
  drop(requester);  // an earlier connection of the same address and port is dead
  clients[requester] = client;
  client->read();
}

void GatewayServer::State::received(Client& client, ByteView bytes) {
  Bytes out;
  std::vector<Command> commands;
  const Instant now = steady_now();
  const std::uint64_t before = counters.requests;
  const auto valid = client.session.on_bytes(bytes, now, out, commands);
  if (counters.requests != before) client.last_request = now;
  submit(client, std::move(commands), out);
  client.send(out);
  if (valid) return;
  const std::string requester = client.session.requester();
  refuse(requester, fmt::format("disconnected: {}", to_text(valid.error())));
  drop(requester);
}

void GatewayServer::State::submit(Client& client, std::vector<Command> commands, Bytes& out) {
  while (!commands.empty()) {
    std::vector<Command> next;
    for (const Command& command : commands) {
      if (const auto refused = uses.submit(command)) client.session.on_result(*refused, out, next);
    }
    commands.swap(next);
  }
}

void GatewayServer::State::completed(const CommandResult& result) {
  const auto client = clients.find(result.requester);
  if (client == clients.end()) return;
  Bytes out;
  std::vector<Command> commands;
  client->second->session.on_result(result, out, commands);
  submit(*client->second, std::move(commands), out);
  client->second->send(out);
}

void GatewayServer::State::refuse(const std::string& address, std::string_view reason) {
  ++counters.refused_clients;
  log_counted(LogLevel::kWarning, name, "refused clients of the gateway",
              fmt::format("{}: {}", address, reason));
}

bool GatewayServer::State::displace() {
  const std::pair<const std::string, std::shared_ptr<Client>>* silent = nullptr;
  for (const auto& each : clients) {
    if (each.second->session.pending() != 0) continue;
    if (silent == nullptr || each.second->last_request < silent->second->last_request)
      silent = &each;
  }
  if (silent == nullptr) return false;
  drop(std::string(silent->first));
  return true;
}

void GatewayServer::State::drop(const std::string& requester) {
  const auto client = clients.extract(requester);
  if (client) client.mapped()->close();
}

void GatewayServer::State::tick() {
  const Instant now = steady_now();
  std::vector<std::string> idle;
  for (const auto& [requester, client] : clients) {
    const Duration waits = client->session.pending() == 0 ? Duration::zero() : spec.timeout;
    if (now - client->last_request > spec.idle + waits) idle.push_back(requester);
  }
  for (const std::string& requester : idle) drop(requester);
  counters.clients = clients.size();
  uses.report(counters);
  ticking.expires_after(std::chrono::seconds{1});
  ticking.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled) tick();
  });
}

void GatewayServer::State::close() {
  again.cancel();
  ticking.cancel();
  listener.reset();
  for (const auto& [requester, client] : clients) client->close();
  clients.clear();
}

GatewayServer::GatewayServer(const BusSpec& bus, Uses uses)
    : state_(std::make_unique<State>(bus, std::move(uses))) {}

void GatewayServer::start() {
  asio::post(state_->io.context(), [&state = *state_] {
    state.open();
    state.tick();
  });
}

GatewayServer::~GatewayServer() {
  state_->io.run([this] { state_->close(); });
  state_->io.run([] {});  // the cancelled handlers have run
}

void GatewayServer::complete(const CommandResult& result) {
  asio::post(state_->io.context(), [&state = *state_, result] { state.completed(result); });
}

std::uint16_t GatewayServer::port() const { return state_->port; }

}  // namespace fieldcast
