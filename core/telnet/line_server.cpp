#include "core/telnet/line_server.hpp"

#include <utility>

namespace fieldcast::telnet {
namespace {

// Flow, break, DTR, RTS: each has a request and then its values.
std::size_t group_of(std::uint32_t control) {
  return control <= 3 ? 0u : (static_cast<std::size_t>(control) - 1) / 3;
}

}  // namespace

LineServer::LineServer(Bytes& to_client) {
  options_.request(kComPort, End::kThere, to_client);
  options_.request(kSuppressGoAhead, End::kHere, to_client);
  for (const End end : {End::kHere, End::kThere}) options_.request(kBinary, end, to_client);
}

bool LineServer::com_port() const {
  return options_.enabled(kComPort, End::kThere) || options_.enabled(kComPort, End::kHere);
}

void LineServer::on_bytes(ByteView received, LineActions& actions, Bytes& to_client) {
  while (const auto item = parser_.next(received)) {
    if (const auto* data = std::get_if<Data>(&*item)) {
      const bool joined = !actions.empty() && std::holds_alternative<LineData>(actions.back());
      if (!joined) actions.emplace_back(LineData{});
      append(std::get<LineData>(actions.back()).bytes, data->bytes);
    } else if (const auto* request = std::get_if<OptionRequest>(&*item)) {
      options_.on_request(*request, to_client);
    } else {
      const auto& sub = std::get<Subnegotiation>(*item);
      const auto message = sub.option == kComPort ? message_from(sub.bytes) : std::nullopt;
      if (message && message->from == From::kClient) on_message(*message, actions, to_client);
    }
  }
}

void LineServer::on_message(const Message& message, LineActions& actions, Bytes& to_client) {
  const std::uint32_t value = message.value;
  const auto mask = static_cast<std::uint8_t>(value);
  switch (message.kind) {
    case Kind::kSignature:
      return append_message(to_client, {From::kServer, Kind::kSignature, 0, "Fieldcast"});
    case Kind::kBaud: one_byte_ = message.one_byte; [[fallthrough]];
    case Kind::kDataBits:
    case Kind::kParity:
    case Kind::kStopBits: {
      LineFormat wanted = line_;
      if (!set_value(wanted, message.kind, value))  // a request, or an impossible value
        return respond(message.kind, value_of(message.kind, line_), to_client);
      actions.emplace_back(LineChange{message.kind, value});
      return;
    }
    case Kind::kControl: return on_control(value, actions, to_client);
    case Kind::kPurge: actions.emplace_back(LineChange{Kind::kPurge, value}); return;
    case Kind::kModemState: return respond(Kind::kModemState, modem_state_, to_client);
    case Kind::kLineState: return;
    case Kind::kSuspend: suspended_ = true; return;
    case Kind::kResume: suspended_ = false; return;
    case Kind::kLineStateMask: line_mask_ = mask; return respond(message.kind, mask, to_client);
    case Kind::kModemStateMask: modem_mask_ = mask; return respond(message.kind, mask, to_client);
  }
}

void LineServer::on_control(std::uint32_t value, LineActions& actions, Bytes& to_client) {
  const bool request = value % 3 == 1 && value != 1;
  if (value == 0 || request || value > static_cast<std::uint32_t>(Control::kRtsOff))
    return respond(Kind::kControl, control_in_force(value), to_client);
  actions.emplace_back(LineChange{Kind::kControl, value});
}

std::uint32_t LineServer::control_in_force(std::uint32_t value) const {
  // Flow control of the received direction is that of both: 13 request, 14 none, 15, 16.
  if (value >= 13) return static_cast<std::uint32_t>(controls_[0]) + 13;
  return static_cast<std::uint32_t>(controls_[group_of(value)]);
}

void LineServer::on_changed(const LineChange& change, bool done, Bytes& to_client) {
  std::uint32_t value = change.value;
  if (change.kind == Kind::kControl) {
    if (done) controls_[group_of(value)] = static_cast<Control>(value);
    value = control_in_force(value);
  } else if (change.kind != Kind::kPurge) {
    if (done) (void)set_value(line_, change.kind, value);
    value = value_of(change.kind, line_);
  }
  respond(change.kind, value, to_client);
}

void LineServer::on_modem_state(std::uint8_t state, Bytes& to_client) {
  constexpr std::uint8_t kLevels = 0xF0;  // DCD, RI, DSR, CTS; their changes are 4 bits lower
  const auto changed = static_cast<std::uint8_t>((state ^ modem_state_) & kLevels);
  modem_state_ = state & kLevels;
  constexpr std::uint8_t kRing = 0x40, kRingEnded = 0x04;
  auto deltas = static_cast<std::uint8_t>(changed >> 4);
  if ((modem_state_ & kRing) != 0) deltas &= static_cast<std::uint8_t>(~kRingEnded);
  const auto bits = static_cast<std::uint8_t>((modem_state_ | deltas) & modem_mask_);
  if ((changed & modem_mask_) != 0) respond(Kind::kModemState, bits, to_client);
}

void LineServer::on_line_state(std::uint8_t state, Bytes& to_client) {
  if ((state & line_mask_) != 0) respond(Kind::kLineState, state & line_mask_, to_client);
}

void LineServer::respond(Kind kind, std::uint32_t value, Bytes& to_client) const {
  append_message(to_client, {From::kServer, kind, value, {}, one_byte_ && kind == Kind::kBaud});
}

}  // namespace fieldcast::telnet
