#include "bridge/program/module_desk.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>

#include "bridge/clock.hpp"
#include "bridge/log.hpp"
#include "bridge/port/connection.hpp"

namespace fieldcast::program {

namespace asio = boost::asio;
using asio::ip::tcp;

// A module whose number is being asked for. Handlers hold it; once over_ is set they do nothing.
class ModuleDesk::Asked : public std::enable_shared_from_this<Asked> {
 public:
  Asked(ModuleDesk& desk, tcp::socket socket)
      : desk_(desk),
        socket_(std::move(socket)),
        timer_(desk.io_),
        registration_(desk.spec_.registration),
        address_(address_of(socket_)) {}

  void start() {
    boost::system::error_code ignored;
    socket_.non_blocking(true, ignored);
    tune_socket(socket_.native_handle());
    follow(registration_.start(steady_now()));
    read();
  }
  void close() {
    over_ = true;
    timer_.cancel();
    boost::system::error_code ignored;
    socket_.close(ignored);
  }

 private:
  void read() {
    if (over_) return;
    socket_.async_read_some(asio::buffer(buffer_),
                            [self = shared_from_this()](boost::system::error_code fault, std::size_t count) {
                              if (self->over_) return;
                              if (fault) return self->end("the module is gone before it told its number");
                              self->follow(self->registration_.on_bytes(ByteView(self->buffer_.data(), count), steady_now()));
                              self->read();
                            });
  }

  void follow(Registration::Outcome outcome) {
    if (!outcome.send.empty() && ::send(socket_.native_handle(), outcome.send.data(), outcome.send.size(), MSG_NOSIGNAL) !=
                                     static_cast<ssize_t>(outcome.send.size())) {
      return end("the module takes no question");
    }
    if (outcome.fault) return end(*outcome.fault);
    if (outcome.number) {
      over_ = true;
      timer_.cancel();
      const auto self = shared_from_this();
      desk_.asked_.erase(self);
      return desk_.registered(*outcome.number, std::move(socket_), address_);
    }
    timer_.expires_at(std::chrono::steady_clock::time_point{outcome.wake.time_since_epoch()});
    timer_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
      if (!cancelled && !self->over_) self->follow(self->registration_.on_timer(steady_now()));
    });
  }

  void end(const std::string& reason) {
    const auto self = shared_from_this();
    close();
    desk_.refused(address_, reason);
    desk_.asked_.erase(self);
  }

  ModuleDesk& desk_;
  tcp::socket socket_;
  asio::steady_timer timer_;
  Registration registration_;
  std::string address_;
  bool over_ = false;
  std::array<std::uint8_t, 256> buffer_;
};

// A registered module that is no bus. While nobody programs it, what it says is dropped and its loss noticed.
class ModuleDesk::Kept : public std::enable_shared_from_this<Kept> {
 public:
  Kept(ModuleDesk& desk, std::string number, tcp::socket socket)
      : desk_(desk), number_(std::move(number)), socket_(std::move(socket)) {}

  void listen() {
    if (over_ || lent_ || std::exchange(listening_, true)) return;
    socket_.async_wait(tcp::socket::wait_read, [self = shared_from_this()](boost::system::error_code fault) {
      self->listening_ = false;
      if (self->over_ || self->lent_) return;
      std::array<std::uint8_t, 1024> dropped;
      const ssize_t size = fault ? -1 : ::recv(self->socket_.native_handle(), dropped.data(), dropped.size(), MSG_DONTWAIT);
      if (size == 0 || (size < 0 && (fault || (errno != EAGAIN && errno != EINTR)))) return self->lost();
      self->listen();
    });
  }
  FileDescriptor lend(std::function<void(std::string)> revoked) {
    if (over_ || lent_) return {};
    lent_ = true;
    revoked_ = std::move(revoked);
    return FileDescriptor(::fcntl(socket_.native_handle(), F_DUPFD_CLOEXEC, 0));
  }
  void take_back(bool lost_now) {
    if (!std::exchange(lent_, false)) return;
    revoked_ = {};
    lost_now ? lost() : listen();
  }
  void close(const std::string& reason) {
    if (std::exchange(over_, true)) return;
    boost::system::error_code ignored;
    socket_.close(ignored);
    if (const auto revoked = std::exchange(revoked_, {})) revoked(reason);
  }

 private:
  void lost() {
    log_info("modules", "module " + number_ + " is gone");
    const auto self = shared_from_this();
    close("the module is gone");
    const auto found = desk_.kept_.find(number_);
    if (found != desk_.kept_.end() && found->second == self) desk_.kept_.erase(found);
  }

  ModuleDesk& desk_;
  std::string number_;
  tcp::socket socket_;
  std::function<void(std::string)> revoked_;
  bool over_ = false, lent_ = false, listening_ = false;
};

ModuleDesk::ModuleDesk(asio::io_context& io, ModulesSpec spec, DialInRegistry& registry, const Hooks& hooks)
    : io_(io), spec_(std::move(spec)), registry_(registry), hooks_(hooks), listener_(io, [this](tcp::socket socket) {
        came(std::move(socket));
      }) {}

ModuleDesk::~ModuleDesk() { close(); }

tl::expected<void, std::string> ModuleDesk::listen() { return listener_.open(spec_.listen); }
std::uint16_t ModuleDesk::port() const { return listener_.port(); }

void ModuleDesk::came(tcp::socket socket) {
  if (asked_.size() >= kMaxAsked) return refused(address_of(socket), "too many modules have not told their number");
  const auto asked = std::make_shared<Asked>(*this, std::move(socket));
  asked_.insert(asked);
  asked->start();
}

void ModuleDesk::registered(const std::string& number, tcp::socket socket, const std::string& address) {
  log_info("modules", fmt::format("module {} dialled in from {}", number, address));
  boost::system::error_code fault;
  FileDescriptor released(socket.release(fault));
  if (fault) return;
  auto ours = registry_.offer(number, std::move(released));
  if (!ours) return;
  tcp::socket kept(io_);
  kept.assign(spec_.listen.host.find(':') == std::string::npos ? tcp::v4() : tcp::v6(), ours->get(), fault);
  if (fault) return;
  (void)ours->release();
  const auto before = kept_.find(number);
  if (before != kept_.end()) {
    const auto old = before->second;
    kept_.erase(before);
    old->close("the module dialled in anew");
  }
  if (kept_.size() >= kMaxKept) return refused(address, fmt::format("module {} is one too many without a bus", number));
  const auto module = std::make_shared<Kept>(*this, number, std::move(kept));
  kept_.emplace(number, module);
  module->listen();
}

void ModuleDesk::refused(const std::string& address, const std::string& reason) {
  log_warning("modules", address + ": " + reason);
  if (hooks_.audit) hooks_.audit({address, "", 0, 0, "module turned away: " + reason});
}

FileDescriptor ModuleDesk::lend(const std::string& number, std::function<void(std::string)> revoked) {
  const auto found = kept_.find(number);
  return found == kept_.end() ? FileDescriptor{} : found->second->lend(std::move(revoked));
}

void ModuleDesk::take_back(const std::string& number, bool lost) {
  const auto found = kept_.find(number);
  if (found == kept_.end()) return;
  const auto module = found->second;
  module->take_back(lost);
}

void ModuleDesk::close() {
  if (std::exchange(closed_, true)) return;
  listener_.close();
  for (const auto& asked : std::exchange(asked_, {})) asked->close();
  for (const auto& [number, module] : std::exchange(kept_, {})) module->close("the bridge stops");
}

}  // namespace fieldcast::program
