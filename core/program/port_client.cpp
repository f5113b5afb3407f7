#include "core/program/port_client.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::program {

Bytes login_frame(const std::string& user, const std::string& password) {
  if (user.empty()) return {};
  return control_frame(std::string(kLoginCode) + hex_of_text(user) + ':' + hex_of_text(password));
}

// Only the bridge's audit trail contains the reason of a failed login.
std::string refusal_text(Reply reply, const std::string& user) {
  if (reply != Reply::kNotAllowed || user.empty()) return std::string(to_text(reply));
  return "the login of " + user +
         " is refused: a wrong password, another role than programmer, or too many wrong passwords "
         "just before; 'fieldcast audit' at the bridge says which";
}

void PortClient::on_event(const Event& event, Instant now, Actions& actions) {
  if (over()) return;
  struct Handle {
    PortClient& me;
    Instant now;
    Actions& actions;
    void operator()(const Connected&) const { me.greet(now, actions); }
    void operator()(const FromBridge& e) const { me.receive(e.bytes, now, actions); }
    void operator()(const FromProgram& e) const { me.send_program(e.bytes, now, actions); }
    void operator()(const ProgramTakes& e) const {
      me.program_takes_ = e.takes;
      if (e.takes) me.received_at_ = now;  // reading from the bridge resumes
    }
    void operator()(const LineChanged& e) const {
      if (me.paired()) me.set_line(e.settings, actions);
    }
    void operator()(const BridgeGone& e) const { me.bridge_gone(e.reason, now, actions); }
    void operator()(const StopAsked&) const { me.stop(actions); }
    void operator()(const TimerFired&) const { me.timer(now, actions); }
  };
  std::visit(Handle{*this, now, actions}, event);
  const Instant wake = next_wake();
  if (wake == timer_) return;
  timer_ = wake;
  actions.push_back(SetTimer{wake});
}

Instant PortClient::next_wake() const {
  if (state_ == State::kAsking) return reply_until_;
  if (!paired()) return kNever;
  return std::min({heartbeat_at_, silence_limit(), half_from_program_, half_from_bridge_});
}

// While the program accepts no bytes, heartbeats are not read.
Instant PortClient::silence_limit() const {
  if (!program_takes_) return kNever;
  return received_at_ + rules_.heartbeat * kMissed + rules_.heartbeat / 2;
}

void PortClient::greet(Instant now, Actions& actions) {
  Bytes out = login_frame(rules_.user, rules_.password);
  append(out, control_frame((rules_.by_length ? std::string(kLengthCode) : std::string()) +
                            rules_.number));
  actions.push_back(ToBridge{std::move(out)});
  state_ = State::kAsking;
  received_at_ = now;
  reply_until_ = now + rules_.reply;
}

void PortClient::receive(ByteView bytes, Instant now, Actions& actions) {
  received_at_ = now;
  if (paired() && rules_.by_length) return read_chunks(bytes, actions);
  reader_.feed(bytes);
  read_frames(now, actions);
}

void PortClient::read_frames(Instant now, Actions& actions) {
  while (state_ == State::kAsking || (paired() && !rules_.by_length)) {
    auto frame = reader_.next(paired() ? MarkerReader::Phase::kTransmission
                                       : MarkerReader::Phase::kHandshake);
    if (!frame) break;
    take_frame(*std::move(frame), now, actions);
  }
  half_from_bridge_ =
      paired() && !rules_.by_length && reader_.partial() ? now + reader_.patience() : kNever;
}

void PortClient::take_frame(MarkerFrame frame, Instant now, Actions& actions) {
  if (const auto* lost = std::get_if<BrokenFrame>(&frame)) {
    if (!paired())
      return finish(PortEnd::Kind::kProtocol, "the peer is not a Fieldcast bridge", actions);
    actions.push_back(Dropped{std::string(to_text(lost->fault))});
  } else if (auto* instruction = std::get_if<Instruction>(&frame)) {
    pass_to_program(std::move(instruction->bytes), actions);
  } else {
    code(std::get<ControlCode>(frame).code, now, actions);
  }
}

void PortClient::bridge_gone(const std::string& reason, Instant now, Actions& actions) {
  if (paired() && !rules_.by_length) {
    if (auto last = reader_.take_code()) take_frame(*std::move(last), now, actions);
  }
  if (!over()) finish(PortEnd::Kind::kBridgeGone, reason, actions);
}

