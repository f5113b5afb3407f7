#include <utility>

#include "core/program/engineer.hpp"
#include "core/program/frame.hpp"

namespace fieldcast::program {

void Engineer::handle(const FromClient& event, Instant now, Actions& actions) {
  received_at_ = now;
  if (paired() && by_length_) return read_chunks(event.bytes, now, actions);
  reader_.feed(event.bytes);
  read_frames(now, actions);
}

// REQUIRES: no pairing, or one with framing by markers.
void Engineer::read_frames(Instant now, Actions& actions) {
  while (state_ == State::kHandshake || paired()) {
    auto frame = reader_.next(paired() ? MarkerReader::Phase::kTransmission
                                       : MarkerReader::Phase::kHandshake);
    if (!frame) break;
    take_frame(*std::move(frame), now, actions);
  }
  half_from_client_ = paired() && reader_.partial() ? now + reader_.patience() : kNever;
  const bool waiting =
      state_ == State::kLogin || state_ == State::kListing || state_ == State::kTaking;
  if (waiting && reader_.held() > kMaxEarly) {
    if (state_ == State::kTaking) actions.push_back(FreeDevice{});
    close("the client does not wait for the response to its request", actions);
  }
}

void Engineer::take_frame(MarkerFrame frame, Instant now, Actions& actions) {
  if (const auto* lost = std::get_if<BrokenFrame>(&frame)) {
    broken(*lost, actions);
  } else if (auto* code = std::get_if<ControlCode>(&frame)) {
    paired() ? transmission_code(code->code, now, actions)
             : handshake_code(code->code, now, actions);
  } else {
    program_bytes(std::move(std::get<Instruction>(frame).bytes), now, actions);
  }
}

void Engineer::handshake_code(const std::string& code, Instant now, Actions& actions) {
  if (code == kStopCode && listed_ > 0)
    return close("the client disconnects after the list of devices", actions);
  if (code == kHeartbeatCode || code == kStopCode) return;  // of a previous pairing
  // Program bytes sent before the client received the loss of the device.
  if (code.ends_with('\r')) return broken({FrameFault::kNoise, code.size()}, actions);
  if (code.starts_with(kLoginCode) && code.find(':') != code.npos) return login(code, actions);
  if (code == kListCode) return request_list(actions);
  by_length_ = code.starts_with(kLengthCode);
  const std::string number = by_length_ ? code.substr(kLengthCode.size()) : code;
  if (!is_device_number(number))
    return refuse(Reply::kNotOnline, "what is asked for is no device number", now, actions);
  if (rules_.login_needed && !logged_in_)
    return refuse_login("device " + number + " was asked for without a login", actions);
  state_ = State::kTaking;
  actions.push_back(TakeDevice{number});
}

void Engineer::request_list(Actions& actions) {
  if (rules_.login_needed && !logged_in_)
    return refuse_login("the list of devices was requested without a login", actions);
  if (++listed_ > kMaxLists) return close("too many requests for the list of devices", actions);
  state_ = State::kListing;
  actions.push_back(ListDevices{});
}

void Engineer::login(std::string_view code, Actions& actions) {
  const auto colon = code.find(':');
  const auto user = text_of_hex(code.substr(kLoginCode.size(), colon - kLoginCode.size()));
  const auto password = text_of_hex(code.substr(colon + 1));
  if (!user || !is_name_in_line(*user) || !password || user->size() > kMaxLoginText ||
      password->size() > kMaxLoginText)
    return refuse_login("a login that cannot be read", actions);
  state_ = State::kLogin;
  actions.push_back(CheckLogin{*user, *password});
}

void Engineer::transmission_code(const std::string& code, Instant now, Actions& actions) {
  if (code == kStopCode) end_pairing("stopped by the engineer", false, now, actions);
  // Heartbeats have already updated received_at_.
}

void Engineer::broken(const BrokenFrame& frame, Actions& actions) {
  actions.push_back(Remark{Remark::Kind::kDropped, std::string(to_text(frame.fault)) + " (" +
                                                       std::to_string(frame.bytes) + " bytes)"});
  if (frame.fault != FrameFault::kNoise && paired()) return;
  noise_ += frame.bytes;
  if (noise_ <= (was_paired_ ? kMaxNoiseLater : kMaxNoise)) return;
  if (paired()) {
    actions.push_back(FreeDevice{});
    actions.push_back(Remark{Remark::Kind::kEnded, "the client sends noise"});
  }
  close("noise instead of frames", actions);
}

void Engineer::read_chunks(ByteView bytes, Instant now, Actions& actions) {
  Bytes program;
  while (paired()) {
    const auto frame = lengths_.next(bytes);
    if (!frame) break;
    if (const auto* chunk = std::get_if<ChunkBytes>(&*frame)) {
      append(program, chunk->bytes);
    } else if (const auto* settings = std::get_if<LineSettings>(&*frame)) {
      program_bytes(std::exchange(program, {}), now,
                    actions);  // earlier bytes are sent with the previous settings
      actions.push_back(SetLine{*settings});
    } else if (std::holds_alternative<Stop>(*frame)) {
      program_bytes(std::exchange(program, {}), now, actions);
      end_pairing("stopped by the engineer", false, now, actions);
    } else if (const auto* fault = std::get_if<FrameFault>(&*frame)) {
      program_bytes(std::exchange(program, {}), now, actions);
      end_pairing(std::string(to_text(*fault)), true, now, actions);
    }
  }
  program_bytes(std::move(program), now, actions);
}

void Engineer::program_bytes(Bytes bytes, Instant now, Actions& actions) {
  if (bytes.empty()) return;
  worked_at_ = now;
  to_device_ += bytes.size();
  actions.push_back(ToDevice{std::move(bytes)});
}

}  // namespace fieldcast::program
