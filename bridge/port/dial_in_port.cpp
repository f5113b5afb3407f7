#include "bridge/port/dial_in_port.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "bridge/port/connection.hpp"

namespace fieldcast {

namespace asio = boost::asio;

// One opening of the port: waits for a module, then is its connection. Handlers hold it; once over_
// is set they do nothing.
class DialInPort::Session : public std::enable_shared_from_this<Session> {
 public:
  Session(asio::io_context& io, const std::string& number, DialInRegistry& registry,
          PortListener& listener)
      : io_(io), number_(number), registry_(registry), listener_(listener) {}

  void open(bool tell) {
    claim_ = registry_.claim(number_, [self = shared_from_this()](FileDescriptor socket) {
      asio::post(self->io_, [self, socket = std::make_shared<FileDescriptor>(std::move(socket))] {
        self->arrived(std::move(*socket));
      });
    });
    if (!tell) return;
    // Behind the module that waited already, if one did.
    asio::post(io_, [self = shared_from_this()] {
      if (!self->over_ && !self->connection_)
        self->fail("module " + self->number_ + " has not dialled in");
    });
  }

  [[nodiscard]] Connection* connection() { return connection_.get(); }

  void close() {
    if (std::exchange(over_, true)) return;
    registry_.release(number_, claim_);
    if (connection_) connection_->close();
  }

  // The connection goes on without this port.
  void retire() {
    FileDescriptor socket = !over_ && connection_ ? connection_->release() : FileDescriptor{};
    close();
    if (socket.valid()) registry_.pass_on(number_, std::move(socket));
  }

 private:
  void arrived(FileDescriptor fd) {
    if (over_ || connection_) {  // the next opening takes it; a new connection replaces the old
                                 // one, which is dead as a rule
      registry_.release(number_, claim_);
      if (auto ours = registry_.offer(number_, std::move(fd)))
        registry_.pass_on(number_, std::move(*ours));
      if (!over_) connection_->fail("the module dialled in anew");
      return;
    }
    auto socket = adopt_socket(io_, std::move(fd));
    if (!socket) return;  // gone already: the module dials in again
    connection_ = std::make_shared<Connection>(std::move(*socket), listener_);
    if (!connection_->start()) return fail("the module is gone already");
    listener_.on_opened();
  }

  void fail(std::string reason) {
    close();
    listener_.on_closed(std::move(reason), Cause::kPortUnreachable);
  }

  asio::io_context& io_;
  std::string number_;
  DialInRegistry& registry_;
  PortListener& listener_;
  std::shared_ptr<Connection> connection_;
  DialInRegistry::Ticket claim_ = 0;
  bool over_ = false;
};

DialInPort::DialInPort(asio::io_context& io, DialInPortSpec spec, DialInRegistry& registry)
    : io_(io),
      spec_(std::move(spec)),
      registry_(registry),
      expectation_(registry_.expect(spec_.number)) {}

DialInPort::~DialInPort() {
  close();
  registry_.forget(spec_.number, expectation_);
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

void DialInPort::retire() {
  if (session_) session_->retire();
  session_.reset();
}

void DialInPort::close() {
  if (session_) session_->close();
  session_.reset();
}

}  // namespace fieldcast
