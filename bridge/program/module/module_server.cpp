#include "bridge/program/module/module_server.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <array>
#include <boost/asio/io_context.hpp>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/port/stream.hpp"
#include "bridge/program/module/module_handshake.hpp"

namespace fieldcast::program {

namespace asio = boost::asio;
using asio::ip::tcp;

// A registered module without a bus. While it is not leased, its bytes are dropped and its
// disconnection is noticed.
class ModuleServer::Kept : public std::enable_shared_from_this<Kept> {
 public:
  Kept(ModuleServer& server, std::string number, tcp::socket socket, std::uint64_t arrived,
       std::shared_ptr<void> presence)
      : arrival(arrived),
        server_(server),
        number_(std::move(number)),
        socket_(std::move(socket)),
        presence_(std::move(presence)) {}

  const std::uint64_t arrival;

  void listen() {
    if (over_ || leased_ || std::exchange(listening_, true)) return;
    socket_.async_wait(
        tcp::socket::wait_read, [self = shared_from_this()](boost::system::error_code fault) {
          self->listening_ = false;
          if (self->over_ || self->leased_) return;
          std::array<std::uint8_t, 1024> dropped;
          const ssize_t size = fault ? -1
                                     : ::recv(self->socket_.native_handle(), dropped.data(),
                                              dropped.size(), MSG_DONTWAIT);
          if (size == 0 || (size < 0 && (fault || (errno != EAGAIN && errno != EINTR))))
            return self->lost();
          self->listen();
        });
  }
  FileDescriptor lease(std::function<void(std::string)> revoked) {
    if (over_ || leased_) return {};
    leased_ = true;
    revoked_ = std::move(revoked);
    return FileDescriptor(::fcntl(socket_.native_handle(), F_DUPFD_CLOEXEC, 0));
  }
  void end_lease(bool lost_now) {
    if (!std::exchange(leased_, false)) return;
    revoked_ = {};
    tune_socket(socket_.native_handle());  // the session had its own timeout
    lost_now ? lost() : listen();
  }
  // Releases the connection; returns an invalid one while it is leased.
  ModuleConnection release() {
    if (leased_ || std::exchange(over_, true)) return {};
    boost::system::error_code fault;
    const int fd = socket_.release(fault);
    if (fault) return {};
    return {FileDescriptor(fd), arrival, std::move(presence_)};
  }
  void close(const std::string& reason) {
    if (std::exchange(over_, true)) return;
    boost::system::error_code ignored;
    socket_.close(ignored);
    presence_.reset();
    if (const auto revoked = std::exchange(revoked_, {})) revoked(reason);
  }

 private:
  void lost() {
    log_counted(LogLevel::kInfo, "modules", "lines about module " + number_,
                fmt::format("module {} disconnected", number_));
    const auto self = shared_from_this();
    close("the module disconnected");
    const auto found = server_.kept_.find(number_);
    if (found != server_.kept_.end() && found->second == self) server_.kept_.erase(found);
  }

