#include "bridge/port/dial_in_port.hpp"

#include <sys/socket.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "bridge/port/connection.hpp"

namespace fieldcast {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;

std::optional<tcp::socket> adopt(asio::io_context& io, FileDescriptor fd) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) return std::nullopt;
  tcp::socket socket(io);
  boost::system::error_code fault;
  socket.assign(address.ss_family == AF_INET6 ? tcp::v6() : tcp::v4(), fd.get(), fault);
  if (fault) return std::nullopt;
  (void)fd.release();
  return socket;
}

}  // namespace

// One opening of the port: waits for a module, then is its connection. Handlers hold it; once over_ is set they do nothing.
class DialInPort::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(asio::io_context& io, const std::string& number, DialInRegistry& registry, PortListener& listener)
      : io_(io), number_(number), registry_(registry), listener_(listener) {}

  void open(bool tell) {
    registry_.claim(number_, [weak = weak_from_this(), &io = io_](FileDescriptor socket) {
      asio::post(io, [weak, socket = std::make_shared<FileDescriptor>(std::move(socket))] {
        if (const auto self = weak.lock()) self->arrived(std::move(*socket));
      });
    });
    if (!tell) return;
    // Behind the module that waited already, if one did.
    asio::post(io_, [self = shared_from_this()] {
      if (!self->over_ && !self->connection_) self->fail("module " + self->number_ + " has not dialled in");
    });
  }

  [[nodiscard]] Connection* connection() { return connection_.get(); }

  void close() {
    if (std::exchange(over_, true)) return;
    registry_.release(number_);
    if (connection_) connection_->close();
  }

 private:
  void arrived(FileDescriptor fd) {
    if (over_ || connection_) {  // the next opening takes it; a new connection replaces the old one, which is dead as a rule
      registry_.release(number_);
      (void)registry_.offer(number_, std::move(fd));
      if (!over_) connection_->fail("the module dialled in anew");
      return;
    }
    auto socket = adopt(io_, std::move(fd));
    if (!socket) return;  // gone already: the module dials in again
    connection_ = std::make_shared<Connection>(std::move(*socket), listener_);
    if (!connection_->start()) return fail("the module is gone already");
    listener_.on_opened();
  }

  void fail(std::string reason) {
    close();
    listener_.on_closed(std::move(reason));
  }

  asio::io_context& io_;
  std::string number_;
  DialInRegistry& registry_;
  PortListener& listener_;
  std::shared_ptr<Connection> connection_;
  bool over_ = false;
};

DialInPort::DialInPort(asio::io_context& io, DialInPortSpec spec, DialInRegistry& registry)
    : io_(io), spec_(std::move(spec)), registry_(registry) {
  registry_.expect(spec_.number);
}

DialInPort::~DialInPort() {
  close();
  registry_.forget(spec_.number);
}

void DialInPort::open(PortListener& listener) {
  close();
  session_ = std::make_shared<Session>(io_, spec_.number, registry_, listener);
  session_->open(!std::exchange(told_, true));
}

void DialInPort::write(ByteView bytes) {
  if (session_ && session_->connection()) session_->connection()->write(bytes);
}

void DialInPort::poll() {
  if (session_ && session_->connection()) session_->connection()->poll();
}

FileDescriptor DialInPort::lend() {
  return session_ && session_->connection() ? session_->connection()->lend() : FileDescriptor{};
}

void DialInPort::take_back() {
  if (session_ && session_->connection()) session_->connection()->take_back();
}

void DialInPort::close() {
  if (session_) session_->close();
  session_.reset();
}

}  // namespace fieldcast