void PortClient::code(const std::string& code, Instant now, Actions& actions) {
  if (code == kHeartbeatCode && paired()) return send_heartbeat(actions);
  const auto reply = reply_from(code);
  if (!reply) return;
  // The loss is the only other code of a transmission.
  if (paired())
    return finish(PortEnd::Kind::kDeviceLost, std::string(to_text(Reply::kLost)), actions);
  if (*reply != Reply::kPaired)
    return finish(PortEnd::Kind::kRefused, refusal_text(*reply, rules_.user), actions, *reply);
  state_ = State::kPaired;
  heartbeat_at_ = now + rules_.heartbeat;
  actions.push_back(Paired{});
  if (rules_.format) set_line({}, actions);  // before the program's first byte
  if (rules_.by_length) read_chunks(reader_.take_rest(), actions);
}

void PortClient::set_line(LineSettings settings, Actions& actions) const {
  if (!rules_.by_length) return;
  if (rules_.format) {
    settings.data_bits = rules_.format->data_bits;
    settings.parity = rules_.format->parity;
    settings.stop_bits = rules_.format->stop_bits;
    if (rules_.baud != 0) settings.baud = rules_.baud;
  }
  Bytes out;
  append_settings(out, settings);
  actions.push_back(ToBridge{std::move(out)});
}

void PortClient::read_chunks(ByteView bytes, Actions& actions) {
  Bytes program;
  while (paired()) {
    const auto frame = lengths_.next(bytes);
    if (!frame) break;
    if (const auto* chunk = std::get_if<ChunkBytes>(&*frame)) {
      append(program, chunk->bytes);
      continue;
    }
    if (std::holds_alternative<Heartbeat>(*frame)) {
      send_heartbeat(actions);
      continue;
    }
    pass_to_program(std::exchange(program, {}), actions);
    if (std::holds_alternative<Stop>(*frame)) {
      finish(PortEnd::Kind::kDeviceLost, std::string(to_text(Reply::kLost)), actions);
    } else {
      finish(PortEnd::Kind::kProtocol, "the bridge's stream makes no sense", actions);
    }
  }
  pass_to_program(std::move(program), actions);
}

void PortClient::pass_to_program(Bytes bytes, Actions& actions) {
  if (bytes.empty()) return;
  from_device_ += bytes.size();
  actions.push_back(ToProgram{std::move(bytes)});
}

void PortClient::send_program(ByteView bytes, Instant now, Actions& actions) {
  if (!paired() || bytes.empty()) return;
  Bytes out;
  to_device_ += bytes.size();
  if (rules_.by_length) {
    append_chunks(out, bytes);
  } else {
    for (const BrokenFrame& lost : writer_.write(bytes, out))
      actions.push_back(Dropped{std::string(to_text(lost.fault))});
    half_from_program_ = writer_.partial() ? now + kHalfWait : kNever;
  }
  if (!out.empty()) actions.push_back(ToBridge{std::move(out)});
}

void PortClient::stop(Actions& actions) {
  if (paired()) actions.push_back(ToBridge{stop_frame(rules_.by_length)});
  finish(PortEnd::Kind::kStopped, "stopped", actions);
}

void PortClient::timer(Instant now, Actions& actions) {
  timer_ = kNever;
  if (state_ == State::kAsking && now >= reply_until_) {
    return finish(PortEnd::Kind::kBridgeGone, "the bridge does not respond", actions);
  }
  if (!paired()) return;
  if (now >= silence_limit()) {
    return finish(PortEnd::Kind::kBridgeGone,
                  std::to_string(kMissed) + " heartbeats of the bridge are missing", actions);
  }
  if (now >= half_from_bridge_) {
    half_from_bridge_ = kNever;
    if (auto code = reader_.take_code()) {
      take_frame(*std::move(code), now, actions);
      read_frames(now, actions);
      if (!paired()) return;
    } else if (const auto half = reader_.give_up()) {
      actions.push_back(Dropped{std::string(to_text(half->fault))});
    }
  }
  if (now >= half_from_program_) {
    half_from_program_ = kNever;
    if (const auto half = writer_.give_up())
      actions.push_back(Dropped{std::string(to_text(half->fault))});
  }
  if (now < heartbeat_at_) return;
  heartbeat_at_ = now + rules_.heartbeat;
  send_heartbeat(actions);
}

void PortClient::send_heartbeat(Actions& actions) const {
  actions.push_back(ToBridge{heartbeat_frame(rules_.by_length)});
}

void PortClient::finish(PortEnd::Kind kind, std::string text, Actions& actions,
                        std::optional<Reply> reply) {
  state_ = State::kOver;
  actions.push_back(Finish{{kind, reply, std::move(text)}});
}

std::string slow_path_text(Duration round_trip) {
  constexpr Duration kShort = std::chrono::milliseconds{50};
  if (round_trip < kShort) return {};
  const auto whole = std::chrono::round<std::chrono::milliseconds>(round_trip);
  return "the network adds " + fieldcast::to_text(Duration(whole)) +
         " to each response: if the software reports timeouts, set a longer response timeout in it";
}

}  // namespace fieldcast::program
