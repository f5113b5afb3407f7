#include "bridge/port/dial_in_port.hpp"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "bridge/port/socket_stream.hpp"

namespace fieldcast {

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
