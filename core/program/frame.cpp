#include "core/program/frame.hpp"

namespace fieldcast::program {

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
  if (code.size() != 4 || !code.starts_with("000") || code[3] < '0' || code[3] > '4') return std::nullopt;
  return static_cast<Reply>(code[3] - '0');
}

std::string_view to_text(FrameFault fault) {
  switch (fault) {
    case FrameFault::kNoise: return "bytes outside of any frame, dropped";
    case FrameFault::kTooLong: return "an instruction of more than 4096 characters, dropped; framing by length has no such limit";
    case FrameFault::kHalf: return "half an instruction whose rest did not come within 2 s, dropped";
    case FrameFault::kAmbiguous: return "an instruction that begins like a control frame, dropped; framing by length carries it";
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
