#include "core/program/line_engineer.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::program {
namespace {

Remark ended(std::string reason) { return {Remark::Kind::kEnded, std::move(reason)}; }

}  // namespace

LineEngineer::LineEngineer(const EngineerRules& rules, Instant now)
    : rules_(rules), login_until_(now + kPromptWait), worked_at_(now) {}

void LineEngineer::on_event(const EngineerEvent& event, Instant now, Actions& actions) {
  if (over()) return;
  if (state_ == State::kNew) begin(actions);
  std::visit([&](const auto& what) { handle(what, now, actions); }, event);
  const Instant wake = over() ? kNever : next_wake();
  if (wake == timer_) return;
  timer_ = wake;
  actions.push_back(SetTimer{wake});
}

Instant LineEngineer::next_wake() const {
  if (state_ == State::kPaired)
    return std::min({worked_at_ + rules_.idle, client_stuck_, device_stuck_});
  return state_ == State::kUser || state_ == State::kPassword ? login_until_ : kNever;
}

void LineEngineer::begin(Actions& actions) {
  if (rules_.port->telnet) {
    if (rules_.login_needed && !rules_.by_certificate)
      server_.options().request(telnet::kEcho, telnet::End::kHere, first_);
    actions.push_back(ToClient{std::move(first_)});
  }
  if (rules_.by_certificate) {
    state_ = State::kChecking;
  } else if (rules_.login_needed && !rules_.port->telnet) {
    close({Remark::Kind::kRefused, "a certificate is needed"}, {}, actions);
  } else if (rules_.login_needed) {
    state_ = State::kUser;
    say("user: ", actions);
  } else {
    take(actions);
  }
}

void LineEngineer::take(Actions& actions) {
  state_ = State::kTaking;
  actions.push_back(TakeDevice{rules_.port->number});
}

// Text for a person at a Telnet client. Raw ports have none, because software would read it.
void LineEngineer::say(std::string_view text, Actions& actions) const {
  if (!rules_.port->telnet) return;
  Bytes out;
  telnet::append_data(out, as_bytes(text));
  actions.push_back(ToClient{std::move(out)});
}

void LineEngineer::close(Remark remark, std::string_view text, Actions& actions) {
  if (state_ == State::kTaking || state_ == State::kPaired) actions.push_back(FreeDevice{});
  actions.push_back(std::move(remark));
  if (!text.empty()) say(text, actions);
  state_ = State::kOver;
  actions.push_back(HangUp{});
}

void LineEngineer::handle(const FromClient& event, Instant now, Actions& actions) {
  if (state_ != State::kTaking && state_ != State::kChecking)
    return read(event.bytes, now, actions);
  if (early_.size() + event.bytes.size() > kMaxEarly)
    return close({Remark::Kind::kDropped, "too many bytes before the device was given"}, {},
                 actions);
  ByteView bytes = event.bytes;
  const bool ends_return =
      std::exchange(after_return_, false) && !bytes.empty() && (bytes[0] == '\n' || bytes[0] == 0);
  if (ends_return) bytes = bytes.subspan(1);
  append(early_, bytes);
}

void LineEngineer::read(ByteView bytes, Instant now, Actions& actions) {
  if (!rules_.port->telnet) return to_device(Bytes(bytes.begin(), bytes.end()), now, actions);
  telnet::LineActions found;
  Bytes to_client;
  server_.on_bytes(bytes, found, to_client);
  respond(std::move(to_client), actions);
  for (auto& each : found) {
    if (over()) return;
    if (const auto* change = std::get_if<telnet::LineChange>(&each)) {
      execute(*change, actions);
    } else if (auto& data = std::get<telnet::LineData>(each).bytes; state_ == State::kPaired) {
      to_device(std::move(data), now, actions);
    } else {
      type(data, actions);
    }
  }
  if (state_ != State::kPaired || server_.suspended() == held_) return;
  held_ = server_.suspended();
  actions.push_back(HoldDevice{held_});
}

// At the prompt the software may already set the line: it is set when the device is given.
void LineEngineer::execute(const telnet::LineChange& change, Actions& actions) {
  if (state_ == State::kPaired) return actions.push_back(ChangeLine{change});
  set_ |= 1u << static_cast<unsigned>(change.kind);
  Bytes to_client;
  server_.on_changed(change, true, to_client);
  respond(std::move(to_client), actions);
}

void LineEngineer::respond(Bytes response, Actions& actions) {
  if (response.empty()) return;
  unread_ = client_stuck_ == kNever ? 0 : unread_ + response.size();
  actions.push_back(ToClient{std::move(response)});
  if (unread_ > kMaxResponses)
    close({Remark::Kind::kDropped, "the client sends requests but reads no responses"}, {},
          actions);
}

void LineEngineer::to_device(Bytes bytes, Instant now, Actions& actions) {
  if (bytes.empty()) return;
  worked_at_ = now;
  to_device_ += bytes.size();
  actions.push_back(ToDevice{std::move(bytes)});
}

// Bytes after the end of the login belong to the device.
void LineEngineer::type(ByteView bytes, Actions& actions) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::uint8_t byte = bytes[i];
    const bool second = std::exchange(after_return_, byte == '\r') && (byte == '\n' || byte == 0);
    if (state_ == State::kChecking) {
      append(typed_ahead_, bytes.subspan(second ? i + 1 : i));
      return;
    }
    if (second) continue;
    if (byte == '\r' || byte == '\n') {
      entered(actions);
    } else if (byte == 0x08 || byte == 0x7F) {
      if (!line_.empty()) line_.pop_back();
    } else if (byte >= 0x20 && line_.size() < kMaxLoginText) {
      line_ += static_cast<char>(byte);
      if (state_ == State::kUser) say({&line_.back(), 1}, actions);
    }
  }
}

