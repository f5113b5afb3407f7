#include "bridge/port/stream_port.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/post.hpp>

#include "bridge/port/stream.hpp"
#include "bridge/port/tcp_opening.hpp"

namespace fieldcast {

void PortOpening::close() {
  if (std::exchange(over_, true)) return;
  cancel();
  if (stream_) stream_->close();
}

void PortOpening::opened(std::shared_ptr<Stream> stream) {
  stream_ = std::move(stream);
  stream_->start();
  listener_.on_opened();
}

void PortOpening::fail(std::string reason, Cause cause) {
  close();
  listener_.on_closed(std::move(reason), cause);
}

void StreamPort::open(PortListener& listener) {
  close();
  opening_ = make_opening(listener);
  opening_->begin();
}

void StreamPort::write_more(ByteView bytes) {
  if (Stream* line = stream()) line->write_more(bytes);
}

void StreamPort::write(ByteView bytes) {
  if (Stream* line = stream()) line->write(bytes);
}

void StreamPort::poll() {
  if (Stream* line = stream()) line->poll();
}

bool StreamPort::wait(Instant until, int wake) {
  Stream* line = stream();
  return line != nullptr && line->wait(until, wake);
}

void StreamPort::watch() {
  if (Stream* line = stream()) line->watch();
}

FileDescriptor StreamPort::lease() {
  Stream* line = stream();
  return line ? line->lease() : FileDescriptor{};
}

void StreamPort::end_lease() {
  if (Stream* line = stream()) line->end_lease();
}

void StreamPort::close() {
  if (opening_) opening_->close();
  opening_.reset();
}

namespace {

namespace asio = boost::asio;

class TcpStreamOpening final : public TcpOpening {
 public:
  TcpStreamOpening(asio::io_context& io, const TcpPortSpec& spec, PortListener& listener)
      : TcpOpening(io, listener,
                   {spec.host, spec.port, spec.connect_timeout, spec.fence.is(Fence::kOneClient),
                    spec.tls, spec.certified_name()}) {}

 private:
  void connected(FileDescriptor socket, std::unique_ptr<TlsEngine> tls) override {
    auto stream = make_socket_stream(io_, std::move(socket), listener_,
                                     target().one_client ? Clients::kOne : Clients::kMany);
    if (!stream) return give_up("the connection is closed already");
    if (tls) stream->use(std::move(tls));
    opened(std::move(stream));
  }
};

// Resolves the name; the socket then has no peer that could refuse it.
class UdpOpening final : public PortOpening {
 public:
  UdpOpening(asio::io_context& io, const TcpPortSpec& spec, PortListener& listener)
      : PortOpening(io, listener), spec_(spec), names_(io) {}

  void begin() override {
    names_.start(spec_.host, [self = self_as<UdpOpening>()](const NameLookup::Found& found) {
      if (self->over_) return;
      if (!found) return self->fail(found.error(), Cause::kPortUnreachable);
      self->connect({found->front(), self->spec_.port});
    });
  }

 private:
  void connect(const asio::ip::udp::endpoint& peer) {
    const int kind = SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC;
    FileDescriptor socket(::socket(peer.protocol().family(), kind, 0));
    if (!socket || ::connect(socket.get(), peer.data(), static_cast<socklen_t>(peer.size())) != 0)
      return fail(errno_text(errno), Cause::kPortUnreachable);
    auto stream = std::make_shared<DatagramStream>(io_, listener_);
    if (!stream->assign(std::move(socket)))
      return fail("the socket is not usable", Cause::kPortUnreachable);
    opened(std::move(stream));
  }

  void cancel() override { names_.cancel(); }

  TcpPortSpec spec_;
  NameLookup names_;
};

}  // namespace

std::shared_ptr<PortOpening> TcpPort::make_opening(PortListener& listener) {
  if (spec_.datagrams) return std::make_shared<UdpOpening>(io_, spec_, listener);
  return std::make_shared<TcpStreamOpening>(io_, spec_, listener);
}

namespace asio = boost::asio;

// Waits for a module, then is its connection.
class DialInPort::Opening final : public PortOpening {
 public:
  // `tell`: fail immediately if no module is connected.
  Opening(asio::io_context& io, const std::string& number, DialInRegistry& registry,
          PortListener& listener, bool tell)
      : PortOpening(io, listener), number_(number), registry_(registry), tell_(tell) {}

  void begin() override {
    claim_ = registry_.claim(number_, [self = self_as<Opening>()](ModuleConnection connection) {
      asio::post(self->io_,
                 [self, came = std::make_shared<ModuleConnection>(std::move(connection))] {
                   self->arrived(std::move(*came));
                 });
    });
    if (!tell_) return;
    // Posted after the delivery of a module that already waited.
    asio::post(io_, [self = self_as<Opening>()] {
      if (!self->over_ && self->stream() == nullptr)
        self->fail(fmt::format("module {} has not dialled in", self->number_),
                   Cause::kPortUnreachable);
    });
  }

  // Ends the port and keeps the connection for the next bus.
  void retire() {
    FileDescriptor socket = !over_ && stream() ? stream()->release() : FileDescriptor{};
    auto presence = stream() ? stream()->detach() : nullptr;
    close();
    if (socket.valid())
      registry_.pass_on(number_, {std::move(socket), arrival_, std::move(presence)});
  }

 private:
  void arrived(ModuleConnection connection) {
    if (over_ || stream() != nullptr) return pass_on(std::move(connection));
    auto line = make_socket_stream(io_, std::move(connection.socket), listener_);
    if (!line) return;  // disconnected: the module dials in again
    arrival_ = connection.arrival;
    line->attach(std::move(connection.presence));
    opened(std::move(line));
  }

  // Returns the connection to the registry. It replaces the old one, which is usually dead.
  void pass_on(ModuleConnection connection) {
    registry_.release(number_, claim_);
    registry_.pass_on(number_, std::move(connection));
    if (!over_) stream()->fail({"the module connected again"});
  }

  void cancel() override { registry_.release(number_, claim_); }

  std::string number_;
  DialInRegistry& registry_;
  DialInRegistry::Id claim_ = 0;
  std::uint64_t arrival_ = 0;
  bool tell_;
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

std::shared_ptr<PortOpening> DialInPort::make_opening(PortListener& listener) {
  const bool tell = !std::exchange(told_, true);
  return std::make_shared<Opening>(io_, spec_.number, registry_, listener, tell);
}

void DialInPort::retire() {
  if (opening_) static_cast<Opening&>(*opening_).retire();
  opening_.reset();
}

}  // namespace fieldcast
