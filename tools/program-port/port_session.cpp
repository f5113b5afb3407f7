#include "tools/program-port/port_session.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/post.hpp>
#include <csignal>

#include "bridge/base/clock.hpp"
#include "bridge/port/serial_line.hpp"
#include "bridge/port/stream.hpp"

namespace fieldcast::port {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using program::PortClient;
using program::PortEnd;

constexpr std::chrono::seconds kConnectLimit{10};
// Interval of checks of the virtual port's settings, in addition to checks when bytes arrive.
constexpr std::chrono::milliseconds kCheckPeriod{100};
constexpr unsigned kChecksOfReport = 10;  // a traffic line each second
// Timeout between bytes at the end: a bridge with a slow line accepts the last bytes in steps.
constexpr std::chrono::seconds kFlushBridge{10};
constexpr std::chrono::seconds kFlushProgram{1};

// A rate that no program uses, so that every change is detected, even to the default 38400.
constexpr std::uint32_t kNobodysRate = 38401;

std::optional<program::LineSettings> untouched(int fd) {
  (void)change_line(fd, {kNobodysRate, 8, Parity::kNone, 1});
  return rate_of(fd);
}

}  // namespace

PortSession::PortSession(asio::io_context& io, PortOptions options, sim::PtyPort pty,
                         PortReport& report)
    : io_(io),
      options_(std::move(options)),
      pty_(std::move(pty)),
      report_(report),
      client_(options_.rules),
      resolver_(io),
      socket_(io),
      signals_(io, SIGINT, SIGTERM, SIGHUP),
      timer_(io),
      ticking_(io),
      limit_(io),
      settings_(untouched(pty_.fd())) {}

void PortSession::start() {
  signals_.async_wait([this](boost::system::error_code fault, int) {
    if (fault) return;
    if (client_.paired()) return tell(PortClient::StopAsked{});
    end_ = {PortEnd::Kind::kStopped, {}, "stopped"};
    wind_up();
  });
  limit_.expires_after(kConnectLimit);
  limit_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled) cannot_connect("no connection in time");
  });
  connect();
}

void PortSession::connect() {
  report_.state("connecting",
                fmt::format("connecting to {}:{}", options_.host, options_.server_port));
  resolver_.async_resolve(
      options_.host, std::to_string(options_.server_port),
      [this](boost::system::error_code fault, tcp::resolver::results_type found) {
        if (over_) return;
        if (fault) return cannot_connect(fault.message());
        asio::async_connect(
            socket_, found, [this](boost::system::error_code refused, const tcp::endpoint&) {
              if (over_) return;
              if (refused) return cannot_connect(refused.message());
              tune_socket(socket_.native_handle(), program::kTunnelPatience);
              if (!options_.tls) return connected(socket_stream(std::move(socket_)));
              auto tls = TlsClient::make(options_.authorities, options_.own);
              if (!tls) return cannot_connect(tls.error());
              tls_ = std::move(*tls);
              tls_->shake_hands(
                  std::move(socket_), options_.host, kConnectLimit, [this](TlsResult stream) {
                    if (over_) return;
                    stream ? connected(std::move(*stream)) : cannot_connect(stream.error());
                  });
            });
      });
}

void PortSession::cannot_connect(const std::string& reason) {
  end_ = {PortEnd::Kind::kBridgeGone,
          {},
          fmt::format("{}:{}: {}", options_.host, options_.server_port, reason)};
  wind_up();
}

void PortSession::connected(std::unique_ptr<ByteStream> stream) {
  limit_.cancel();
  bridge_ = std::make_shared<program::RelayEnd>(std::move(stream));
  bridge_->start({[this](ByteView bytes) { tell(PortClient::FromBridge{bytes}); },
                  [this](const std::string& reason) { tell(PortClient::BridgeGone{reason}); },
                  [this](bool room) {
                    if (terminal_) terminal_->pause(!room);
                  }});
  report_.state("asking", "connected, asking for device " + options_.rules.number);
  tell(PortClient::Connected{});
}

void PortSession::tell(const PortClient::Event& event) {
  if (over_) return;
  PortClient::Actions actions;
  client_.on_event(event, steady_now(), actions);
  for (const auto& action : actions) {
    std::visit([&](const auto& what) { execute(what); }, action);
  }
}

void PortSession::execute(const PortClient::ToBridge& what) { bridge_->send(what.bytes); }

void PortSession::execute(const PortClient::ToProgram& what) {
  if (terminal_) terminal_->send(what.bytes);
}

void PortSession::execute(const PortClient::SetTimer& what) {
  timer_.cancel();
  if (what.at == kNever) return;
  timer_.expires_at(std::chrono::steady_clock::time_point{what.at.time_since_epoch()});
  timer_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled) tell(PortClient::TimerFired{});
  });
}