void LineEngineer::entered(Actions& actions) {
  say("\r\n", actions);
  std::string text = std::exchange(line_, {});
  if (state_ == State::kUser) {
    user_ = std::move(text);
    state_ = State::kPassword;
    return say("password: ", actions);
  }
  state_ = State::kChecking;
  actions.push_back(CheckLogin{user_, std::move(text)});
}

void LineEngineer::handle(const LoginChecked& event, Instant, Actions& actions) {
  if (state_ != State::kChecking) return;
  if (!event.allowed)
    return close({Remark::Kind::kLoginFailed, event.reason}, "login refused\r\n", actions);
  actions.push_back(Remark{Remark::Kind::kLogin, "logged in"});
  take(actions);
}

void LineEngineer::handle(const DeviceGiven& event, Instant now, Actions& actions) {
  if (state_ != State::kTaking) return;
  state_ = State::kPaired;
  worked_at_ = now;
  actions.push_back(Remark{Remark::Kind::kPaired, rules_.port->telnet ? "RFC 2217" : "raw bytes"});
  const LineFormat wanted = server_.line();
  server_.on_line(event.line);
  for (const telnet::Kind kind : telnet::kSettings) {
    const std::uint32_t value = value_of(kind, wanted);
    const bool was_set = (set_ >> static_cast<unsigned>(kind) & 1u) != 0;
    if (was_set && value != value_of(kind, event.line))
      actions.push_back(ChangeLine{{kind, value}});
  }
  to_device(std::exchange(typed_ahead_, {}), now, actions);
  const Bytes early = std::exchange(early_, {});
  read(early, now, actions);
}

void LineEngineer::handle(const DeviceRefused& event, Instant, Actions& actions) {
  if (state_ != State::kTaking) return;
  state_ = State::kChecking;  // the device was not given: it is not freed
  close({Remark::Kind::kRefused,
         event.reason.empty() ? std::string(to_text(event.why)) : event.reason},
        "refused: " + std::string(to_text(event.why)) + "\r\n", actions);
}

void LineEngineer::handle(const FromDevice& event, Instant now, Actions& actions) {
  if (state_ != State::kPaired || event.bytes.empty()) return;
  worked_at_ = now;
  from_device_ += event.bytes.size();
  Bytes out;
  if (rules_.port->telnet)
    telnet::append_data(out, event.bytes);
  else
    append(out, event.bytes);
  actions.push_back(ToClient{std::move(out)});
}

void LineEngineer::handle(const LineChanged& event, Instant, Actions& actions) {
  if (state_ != State::kPaired) return;
  Bytes out;
  server_.on_changed(event.change, event.done, out);
  respond(std::move(out), actions);
}

void LineEngineer::handle(const LineState& event, Instant, Actions& actions) {
  if (state_ != State::kPaired || !rules_.port->telnet || !server_.com_port()) return;
  Bytes out;
  server_.on_modem_state(event.modem, out);
  server_.on_line_state(event.errors, out);
  if (!out.empty()) actions.push_back(ToClient{std::move(out)});
}

void LineEngineer::handle(const ClientGone& event, Instant, Actions& actions) {
  close(ended((state_ == State::kPaired ? "the client disconnected: "
                                        : "the client disconnected before it was paired: ") +
              event.reason),
        {}, actions);
}

void LineEngineer::handle(const DeviceLost& event, Instant, Actions& actions) {
  if (state_ == State::kTaking || state_ == State::kPaired)
    close(ended("the device is lost: " + event.reason), {}, actions);
}

void LineEngineer::handle(const ClientTakes& event, Instant now, Actions&) {
  client_stuck_ = event.takes ? kNever : std::min(client_stuck_, now + kStuckWait);
}

void LineEngineer::handle(const DeviceTakes& event, Instant now, Actions&) {
  device_stuck_ = event.takes ? kNever : std::min(device_stuck_, now + kStuckWait);
}

void LineEngineer::handle(const ClientDrains&, Instant now, Actions&) {
  if (client_stuck_ != kNever) client_stuck_ = now + kStuckWait, worked_at_ = now;
}

void LineEngineer::handle(const DeviceDrains&, Instant now, Actions&) {
  if (device_stuck_ != kNever) device_stuck_ = now + kStuckWait, worked_at_ = now;
}

void LineEngineer::handle(const Ended& event, Instant, Actions& actions) {
  close(ended(event.reason), event.reason + "\r\n", actions);
}

void LineEngineer::handle(const TimerFired&, Instant now, Actions& actions) {
  timer_ = kNever;
  const std::string stuck = " takes no bytes for " + fieldcast::to_text(kStuckWait);
  if (state_ == State::kUser || state_ == State::kPassword) {
    if (now >= login_until_)
      close(ended("no login within " + fieldcast::to_text(kPromptWait)), "too late\r\n", actions);
  } else if (state_ != State::kPaired) {
    return;
  } else if (now >= client_stuck_) {
    close(ended("the client" + stuck), {}, actions);
  } else if (now >= device_stuck_) {
    close(ended("the device" + stuck), {}, actions);
  } else if (now >= worked_at_ + rules_.idle) {
    close(ended("no program byte for " + fieldcast::to_text(rules_.idle)), {}, actions);
  }
}

}  // namespace fieldcast::program