  ModuleServer& server_;
  std::string number_;
  tcp::socket socket_;
  std::shared_ptr<void> presence_;
  std::function<void(std::string)> revoked_;
  bool over_ = false, leased_ = false, listening_ = false;
};

ModuleServer::ModuleServer(asio::io_context& io, DialInRegistry& registry, const Hooks& hooks)
    : io_(io), registry_(registry), hooks_(hooks) {}

ModuleServer::~ModuleServer() { close(); }

tl::expected<void, std::string> ModuleServer::listen(const ModulesSpec& spec) {
  auto gate = ModuleGate::make(spec);
  if (!gate) return tl::unexpected(gate.error());
  gate_ = *std::move(gate);
  const bool same_address = listener_ && spec.listen == spec_.listen;
  spec_ = spec;
  if (same_address) return {};
  listener_.reset();
  auto made =
      std::make_unique<Listener>(io_, [this](tcp::socket socket) { came(std::move(socket)); });
  auto listening = made->open(spec_.listen);
  if (listening) listener_ = std::move(made);
  return listening;
}

std::uint16_t ModuleServer::port() const {
  return listener_ ? listener_->port() : std::uint16_t{0};
}

void ModuleServer::came(tcp::socket socket) {
  const std::string address = address_of(socket);
  if (!gate_->admits(host_of(address))) return refused(address, "no module dials in from there");
  const auto arrival = std::make_shared<Handshake>(*this, gate_, std::move(socket), address);
  arrival->id = silent_.add(host_of(address), [this, weak = std::weak_ptr(arrival), address] {
    const auto oldest = weak.lock();
    if (!oldest) return;
    oldest->close();
    arrivals_.erase(oldest);
    displaced(address);
  });
  arrivals_.insert(arrival);
  arrival->start();
}

bool ModuleServer::connected(const std::string& number) const {
  const auto found = present_.find(number);
  return found != present_.end() && !found->second.expired();
}

std::shared_ptr<void> ModuleServer::appear(const std::string& number) {
  // Removes numbers that are no longer connected, also those of refused modules.
  if (present_.size() >= 2 * kMaxKept)
    std::erase_if(present_, [](const auto& entry) { return entry.second.expired(); });
  const auto presence = std::make_shared<char>();
  present_[number] = presence;
  return presence;
}

// Logs the first displacement and counts the others.
void ModuleServer::displaced(const std::string& address) {
  const auto verdict = displacements_.occurred("silent", steady_now());
  if (!verdict.log) return;
  const std::string more =
      verdict.suppressed == 0 ? "" : fmt::format(" ({} more before)", verdict.suppressed);
  refused(address,
          "too many modules have not sent their number; the oldest is disconnected" + more);
}

void ModuleServer::registered(const std::string& number, tcp::socket socket,
                              const std::string& address) {
  log_counted(LogLevel::kInfo, "modules", "lines about module " + number,
              fmt::format("module {} dialled in from {}", number, address));
  boost::system::error_code fault;
  FileDescriptor released(socket.release(fault));
  if (fault) return;
  if (closed_) return;
  auto ours = registry_.offer(number, std::move(released), appear(number));
  drop_kept(number);
  if (ours) keep_new(number, std::move(*ours), address);
}

void ModuleServer::keep(const std::string& number, ModuleConnection connection) {
  if (closed_) return;
  const auto before = kept_.find(number);
  if (before != kept_.end() && before->second->arrival > connection.arrival) return;
  drop_kept(number);
  // A bus may have been added meanwhile.
  if (auto ours = registry_.offer(number, std::move(connection)))
    keep_new(number, std::move(*ours), "a bus that has ended");
}

void ModuleServer::drop_kept(const std::string& number) {
  const auto found = kept_.find(number);
  if (found == kept_.end()) return;
  const auto old = found->second;
  kept_.erase(found);
  old->close("the module connected again");
}

void ModuleServer::keep_new(const std::string& number, ModuleConnection connection,
                            const std::string& address) {
  auto adopted = adopt_socket(io_, std::move(connection.socket));
  if (!adopted) return;
  if (kept_.size() >= kMaxKept)
    return refused(address, fmt::format("module {} is one too many without a bus", number));
  const auto module = std::make_shared<Kept>(*this, number, std::move(*adopted), connection.arrival,
                                             std::move(connection.presence));
  kept_.emplace(number, module);
  module->listen();
}

ModuleConnection ModuleServer::hand_over(const std::string& number) {
  const auto found = kept_.find(number);
  if (found == kept_.end()) return {};
  const auto module = found->second;
  ModuleConnection connection = module->release();
  if (connection.socket.valid()) kept_.erase(number);
  return connection;
}

void ModuleServer::refused(const std::string& address, const std::string& reason) {
  log_counted(LogLevel::kWarning, "modules", "connections refused",
              fmt::format("{}: {}", address, reason));
  if (hooks_.audit) hooks_.audit({address, "", 0, 0, "module turned away: " + reason});
}

FileDescriptor ModuleServer::lease(const std::string& number,
                                   std::function<void(std::string)> revoked) {
  const auto found = kept_.find(number);
  return found == kept_.end() ? FileDescriptor{} : found->second->lease(std::move(revoked));
}

void ModuleServer::end_lease(const std::string& number, bool lost) {
  const auto found = kept_.find(number);
  if (found == kept_.end()) return;
  const auto module = found->second;
  module->end_lease(lost);
  if (lost || !registry_.expects(number)) return;
  if (auto connection = hand_over(number); connection.socket.valid())
    registry_.pass_on(number, std::move(connection));
}

std::vector<std::string> ModuleServer::kept() const {
  std::vector<std::string> numbers;
  for (const auto& [number, module] : kept_) numbers.push_back(number);
  return numbers;
}

void ModuleServer::close() {
  if (std::exchange(closed_, true)) return;
  listener_.reset();
  for (const auto& arrival : std::exchange(arrivals_, {})) arrival->close();
  for (const auto& [number, module] : std::exchange(kept_, {})) module->close("the bridge stops");
  for (const auto& pipe : std::exchange(pipes_, {})) pipe->close();
}

}  // namespace fieldcast::program
