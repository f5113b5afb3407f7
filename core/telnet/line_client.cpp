#include "core/telnet/line_client.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::telnet {
namespace {

std::string value_text(Kind kind, std::uint32_t value) {
  constexpr std::string_view kParityNames[] = {"unknown", "none", "odd", "even", "mark", "space"};
  if (kind == Kind::kParity)
    return std::string(kParityNames[value < std::size(kParityNames) ? value : 0]);
  if (kind == Kind::kStopBits && value == 3) return "1.5";
  return std::to_string(value);
}

}  // namespace

LineClient::LineClient(const LineFormat& line, Instant now, Bytes& to_server)
    : line_(line), deadline_(now + kLimit) {
  for (const End end : {End::kHere, End::kThere}) {
    options_.request(kBinary, end, to_server);
    options_.request(kSuppressGoAhead, end, to_server);
  }
  options_.request(kComPort, End::kHere, to_server);
}

Instant LineClient::deadline() const {
  return state_ < State::kOpen || !awaited_.empty() ? deadline_ : kNever;
}

void LineClient::on_bytes(ByteView received, Bytes& data, Bytes& to_server) {
  while (state_ != State::kFailed) {
    const auto item = parser_.next(received);
    if (!item) return;
    if (const auto* bytes = std::get_if<Data>(&*item)) {
      if (open()) append(data, bytes->bytes);
    } else if (const auto* request = std::get_if<OptionRequest>(&*item)) {
      options_.on_request(*request, to_server);
      on_options(to_server);
    } else {
      const auto& sub = std::get<Subnegotiation>(*item);
      const auto message = sub.option == kComPort ? message_from(sub.bytes) : std::nullopt;
      if (message && message->from == From::kServer) on_message(*message, to_server);
    }
  }
}

void LineClient::on_options(Bytes& to_server) {
  if (!com_port() && options_.refused(kComPort, End::kHere))
    return fail("the server refuses COM-PORT-OPTION (RFC 2217); use 'tcp' for raw bytes");
  if (options_.refused(kBinary, End::kHere) || options_.refused(kBinary, End::kThere))
    return fail("the server refuses BINARY, so it would change bytes of the line");
  const bool binary =
      options_.enabled(kBinary, End::kHere) && options_.enabled(kBinary, End::kThere);
  if (state_ == State::kNegotiating && com_port() && binary) set_line(to_server);
}

// Some servers enable the option at their end too.
bool LineClient::com_port() const {
  return options_.enabled(kComPort, End::kHere) || options_.enabled(kComPort, End::kThere);
}

void LineClient::set_line(Bytes& to_server) {
  state_ = State::kSetting;
  const auto send = [&](Kind kind, auto value) {
    append_message(to_server, {From::kClient, kind, static_cast<std::uint32_t>(value)});
  };
  for (const Kind kind : kSettings) send(kind, value_of(kind, line_));
  // As open(2) of a serial port: no flow control, modem lines on, no stale bytes.
  for (const Control control : {Control::kNoFlow, Control::kDtrOn, Control::kRtsOn})
    send(Kind::kControl, control);
  send(Kind::kLineStateMask, 0);
  send(Kind::kModemStateMask, 0);
  send(Kind::kPurge, 3);
}

void LineClient::on_message(const Message& message, Bytes& to_server) {
  switch (message.kind) {
    case Kind::kBaud:
    case Kind::kDataBits:
    case Kind::kParity:
    case Kind::kStopBits: return changes_ ? on_changed(message) : on_setting(message);
    case Kind::kControl:
    case Kind::kPurge: return on_changed(message);
    case Kind::kSuspend: suspended_ = true; return;
    case Kind::kResume: suspended_ = false; return;
    case Kind::kSignature:
      if (message.text.empty())
        append_message(to_server, {From::kClient, Kind::kSignature, 0, "Fieldcast"});
      return;
    default: return;
  }
}

// Also a change by others: then the bus could no longer reach its devices.
void LineClient::on_setting(const Message& message) {
  if (state_ == State::kNegotiating) return;
  const std::uint32_t wanted = value_of(message.kind, line_);
  if (message.value != wanted)
    return fail("the server reports " + std::string(to_text(message.kind)) + ' ' +
                value_text(message.kind, message.value) + ", configured is " +
                value_text(message.kind, wanted));
  confirmed_[static_cast<std::size_t>(message.kind) - 1] = true;
  if (std::ranges::find(confirmed_, false) == confirmed_.end()) state_ = State::kOpen;
}

void LineClient::change(const LineChange& change, Instant now, Bytes& to_server) {
  changes_ = true;
  if (awaited_.size() == kMaxAwaited) return changed_.push_back({change});
  append_message(to_server, {From::kClient, change.kind, change.value});
  awaited_.push_back(change);
  deadline_ = now + kLimit;
}

void LineClient::on_changed(const Message& message) {
  const auto change = std::ranges::find(awaited_, message.kind, &LineChange::kind);
  if (change == awaited_.end()) return;
  const bool setting = std::ranges::find(kSettings, message.kind) != std::end(kSettings);
  const bool done = message.value == change->value || message.kind == Kind::kPurge;
  changed_.push_back({*change});
  if (setting || done) changed_.back().in_force = setting ? message.value : change->value;
  awaited_.erase(change);
}

void LineClient::on_time(Instant now) {
  if (now < deadline()) return;
  if (open()) {
    for (const LineChange& change : std::exchange(awaited_, {})) changed_.push_back({change});
    return;
  }
  std::string missing = "agreed on BINARY";
  if (state_ == State::kSetting) {
    const auto at = std::ranges::find(confirmed_, false) - confirmed_.begin();
    missing = "confirmed the " + std::string(to_text(kSettings[at]));
  } else if (!com_port()) {
    missing = "agreed on COM-PORT-OPTION (RFC 2217)";
  }
  fail("the server has not " + missing + " within " + fieldcast::to_text(kLimit));
}

void LineClient::fail(std::string fault) {
  state_ = State::kFailed;
  fault_ = std::move(fault);
}

}  // namespace fieldcast::telnet
