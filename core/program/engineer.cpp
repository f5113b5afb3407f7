// States and timeouts of a connection; see engineer_frames.cpp for the client's frames.
#include "core/program/engineer.hpp"

#include <algorithm>
#include <utility>

#include "core/base/message_text.hpp"

namespace fieldcast::program {
namespace {

std::string seconds_text(Duration time) { return fieldcast::to_text(time); }

}  // namespace

Engineer::Engineer(const EngineerRules& rules, Instant now)
    : rules_(rules),
      state_(rules.by_certificate ? State::kLogin : State::kHandshake),
      handshake_until_(now + rules.handshake),
      received_at_(now) {}

void Engineer::on_event(const EngineerEvent& event, Instant now, Actions& actions) {
  if (over()) return;
  std::visit([&](const auto& what) { handle(what, now, actions); }, event);
  const Instant wake = over() ? kNever : next_wake();
  if (wake == timer_) return;
  timer_ = wake;
  actions.push_back(SetTimer{wake});
}

Instant Engineer::next_wake() const {
  switch (state_) {
    case State::kHandshake: return std::min(handshake_until_, client_stuck_);
    case State::kPaired:
      return std::min({heartbeat_at_, silence_limit(), worked_at_ + rules_.idle, half_from_client_,
                       half_from_device_, client_stuck_, device_stuck_});
    default: return kNever;
  }
}

// While the device's queue is full, the client is not read and its heartbeats wait.
Instant Engineer::silence_limit() const {
  if (device_stuck_ != kNever) return kNever;
  return received_at_ + rules_.heartbeat * kMissed + rules_.heartbeat / 2;
}

void Engineer::handle(const ClientGone& event, Instant now, Actions& actions) {
  if (paired() && !by_length_) {
    if (auto last = reader_.take_code()) take_frame(*std::move(last), now, actions);
  }
  if (state_ == State::kPaired) {
    end_pairing("the client disconnected: " + event.reason, false, now, actions);
  } else {
    if (state_ == State::kTaking) actions.push_back(FreeDevice{});
    actions.push_back(Remark{Remark::Kind::kEnded,
                             "the client disconnected before it was paired: " + event.reason});
  }
  if (over()) return;
  state_ = State::kOver;
  actions.push_back(HangUp{});
}

void Engineer::handle(const LoginChecked& event, Instant now, Actions& actions) {
  if (state_ != State::kLogin) return;
  if (!event.allowed) return refuse_login(event.reason, actions);
  actions.push_back(Remark{Remark::Kind::kLogin, "logged in"});
  logged_in_ = true;
  state_ = State::kHandshake;
  handshake_until_ = now + rules_.handshake;
  read_frames(now, actions);
}

void Engineer::handle(const DeviceGiven&, Instant now, Actions& actions) {
  if (state_ != State::kTaking) return;
  state_ = State::kPaired;
  was_paired_ = true;
  reply(Reply::kPaired, actions);
  actions.push_back(
      Remark{Remark::Kind::kPaired, by_length_ ? "framing by length" : "framing by markers"});
  refused_ = listed_ = 0;
  noise_ = 0;
  to_device_ = from_device_ = 0;
  writer_ = MarkerWriter(Sender::kBridge);
  lengths_ = {};
  received_at_ = worked_at_ = now;
  heartbeat_at_ = now + rules_.heartbeat;
  half_from_client_ = half_from_device_ = device_stuck_ = kNever;
  if (by_length_) {
    read_chunks(reader_.take_rest(), now, actions);
  } else {
    read_frames(now, actions);
  }
}

void Engineer::handle(const DeviceRefused& event, Instant now, Actions& actions) {
  if (state_ == State::kTaking) refuse(event.why, event.reason, now, actions);
}

// Only clients that have logged in get the names of other engineers.
void Engineer::handle(const DevicesListed& event, Instant now, Actions& actions) {
  if (state_ != State::kListing) return;
  actions.push_back(ToClient{list_frames(event.devices, logged_in_)});
  actions.push_back(Remark{Remark::Kind::kListed,
                           counted(event.devices.size(), "device", "devices") + " listed"});
  state_ = State::kHandshake;
  handshake_until_ = now + rules_.handshake;
  read_frames(now, actions);
}

void Engineer::handle(const FromDevice& event, Instant now, Actions& actions) {
  if (!paired() || event.bytes.empty()) return;
  worked_at_ = now;
  from_device_ += event.bytes.size();
  Bytes out;
  if (by_length_) {
    append_chunks(out, event.bytes);
  } else {
    for (const BrokenFrame& lost : writer_.write(event.bytes, out)) broken(lost, actions);
    half_from_device_ = writer_.partial() ? now + kHalfWait : kNever;
  }
  if (!out.empty()) actions.push_back(ToClient{std::move(out)});
}

void Engineer::handle(const DeviceLost& event, Instant now, Actions& actions) {
  if (paired()) {
    end_pairing("the device is lost: " + event.reason, true, now, actions);
  } else if (state_ == State::kTaking) {
    actions.push_back(FreeDevice{});
    refuse(Reply::kNotOnline, event.reason, now, actions);
  }
}

void Engineer::handle(const ClientTakes& event, Instant now, Actions&) {
  client_stuck_ = event.takes ? kNever : std::min(client_stuck_, now + kStuckWait);
}

void Engineer::handle(const DeviceTakes& event, Instant now, Actions&) {
  if (event.takes) received_at_ = now;  // reading resumes
  device_stuck_ = event.takes ? kNever : std::min(device_stuck_, now + kStuckWait);
}

void Engineer::handle(const ClientDrains&, Instant now, Actions&) {
  if (client_stuck_ == kNever) return;
  client_stuck_ = now + kStuckWait;
  worked_at_ = now;
}

void Engineer::handle(const DeviceDrains&, Instant now, Actions&) {
  if (device_stuck_ == kNever) return;
  device_stuck_ = now + kStuckWait;
  worked_at_ = now;
}

void Engineer::handle(const Ended& event, Instant now, Actions& actions) {
  if (paired()) end_pairing(event.reason, true, now, actions);
  if (state_ == State::kTaking) actions.push_back(FreeDevice{});
  close(event.reason, actions);
}

void Engineer::handle(const TimerFired&, Instant now, Actions& actions) {
  timer_ = kNever;
  if (now >= client_stuck_) {
    const std::string reason = "the client takes no bytes for " + seconds_text(kStuckWait);
    if (paired()) end_pairing(reason, false, now, actions);
    return close(reason, actions);
  }
  if (state_ == State::kHandshake && now >= handshake_until_) {
    return close("no device was asked for within " + seconds_text(rules_.handshake), actions);
  }
  if (!paired()) return;
  if (now >= device_stuck_)
    return end_pairing("the device takes no bytes for " + seconds_text(kStuckWait), true, now,
                       actions);
  if (now >= silence_limit()) {
    const std::string reason = std::to_string(kMissed) + " heartbeats of the client are missing";
    end_pairing(reason, true, now, actions);
    return close(reason, actions);
  }
  if (now >= worked_at_ + rules_.idle) {
    return end_pairing("no program byte for " + seconds_text(rules_.idle), true, now, actions);
  }
  if (now >= half_from_client_ && !give_up_client_half(now, actions)) return;
  if (now >= half_from_device_) {
    half_from_device_ = kNever;
    if (const auto half = writer_.give_up()) broken(*half, actions);
  }
  if (now >= heartbeat_at_) send_heartbeat(now, actions);
}

// Returns false if the pairing ended.
bool Engineer::give_up_client_half(Instant now, Actions& actions) {
  half_from_client_ = kNever;
  if (auto code = reader_.take_code()) {
    take_frame(*std::move(code), now, actions);
    read_frames(now, actions);
    return paired();
  }
  if (const auto half = reader_.give_up()) broken(*half, actions);
  return true;
}

void Engineer::send_heartbeat(Instant now, Actions& actions) {
  heartbeat_at_ = now + rules_.heartbeat;
  actions.push_back(ToClient{heartbeat_frame(by_length_)});
}

void Engineer::reply(Reply reply, Actions& actions) {
  actions.push_back(ToClient{control_frame(to_code(reply))});
}

void Engineer::refuse(Reply why, const std::string& reason, Instant now, Actions& actions) {
  actions.push_back(
      Remark{Remark::Kind::kRefused, reason.empty() ? std::string(to_text(why)) : reason});
  reply(why, actions);
  state_ = State::kHandshake;
  handshake_until_ = now + rules_.handshake;
  if (++refused_ >= kMaxRefused) return close("too many requests that cannot be granted", actions);
  read_frames(now, actions);
}

// `notify`: the client receives the end; with markers it may request another device.
void Engineer::end_pairing(const std::string& reason, bool notify, Instant now, Actions& actions) {
  actions.push_back(FreeDevice{});
  actions.push_back(Remark{Remark::Kind::kEnded, reason});
  if (notify) {
    Bytes out;
    if (by_length_) out = stop_frame(true);
    append(out, control_frame(to_code(Reply::kLost)));
    actions.push_back(ToClient{std::move(out)});
  }
  state_ = State::kHandshake;
  handshake_until_ = now + rules_.handshake;
  if (!by_length_) return;
  state_ = State::kOver;
  actions.push_back(HangUp{});
}

void Engineer::refuse_login(const std::string& reason, Actions& actions) {
  actions.push_back(Remark{Remark::Kind::kLoginFailed, reason});
  reply(Reply::kNotAllowed, actions);
  state_ = State::kOver;
  actions.push_back(HangUp{});
}

void Engineer::close(const std::string& reason, Actions& actions) {
  if (over()) return;
  actions.push_back(Remark{Remark::Kind::kEnded, reason});
  state_ = State::kOver;
  actions.push_back(HangUp{});
}

}  // namespace fieldcast::program
