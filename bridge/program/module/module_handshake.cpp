#include "bridge/program/module/module_handshake.hpp"

#include <fmt/format.h>

#include <boost/asio/io_context.hpp>

#include "bridge/base/clock.hpp"
#include "bridge/port/stream.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

constexpr Duration kSecondCheck = std::chrono::milliseconds{50};

}  // namespace

ModuleServer::Handshake::Handshake(ModuleServer& server, std::shared_ptr<ModuleGate> gate,
                                   tcp::socket socket, std::string address)
    : server_(server),
      gate_(std::move(gate)),
      second_(server.spec_.second),
      socket_(std::move(socket)),
      timer_(server.io_),
      registration_(server.spec_.registration, gate_->challenge()),
      limit_(server.spec_.registration.timeout),
      address_(std::move(address)) {}

void ModuleServer::Handshake::start() {
  boost::system::error_code ignored;
  socket_.non_blocking(true, ignored);
  tune_socket(socket_.native_handle());
  if (gate_->tls() == nullptr) return ask();
  const int descriptor = socket_.native_handle();
  cut_handshake_ = gate_->tls()->shake_hands(
      std::move(socket_), limit_, [self = shared_from_this(), descriptor](TlsResult stream) {
        self->cut_handshake_ = {};
        if (!self->over_) self->secured(std::move(stream), descriptor);
      });
}

void ModuleServer::Handshake::close() {
  over_ = true;
  timer_.cancel();
  boost::system::error_code ignored;
  socket_.close(ignored);
  if (const auto cut = std::exchange(cut_handshake_, {})) cut();
}

// From here on a pipe connects TLS to the socket that a bus gets.
void ModuleServer::Handshake::secured(TlsResult stream, int descriptor) {
  if (!stream) return end(stream.error());
  common_name_ = (*stream)->peer_name();
  const auto pipe = std::make_shared<TlsPipe>(server_.io_, std::move(*stream), descriptor);
  auto plain = pipe->start([&server = server_, weak = std::weak_ptr(pipe)] {
    if (const auto over = weak.lock()) server.pipes_.erase(over);
  });
  auto adopted = adopt_socket(server_.io_, std::move(plain));
  if (!adopted) {
    pipe->close();
    return end("no descriptor is left for it");
  }
  server_.pipes_.insert(pipe);
  socket_ = std::move(*adopted);
  ask();
}

void ModuleServer::Handshake::ask() {
  follow(registration_.start(steady_now()));
  read();
}

void ModuleServer::Handshake::read() {
  if (over_) return;
  socket_.async_read_some(asio::buffer(buffer_), [self = shared_from_this()](
                                                     boost::system::error_code fault,
                                                     std::size_t count) {
    if (self->over_) return;
    if (fault) return self->end("the module disconnected before it sent its number");
    self->follow(self->registration_.on_bytes(ByteView(self->buffer_.data(), count), steady_now()));
    if (!self->number_known_) self->read();
  });
}

bool ModuleServer::Handshake::send(ByteView bytes) {
  return ::send(socket_.native_handle(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
         static_cast<ssize_t>(bytes.size());
}

void ModuleServer::Handshake::follow(Registration::Outcome outcome) {
  if (!outcome.send.empty() && !send(outcome.send)) return end("the module takes no request");
  if (outcome.fault) return gate_->asks() ? refuse(*outcome.fault) : end(*outcome.fault);
  if (outcome.number) return numbered(*outcome.number);
  timer_.expires_at(std::chrono::steady_clock::time_point{outcome.wake.time_since_epoch()});
  timer_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
    if (!cancelled && !self->over_) self->follow(self->registration_.on_timer(steady_now()));
  });
}

void ModuleServer::Handshake::numbered(const std::string& number) {
  number_known_ = true;
  if (const std::string fault = gate_->fault_of(common_name_, number); !fault.empty())
    return refuse(fault);
  wait_for_other(number, steady_now() + kSecondWait);
}

void ModuleServer::Handshake::wait_for_other(const std::string& number, Instant until) {
  if (second_ == SecondModule::kReplace || !server_.connected(number)) {
    leave();
    return server_.registered(number, std::move(socket_), address_);
  }
  if (steady_now() >= until) {
    return refuse(
        fmt::format("module {} is connected already; 'second: replace' would let a new "
                    "connection take its place",
                    number));
  }
  timer_.expires_after(kSecondCheck);
  timer_.async_wait(
      [self = shared_from_this(), number, until](boost::system::error_code cancelled) {
        if (!cancelled && !self->over_) self->wait_for_other(number, until);
      });
}

void ModuleServer::Handshake::refuse(const std::string& reason) {
  (void)send(as_bytes("refused: " + reason + "\r\n"));
  end(reason);
}

void ModuleServer::Handshake::end(const std::string& reason) {
  const auto self = shared_from_this();
  close();
  leave();
  server_.refused(address_, reason);
}

void ModuleServer::Handshake::leave() {
  over_ = true;
  timer_.cancel();
  const auto self = shared_from_this();
  server_.silent_.remove(id);
  server_.arrivals_.erase(self);
}

}  // namespace fieldcast::program