void PortSession::execute(const PortClient::Paired&) {
  report_.paired(steady_now());
  report_.state("paired", "paired; the programming software may open the port");
  open_terminal();
  // Actions of the same event contain bytes for the terminal, which must be open by then.
  asio::post(io_, [this] {
    if (!over_) tick();
  });
}

void PortSession::open_terminal() {
  auto stream = descriptor_stream(io_, FileDescriptor(::fcntl(pty_.fd(), F_DUPFD_CLOEXEC, 0)));
  terminal_ = std::make_shared<program::RelayEnd>(std::move(stream));
  terminal_->start(
      {[this](ByteView bytes) {
         check_line();
         tell(PortClient::FromProgram{bytes});
       },
       [this](const std::string& reason) {
         end_ = {PortEnd::Kind::kProtocol, {}, "the virtual port was removed: " + reason};
         tell(PortClient::StopAsked{});
       },
       [this](bool room) {
         bridge_->pause(!room);
         tell(PortClient::ProgramTakes{room});
       }});
}

// Called before bytes under new settings, and periodically, because a program may only listen.
void PortSession::check_line() {
  const auto now = rate_of(pty_.fd());
  if (!now || now == settings_) return;
  settings_ = now;
  report_.line(now->baud,
               options_.rules.format ? options_.rules.format->stop_bits : now->stop_bits);
  tell(PortClient::LineChanged{*now});
}

void PortSession::tick() {
  check_line();
  if (++ticks_ % kChecksOfReport == 0)
    report_.traffic(client_.bytes_to_device(), client_.bytes_from_device(), steady_now(), false);
  report_.show_traffic(client_.bytes_to_device(), client_.bytes_from_device(), bridge_->unsent(),
                       steady_now());
  ticking_.expires_after(kCheckPeriod);
  ticking_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled && !over_) tick();
  });
}

void PortSession::execute(const PortClient::Dropped& what) { report_.dropped(what.text); }

void PortSession::execute(const PortClient::Finish& what) {
  end_ = what.end;
  if (terminal_)
    report_.traffic(client_.bytes_to_device(), client_.bytes_from_device(), steady_now(), true);
  wind_up();
}

// Sends the rest while there is progress; then the io_context ends. A second signal ends it
// immediately.
void PortSession::wind_up() {
  if (std::exchange(over_, true)) return;
  report_.state("ended", end_.text);
  resolver_.cancel();
  boost::system::error_code ignored;
  socket_.close(ignored);
  signals_.cancel();
  timer_.cancel();
  ticking_.cancel();
  limit_.cancel();
  signals_.async_wait([this](boost::system::error_code fault, int) {
    for (const auto& side : {bridge_, terminal_}) {
      if (side && !fault) side->close();
    }
  });
  const auto left = std::make_shared<int>(0);
  for (const auto& side : {bridge_, terminal_}) *left += side ? 1 : 0;
  if (*left == 0) signals_.cancel();
  for (const auto& side : {bridge_, terminal_}) {
    if (!side) continue;
    side->finish(program::RelayEnd::Until::kTaken, [this, left] {
      if (--*left == 0) signals_.cancel();
    });
  }
  flush(steady_now(), steady_now());
}

void PortSession::flush(Instant bridge_moved, Instant program_moved) {
  const Instant now = steady_now();
  bool more = false;
  const auto settle = [&](const auto& side, Instant& moved, Duration limit) {
    if (!side || side->settle()) return;
    if (side->drained()) moved = now;
    now - moved < limit ? void(more = true) : side->close();
  };
  settle(bridge_, bridge_moved, kFlushBridge);
  settle(terminal_, program_moved, kFlushProgram);
  if (!more) return;
  limit_.expires_after(kCheckPeriod);
  limit_.async_wait([this, bridge_moved, program_moved](boost::system::error_code cancelled) {
    if (cancelled) return;
    tell_last_bytes();
    flush(bridge_moved, program_moved);
  });
}

void PortSession::tell_last_bytes() {
  const std::size_t left = bridge_ ? bridge_->unsent() : 0;
  if (left == 0) return;
  if (last_bytes_ == 0) {
    last_bytes_ = left;
    report_.state("last-bytes", fmt::format("{} bytes still wait for the bridge, which has to take "
                                            "some within {} s; a second Ctrl-C drops them",
                                            left, kFlushBridge.count()));
  }
  report_.show_last_bytes(1 - static_cast<double>(left) / static_cast<double>(last_bytes_));
}

}  // namespace fieldcast::port
