#include "core/program/frame.hpp"

#include <algorithm>
#include <array>
#include <utility>

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
             "by length carries it";
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

std::string hex_of_text(std::string_view text) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  for (const char c : text) {
    out.push_back(kDigits[static_cast<std::uint8_t>(c) >> 4]);
    out.push_back(kDigits[static_cast<std::uint8_t>(c) & 15]);
  }
  return out;
}

std::optional<std::string> text_of_hex(std::string_view digits) {
  if (digits.size() % 2 != 0) return std::nullopt;
  const auto value = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  std::string text;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const int high = value(digits[i]), low = value(digits[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    text.push_back(static_cast<char>(high * 16 + low));
  }
  return text;
}

bool is_name_in_line(std::string_view text) {
  return !text.empty() &&
         std::ranges::none_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7F; });
}

bool is_device_number(std::string_view text) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto fits = [&](char c) {
    return is_digit(c) || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
  };
  if (text.empty() || text.size() > kMaxDeviceNumber || !std::ranges::all_of(text, fits))
    return false;
  if (text == kStopCode || text == kHeartbeatCode || text.starts_with(kLengthCode)) return false;
  if (text.size() == 4 && text.starts_with("000") && is_digit(text[3])) return false;
  return text.find(kFrameEnd) == std::string_view::npos;
}

namespace {

constexpr std::uint32_t kStopLength = 0xFFFF'FFFF, kSettingsLength = 0xFFFF'FFFE;
constexpr std::size_t kHead = 4, kSettings = 7;

// 4 baud, stop, data, parity.
LengthFrame settings_from(ByteView body) {
  LineSettings settings;
  settings.baud = read_u32(body);
  settings.stop_bits = body[4];
  settings.data_bits = body[5];
  settings.parity = static_cast<Parity>(body[6]);
  const bool stop = settings.stop_bits == 1 || settings.stop_bits == 2;
  const bool data = settings.data_bits == 0 || settings.data_bits == 7 || settings.data_bits == 8;
  if (!stop || !data || settings.parity > Parity::kOdd) return FrameFault::kBadLine;
  return settings;
}

}  // namespace

std::optional<LengthFrame> LengthReader::next(ByteView& in) {
  if (left_ > 0) {
    if (in.empty()) return std::nullopt;
    const std::size_t count = std::min<std::size_t>(left_, in.size());
    const ByteView part = in.first(count);
    in = in.subspan(count);
    left_ -= static_cast<std::uint32_t>(count);
    return ChunkBytes{part};
  }
  while (true) {
    const bool settings = head_.size() >= kHead && read_u32(head_) == kSettingsLength;
    const std::size_t wanted = kHead + (settings ? kSettings : 0);
    if (head_.size() == wanted) break;
    if (in.empty()) return std::nullopt;
    const std::size_t count = std::min(wanted - head_.size(), in.size());
    append(head_, in.first(count));
    in = in.subspan(count);
    if (head_.size() == kHead && read_u32(head_) != kSettingsLength) break;
  }
  const Bytes head = std::exchange(head_, {});
  const std::uint32_t length = read_u32(head);
  if (length == 0) return Heartbeat{};
  if (length == kStopLength) return Stop{};
  if (length == kSettingsLength) return settings_from(ByteView(head).subspan(kHead));
  if (length > kMaxChunk) return FrameFault::kBadLength;
  left_ = length;
  return next(in);
}

void append_chunks(Bytes& out, ByteView bytes) {
  while (!bytes.empty()) {
    const std::size_t count = std::min<std::size_t>(bytes.size(), kMaxChunk);
    append_u32(out, static_cast<std::uint32_t>(count));
    append(out, bytes.first(count));
    bytes = bytes.subspan(count);
  }
}

Bytes heartbeat_frame(bool by_length) {
  return by_length ? Bytes(kHead) : control_frame(kHeartbeatCode);
}
Bytes stop_frame(bool by_length) {
  return by_length ? Bytes(kHead, 0xFF) : control_frame(kStopCode);
}

void append_settings(Bytes& out, const LineSettings& settings) {
  append_u32(out, kSettingsLength);
  append_u32(out, settings.baud);
  out.push_back(settings.stop_bits);
  out.push_back(settings.data_bits);
  out.push_back(static_cast<std::uint8_t>(settings.parity));
}

}  // namespace fieldcast::program
