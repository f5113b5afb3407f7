#include "bridge/program/module/module_client.hpp"

#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/post.hpp>

#include "bridge/port/stream.hpp"
#include "bridge/program/module/module_gate.hpp"
#include "core/base/message_text.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

constexpr std::chrono::seconds kConnectLimit{10};
// A refusal arrives within this time: the bridge waits half a second for an older connection.
constexpr std::chrono::seconds kRefusalWait{1};
constexpr std::size_t kMaxGreeting = 256;
constexpr std::string_view kChallenge = "challenge ", kRefused = "refused: ", kLineEnd = "\r\n";

}  // namespace

ModuleClient::ModuleClient(asio::io_context& io, ModuleOptions options, OpenLine open_line,
                           std::function<void(const std::string&)> say)
    : io_(io),
      options_(std::move(options)),
      open_line_(std::move(open_line)),
      say_(std::move(say)),
      resolver_(io),
      socket_(io),
      timer_(io) {}

void ModuleClient::start() { dial(); }

void ModuleClient::stop() {
  stopped_ = true;
  over("stopped");
}

void ModuleClient::dial() {
  resolver_.async_resolve(
      options_.host, std::to_string(options_.port),
      [self = shared_from_this()](boost::system::error_code fault,
                                  const tcp::resolver::results_type& found) {
        if (self->stopped_) return;
        if (fault) return self->over(fault.message());
        asio::async_connect(
            self->socket_, found, [self](boost::system::error_code refused, const tcp::endpoint&) {
              if (self->stopped_) return;
              if (refused) return self->over(refused.message());
              tune_socket(self->socket_.native_handle(), kTunnelPatience);
              if (!self->options_.tls)
                return self->connected(socket_stream(std::move(self->socket_)));
              auto tls = TlsClient::make(self->options_.authorities, self->options_.own);
              if (!tls) return self->over(tls.error());
              self->tls_ = *std::move(tls);
              self->tls_->shake_hands(std::move(self->socket_), self->options_.host, kConnectLimit,
                                      [self](TlsResult stream) {
                                        if (self->stopped_) return;
                                        stream ? self->connected(*std::move(stream))
                                               : self->over(stream.error());
                                      });
            });
      });
}

void ModuleClient::connected(std::unique_ptr<ByteStream> bridge) {
  bridge_ = std::make_shared<RelayEnd>(std::move(bridge));
  told_ = carried_ = false;
  greeting_.clear();
  const auto self = shared_from_this();
  bridge_->start(
      {[self](ByteView bytes) { self->from_bridge(bytes); },
       [self](const std::string& reason) { self->over("the bridge disconnected: " + reason); },
       [self](bool room) {
         if (self->line_) self->line_->pause(!room);
       }});
  if (options_.secret.empty()) tell_number("");
}

void ModuleClient::from_bridge(ByteView bytes) {
  if (!bridge_) return;
  if (carried_) return line_->send(bytes);
  greeting_ += as_text(bytes);
  const auto end = greeting_.find(kLineEnd);
  const std::string line = greeting_.substr(0, end);
  if (!told_) {
    if (end == std::string::npos) {
      if (greeting_.size() > kMaxGreeting) over("the bridge sends no challenge");
      return;
    }
    if (!line.starts_with(kChallenge)) return over("the bridge sends no challenge");
    greeting_.erase(0, end + kLineEnd.size());
    return tell_number(std::string_view(line).substr(kChallenge.size()));
  }
  // No request of a PLC's protocol begins like this.
  if (kRefused.starts_with(greeting_.substr(0, kRefused.size()))) {
    if (end != std::string::npos || greeting_.size() > kMaxGreeting) over(printable(line));
    return;
  }
  if (greeting_.starts_with(kChallenge)) return over("the bridge asks for a secret");
  carry();
}

void ModuleClient::tell_number(std::string_view challenge) {
  std::string text = options_.prefix + options_.number;
  if (!options_.secret.empty())
    text += ' ' + response_to(challenge, options_.number, options_.secret);
  text += kLineEnd;
  told_ = true;
  say_(fmt::format("connected to {}:{} as module {}", options_.host, options_.port,
                   options_.number));
  bridge_->send(as_bytes(text));
  timer_.expires_after(kRefusalWait);
  timer_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
    if (!cancelled && self->bridge_ && !self->carried_) self->carry();
  });
}

// Called when the first bytes for the line have arrived, or no refusal has.
void ModuleClient::carry() {
  timer_.cancel();
  auto line = open_line_();
  if (!line) return over(line.error());
  auto stream = descriptor_stream(io_, *std::move(line));
  if (!stream) return over("the line is of no use");
  const auto self = shared_from_this();
  line_ = std::make_shared<RelayEnd>(std::move(stream));
  carried_ = true;
  line_->start({[self](ByteView bytes) {
                  if (self->bridge_) self->bridge_->send(bytes);
                },
                [self](const std::string& reason) { self->over("the line closed: " + reason); },
                [self](bool room) {
                  if (self->bridge_) self->bridge_->pause(!room);
                }});
  line_->send(as_bytes(std::exchange(greeting_, {})));
}

// Ends the connection and starts again after a pause.
void ModuleClient::over(const std::string& reason) {
  say_(reason);
  resolver_.cancel();
  boost::system::error_code ignored;
  socket_.close(ignored);
  // Posted, because one of the two may be the caller.
  asio::post(io_, [bridge = std::exchange(bridge_, nullptr), line = std::exchange(line_, nullptr)] {
    for (const auto& end : {bridge, line}) {
      if (end) end->close();
    }
  });
  timer_.cancel();
  if (stopped_) return;
  timer_.expires_after(options_.again);
  timer_.async_wait([self = shared_from_this()](boost::system::error_code cancelled) {
    if (!cancelled && !self->stopped_) self->dial();
  });
}

}  // namespace fieldcast::program
