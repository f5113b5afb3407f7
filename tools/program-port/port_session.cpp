#include "tools/program-port/port_session.hpp"

#include <fmt/format.h>

#include <boost/asio/post.hpp>

#include "bridge/base/clock.hpp"

namespace fieldcast::port {
namespace {

namespace asio = boost::asio;
using program::PortClient;
using program::PortEnd;

// Interval of checks of the local port's settings, in addition to checks when bytes arrive.
constexpr std::chrono::milliseconds kCheckPeriod{100};
constexpr unsigned kChecksOfReport = 10;  // a traffic line each second
// Timeout between bytes at the end: a bridge with a slow line accepts the last bytes in steps.
constexpr std::chrono::seconds kFlushBridge{10};
constexpr std::chrono::seconds kFlushProgram{1};

}  // namespace

PortSession::PortSession(asio::io_context& io, PortOptions options, std::unique_ptr<LocalPort> port,
                         PortReport& report)
    : io_(io),
      options_(std::move(options)),
      port_(std::move(port)),
      report_(report),
      client_(options_.rules),
      dialer_(io, options_.bridge),
      stops_(io, [this] { stop(); }),
      timer_(io),
      ticking_(io),
      limit_(io),
      untouched_(port_->settings()) {}

void PortSession::start() { connect(); }

// The first request ends the session, the second one drops the bytes that are not sent yet.
void PortSession::stop() {
  if (over_) {
    for (const auto& side : {bridge_, terminal_}) {
      if (side) side->close();
    }
    return;
  }
  if (client_.paired()) return tell(PortClient::StopAsked{});
  end_ = {PortEnd::Kind::kStopped, {}, "stopped"};
  wind_up();
}

void PortSession::connect() {
  client_ = PortClient(options_.rules);
  report_.state("connecting",
                fmt::format("connecting to {}:{}", options_.bridge.host, options_.bridge.port));
  dialer_.dial([this](TlsResult stream) {
    if (stream) return connected(std::move(*stream));
    ended({PortEnd::Kind::kBridgeGone, {}, stream.error()});
  });
}

void PortSession::connected(std::unique_ptr<ByteStream> stream) {
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
  reconnection_.paired(steady_now());
  report_.paired(steady_now());
  report_.state("paired", fmt::format("paired; {}", kLocalPortOption.ready));
  if (const std::string slow = program::slow_path_text(dialer_.round_trip()); !slow.empty())
    report_.state("slow", slow);
  settings_ = untouched_;
  paired_ = true;
  if (!terminal_) open_terminal();
  // Actions of the same event contain bytes for the terminal, which must be open by then.
  asio::post(io_, [this] {
    if (over_ || !client_.paired()) return;
    if (terminal_ && terminal_->crowded()) tell(PortClient::ProgramTakes{false});
    tick();
  });
}

void PortSession::open_terminal() {
  auto stream = port_->stream(io_);
  if (!stream) return lost_port("it cannot be read");
  terminal_ = std::make_shared<program::RelayEnd>(std::move(stream));
  terminal_->start({[this](ByteView bytes) {
                      if (std::exchange(awaits_program_, false)) return connect();
                      reconnection_.program_sent(steady_now());
                      check_line();
                      tell(PortClient::FromProgram{bytes});
                    },
                    [this](const std::string& reason) { lost_port(reason); },
                    [this](bool room) {
                      if (bridge_) bridge_->pause(!room);
                      tell(PortClient::ProgramTakes{room});
                    }});
}

void PortSession::lost_port(const std::string& reason) {
  if (over_) return;
  lost_ = {PortEnd::Kind::kProtocol, {}, "the serial port was closed: " + reason};
  if (client_.paired()) return tell(PortClient::StopAsked{});
  end_ = *lost_;
  wind_up();
}

// Called before bytes under new settings, and periodically, because a program may only listen.
void PortSession::check_line() {
  const auto now = port_->settings();
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
  report_.show_traffic(client_.bytes_to_device(), client_.bytes_from_device(),
                       bridge_ ? bridge_->unsent() : 0, steady_now());
  ticking_.expires_after(kCheckPeriod);
  ticking_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled && !over_) tick();
  });
}

void PortSession::execute(const PortClient::Dropped& what) { report_.dropped(what.text); }

void PortSession::execute(const PortClient::Finish& what) {
  if (std::exchange(paired_, false))
    report_.traffic(client_.bytes_to_device(), client_.bytes_from_device(), steady_now(), true);
  ended(lost_ ? *lost_ : what.end);
}

void PortSession::ended(const PortEnd& end) {
  end_ = end;
  const auto next = options_.reconnect ? reconnection_.ended(end, steady_now())
                                       : std::optional<program::Reconnection::Next>{};
  next ? connect_later(*next) : wind_up();
}

// Bytes that the software sends in between are dropped: a PLC cannot use half of a request.
void PortSession::connect_later(const program::Reconnection::Next& next) {
  const std::string when =
      next.when_program_sends ? "when the software sends" : "in " + to_text(next.pause);
  report_.state("waiting", fmt::format("{}; connects again {}", end_.text, when));
  dialer_.cancel();
  timer_.cancel();
  ticking_.cancel();
  // Later, because a handler of this end may be running.
  asio::post(io_, [bridge = std::exchange(bridge_, nullptr)] {
    if (bridge) bridge->close();
  });
  if (terminal_) terminal_->pause(false);
  awaits_program_ = next.when_program_sends;
  if (awaits_program_) return;
  limit_.expires_after(next.pause);
  limit_.async_wait([this](boost::system::error_code cancelled) {
    if (!cancelled && !over_) connect();
  });
}

// Sends the rest while there is progress; then the io_context ends. A second signal ends it
// immediately.
void PortSession::wind_up() {
  if (std::exchange(over_, true)) return;
  report_.state("ended", end_.text);
  dialer_.cancel();
  timer_.cancel();
  ticking_.cancel();
  limit_.cancel();
  const auto left = std::make_shared<int>(0);
  for (const auto& side : {bridge_, terminal_}) *left += side ? 1 : 0;
  if (*left == 0) stops_.cancel();
  for (const auto& side : {bridge_, terminal_}) {
    if (!side) continue;
    side->finish(program::RelayEnd::Until::kTaken, [this, left] {
      if (--*left == 0) stops_.cancel();
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
