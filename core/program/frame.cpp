#include "core/program/frame.hpp"

#include <algorithm>
#include <array>

namespace fieldcast::program {
namespace {

// In transmission. All other codes belong to the handshake.
constexpr std::array<std::string_view, 2> kClientCodes{kHeartbeatCode, kStopCode},
    kBridgeCodes{kHeartbeatCode, "0003"};

// See marker_reader.hpp.
Opening judged_by(std::string_view rest) {
  const auto end = rest.find('\r');
  const auto next = rest.find(kFrameStart);
  if (next < end) return Opening::kControl;
  if (end == rest.npos) return Opening::kUndecided;
  const auto tail = rest.substr(end, kInstructionEnd.size());
  if (tail == kInstructionEnd) return Opening::kProgram;
  return kInstructionEnd.starts_with(tail) ? Opening::kUndecided : Opening::kControl;
}

}  // namespace

FrameOpening opening_of(std::string_view text, Sender sender) {
  for (const std::string_view code : sender == Sender::kClient ? kClientCodes : kBridgeCodes) {
    const auto head = text.substr(0, code.size());
    const auto mark = text.substr(head.size(), kFrameEnd.size());
    if (!code.starts_with(head) || !kFrameEnd.starts_with(mark)) continue;
    if (mark.size() < kFrameEnd.size()) return {Opening::kUndecided, {}};
    // `H` is not a hexadecimal digit, so a response cannot continue with it.
    if (code == kHeartbeatCode) return {Opening::kControl, code};
    return {judged_by(text.substr(code.size() + kFrameEnd.size())), code};
  }
  return {};
}

std::string_view to_code(Reply reply) {
  static constexpr std::string_view kCodes[] = {"0000", "0001", "0002", "0003", "0004"};
  return kCodes[static_cast<std::size_t>(reply)];
}

std::string_view to_text(Reply reply) {
  switch (reply) {
    case Reply::kPaired: return "paired";
    case Reply::kNotOnline: return "the device is not online";
    case Reply::kInUse: return "the device is in use by another engineer";
    case Reply::kLost: return "the device went offline, or was taken back";
    case Reply::kNotAllowed: return "a login of a user with the role programmer is needed";
  }
  return "?";
}

std::optional<Reply> reply_from(std::string_view code) {
  if (code.size() != 4 || !code.starts_with("000") || code[3] < '0' || code[3] > '4')
    return std::nullopt;
  return static_cast<Reply>(code[3] - '0');
}

std::string_view to_text(FrameFault fault) {
  switch (fault) {
    case FrameFault::kNoise: return "bytes outside of any frame, dropped";
    case FrameFault::kTooLong:
      return "an instruction of more than 4096 characters, dropped; framing by length has no such "
             "limit";
    case FrameFault::kHalf:
      return "half an instruction whose rest did not come within 2 s, dropped";
    case FrameFault::kAmbiguous:
      return "an instruction that begins like a control frame and a second one, dropped; framing "
             "by "
             "length carries it";
    case FrameFault::kBadLength: return "a length that no client sends";
    case FrameFault::kBadLine: return "line settings that no client sends";
  }
  return "?";
}

Bytes control_frame(std::string_view code) {
  Bytes out;
  append(out, as_bytes(kFrameStart));
  append(out, as_bytes(code));
  append(out, as_bytes(kFrameEnd));
  return out;
}

}  // namespace fieldcast::program
