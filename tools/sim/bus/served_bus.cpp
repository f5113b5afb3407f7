#include "tools/sim/bus/served_bus.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "tools/sim/port/tcp_listener.hpp"

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMaxConnections = 64;  // of one bus; further ones are closed immediately

bool receive(int fd, BusLine& line, Instant now) {
  std::array<std::uint8_t, 4096> buffer;
  const ssize_t count = ::read(fd, buffer.data(), buffer.size());
  if (count > 0) line.receive(ByteView(buffer.data(), static_cast<std::size_t>(count)), now);
  return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
}

// Unplugs and plugs the port according to the faults.
class PluggedBus : public ServedBus {
 public:
  explicit PluggedBus(SimBus& bus) : bus_(bus) {}

  tl::expected<void, std::string> open(Instant now) override {
    if (unplugged(now)) return {};
    auto opened = plug();
    plugged_ = opened.has_value();
    return opened;
  }

  Instant on_time(Instant now) override {
    if (plugged_ && unplugged(now)) {
      unplug();
      plugged_ = false;
    } else if (!plugged_ && !unplugged(now) && now >= next_try_) {
      plugged_ = plug().has_value();
      next_try_ = now + 1s;  // the path may be in use meanwhile
    }
    if (plugged_) return std::min(advance(now), next_change(now));
    return unplugged(now) ? next_change(now) : next_try_;
  }

 protected:
  [[nodiscard]] virtual tl::expected<void, std::string> plug() = 0;
  virtual void unplug() = 0;
  virtual Instant advance(Instant now) = 0;
  [[nodiscard]] SimBus& bus() { return bus_; }
  [[nodiscard]] bool plugged() const { return plugged_; }

 private:
  [[nodiscard]] bool unplugged(Instant now) const {
    return std::ranges::any_of(bus_.faults().unplugged, [&](const Window& window) {
      return window.holds(now - bus_.start());
    });
  }
  [[nodiscard]] Instant next_change(Instant now) const {
    Instant next = kNever;
    for (const Window& window : bus_.faults().unplugged) {
      for (const Duration edge : {window.from, window.to}) {
        if (edge != kForever && bus_.start() + edge > now)
          next = std::min(next, bus_.start() + edge);
      }
    }
    return next;
  }

  SimBus& bus_;
  bool plugged_ = false;
  Instant next_try_ = kLongAgo;
};

class SerialBus : public PluggedBus {
 public:
  SerialBus(SimBus& bus, Watcher& watcher)
      : PluggedBus(bus), watcher_(watcher), path_(std::get<SerialPortSpec>(bus.spec().port).path) {}
  ~SerialBus() override { SerialBus::unplug(); }

  [[nodiscard]] std::string location() const override {
    return path_ + (port_ ? " -> " + port_->terminal() : " (unplugged)");
  }

  void on_readable(int, Instant now) override {
    if (line_) receive(port_->fd(), *line_, now);
  }

 private:
  tl::expected<void, std::string> plug() override {
    auto port = PtyPort::open(path_);
    if (!port) return tl::unexpected(port.error());
    port_.emplace(std::move(*port));
    line_ = bus().open_line();
    watcher_.watch(port_->fd());
    return {};
  }

  void unplug() override {
    if (port_) watcher_.forget(port_->fd());
    line_.reset();
    port_.reset();
  }

  Instant advance(Instant now) override {
    if (now >= next_care_) {
      port_->forget_exclusive_use();
      next_care_ = now + 1s;
    }
    sent_.clear();
    line_->advance(now, sent_);
    // A full terminal has no reader; a line does not wait for its receivers.
    if (!sent_.empty()) [[maybe_unused]]
      const ssize_t count = ::write(port_->fd(), sent_.data(), sent_.size());
    return std::min(line_->next_due(), next_care_);
  }

  Watcher& watcher_;
  std::string path_;
  std::optional<PtyPort> port_;  // empty while unplugged
  std::unique_ptr<BusLine> line_;
  Bytes sent_;
  Instant next_care_ = kLongAgo;
};

class TcpBus : public PluggedBus {
 public:
  TcpBus(SimBus& bus, Watcher& watcher)
      : PluggedBus(bus), watcher_(watcher), spec_(std::get<TcpPortSpec>(bus.spec().port)) {}
  ~TcpBus() override { TcpBus::unplug(); }

  [[nodiscard]] std::string location() const override {
    const std::string loopback = loopback_for(spec_.host);
    const std::string location =
        fmt::format("{}:{}{}", loopback, spec_.port, plugged() ? "" : " (unplugged)");
    return loopback == spec_.host ? location : fmt::format("{} (for {})", location, spec_.host);
  }

  void on_readable(int fd, Instant now) override {
    if (fd == listener_.get()) {
      while (FileDescriptor accepted = accept_from(fd)) {
        if (connections_.size() >= kMaxConnections) continue;
        watcher_.watch(accepted.get());
        const int key = accepted.get();
        connections_.emplace(key, Connection{std::move(accepted), bus().open_line()});
      }
    } else if (const auto found = connections_.find(fd); found != connections_.end()) {
      if (!receive(fd, *found->second.line, now)) close(found);
    }
  }

