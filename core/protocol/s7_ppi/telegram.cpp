#include "core/protocol/s7_ppi/telegram.hpp"

#include <algorithm>

#include "core/codec/checksum.hpp"

namespace fieldcast::s7_ppi {

namespace {

Telegram parse_long(ByteView bytes) {
  const bool wrong = (bytes.size() > 1 && bytes[1] < kLinkHead) ||
                     (bytes.size() > 1 && bytes[1] + kLongFrame > kMaxLong) ||
                     (bytes.size() > 2 && bytes[2] != bytes[1]) ||
                     (bytes.size() > 3 && bytes[3] != kMarkLong);
  if (wrong) return {};
  if (bytes.size() < 4) return {.kind = Telegram::Kind::kOpen, .size = kLongFrame + kLinkHead};
  const std::size_t length = bytes[1];
  const std::size_t size = length + kLongFrame;
  if (bytes.size() < size) return {.kind = Telegram::Kind::kOpen, .size = size};
  const ByteView counted = bytes.subspan(4, length);
  if (sum8(counted) != bytes[size - 2] || bytes[size - 1] != kEnd)
    return {.kind = Telegram::Kind::kBroken};
  return {.kind = Telegram::Kind::kLong,
          .size = size,
          .to = counted[0],
          .from = counted[1],
          .control = counted[2],
          .message = counted.subspan(3)};
}

Telegram parse_short(ByteView bytes) {
  if (bytes.size() < kShortSize) return {.kind = Telegram::Kind::kOpen, .size = kShortSize};
  if (sum8(bytes.subspan(1, 3)) != bytes[4] || bytes[5] != kEnd)
    return {.kind = Telegram::Kind::kBroken};
  return {.kind = Telegram::Kind::kShort,
          .size = kShortSize,
          .to = bytes[1],
          .from = bytes[2],
          .control = bytes[3]};
}

// Its two bytes are addresses: other values show noise.
Telegram parse_token(ByteView bytes) {
  for (std::size_t i = 1; i < std::min<std::size_t>(bytes.size(), 3); ++i) {
    if (bytes[i] > kHighestAddress) return {};
  }
  return {.kind = bytes.size() < 3 ? Telegram::Kind::kOpen : Telegram::Kind::kToken, .size = 3};
}

}  // namespace

void append_long(Bytes& out, std::uint8_t to, std::uint8_t from, std::uint8_t control,
                 ByteView message) {
  const auto length = static_cast<std::uint8_t>(message.size() + kLinkHead);
  const Bytes head{kMarkLong, length, length, kMarkLong, to, from, control};
  append(out, head);
  append(out, message);
  out.push_back(sum8(ByteView(out).last(length)));
  out.push_back(kEnd);
}

void append_short(Bytes& out, std::uint8_t to, std::uint8_t from, std::uint8_t control) {
  const auto sum = static_cast<std::uint8_t>(to + from + control);
  const Bytes frame{kMarkShort, to, from, control, sum, kEnd};
  append(out, frame);
}

Telegram parse_telegram(ByteView bytes) {
  switch (bytes[0]) {
    case kMarkLong: return parse_long(bytes);
    case kMarkShort: return parse_short(bytes);
    case kMarkAcknowledge: return {.kind = Telegram::Kind::kAcknowledge};
    case kMarkToken: return parse_token(bytes);
    default: return {};
  }
}

}  // namespace fieldcast::s7_ppi