 private:
  struct Connection {
    FileDescriptor fd;
    std::unique_ptr<BusLine> line;
  };

  tl::expected<void, std::string> plug() override {
    auto listener = listen_on(loopback_for(spec_.host), spec_.port);
    if (!listener) return tl::unexpected(listener.error());
    listener_ = std::move(*listener);
    watcher_.watch(listener_.get());
    return {};
  }

  void unplug() override {
    while (!connections_.empty()) close(connections_.begin());
    if (listener_) watcher_.forget(listener_.get());
    listener_.reset();
  }

  Instant advance(Instant now) override {
    Instant next = kNever;
    for (auto at = connections_.begin(); at != connections_.end();) {
      const auto current = at++;
      Connection& connection = current->second;
      sent_.clear();
      connection.line->advance(now, sent_);
      const auto size = static_cast<ssize_t>(sent_.size());
      // A peer that does not read a few hundred bytes is not a master.
      const bool taken =
          sent_.empty() || ::send(current->first, sent_.data(), sent_.size(), MSG_NOSIGNAL) == size;
      if (!taken || connection.line->hung_up()) {
        close(current);
      } else {
        next = std::min(next, connection.line->next_due());
      }
    }
    return next;
  }

  void close(std::map<int, Connection>::iterator connection) {
    watcher_.forget(connection->first);
    connections_.erase(connection);
  }

  Watcher& watcher_;
  TcpPortSpec spec_;
  FileDescriptor listener_;
  std::map<int, Connection> connections_;
  Bytes sent_;
};

// Each master has a line of its own, as a TCP connection.
class UdpBus : public PluggedBus {
 public:
  UdpBus(SimBus& bus, Watcher& watcher)
      : PluggedBus(bus), watcher_(watcher), spec_(std::get<TcpPortSpec>(bus.spec().port)) {}
  ~UdpBus() override { UdpBus::unplug(); }

  [[nodiscard]] std::string location() const override {
    return fmt::format("udp {}:{}{}", loopback_for(spec_.host), spec_.port,
                       plugged() ? "" : " (unplugged)");
  }

  void on_readable(int, Instant now) override {
    std::array<std::uint8_t, 4096> buffer;
    for (;;) {
      sockaddr_in peer{};
      socklen_t size = sizeof peer;
      const ssize_t count = ::recvfrom(socket_.get(), buffer.data(), buffer.size(), 0,
                                       reinterpret_cast<sockaddr*>(&peer), &size);
      if (count < 0) return;
      const auto key = std::pair(peer.sin_addr.s_addr, peer.sin_port);
      if (masters_.size() >= kMaxConnections && !masters_.contains(key))
        masters_.erase(masters_.begin());
      auto& line = masters_[key];
      if (!line) line = bus().open_line();
      line->receive(ByteView(buffer.data(), static_cast<std::size_t>(count)), now);
      respond(key, *line, now);
    }
  }

 private:
  using Master = std::pair<std::uint32_t, std::uint16_t>;  // address and port, as on the network

  tl::expected<void, std::string> plug() override {
    auto socket = receive_datagrams_on(loopback_for(spec_.host), spec_.port);
    if (!socket) return tl::unexpected(socket.error());
    socket_ = std::move(*socket);
    watcher_.watch(socket_.get());
    return {};
  }

  void unplug() override {
    masters_.clear();
    if (socket_) watcher_.forget(socket_.get());
    socket_.reset();
  }

  Instant advance(Instant now) override {
    Instant next = kNever;
    for (auto& [key, line] : masters_) {
      respond(key, *line, now);
      next = std::min(next, line->next_due());
    }
    return next;
  }

  // What is due at one instant is one datagram.
  void respond(const Master& master, BusLine& line, Instant now) {
    while (line.next_due() <= now) {
      Bytes frame;
      line.advance(std::max(line.next_due(), kLongAgo), frame);
      if (frame.empty()) continue;
      sockaddr_in peer{};
      peer.sin_family = AF_INET;
      peer.sin_addr.s_addr = master.first;
      peer.sin_port = master.second;
      (void)::sendto(socket_.get(), frame.data(), frame.size(), MSG_NOSIGNAL,
                     reinterpret_cast<const sockaddr*>(&peer), sizeof peer);
    }
  }

  Watcher& watcher_;
  TcpPortSpec spec_;
  FileDescriptor socket_;
  std::map<Master, std::unique_ptr<BusLine>> masters_;
};

}  // namespace

std::unique_ptr<ServedBus> serve(SimBus& bus, Watcher& watcher) {
  if (std::holds_alternative<SerialPortSpec>(bus.spec().port))
    return std::make_unique<SerialBus>(bus, watcher);
  if (std::get<TcpPortSpec>(bus.spec().port).datagrams)
    return std::make_unique<UdpBus>(bus, watcher);
  return std::make_unique<TcpBus>(bus, watcher);
}

}  // namespace fieldcast::sim
