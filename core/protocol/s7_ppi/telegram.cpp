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
          .unit = counted.subspan(3)};
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
                 ByteView unit) {
  const auto length = static_cast<std::uint8_t>(unit.size() + kLinkHead);
  const Bytes head{kMarkLong, length, length, kMarkLong, to, from, control};
  append(out, head);
  append(out, unit);
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

namespace {

constexpr std::uint8_t kProtocol = 0x32, kJob = 0x01, kAck = 0x02, kAckData = 0x03;
constexpr std::uint8_t kRead = 0x04, kWrite = 0x05, kGood = 0xFF;
constexpr std::size_t kJobHead = 10, kAckHead = 12, kItem = 12, kDataHead = 4, kMaxPdu = 240;
constexpr std::uint8_t kBits = 0x03, kBytesInBits = 0x04, kOctets = 0x09;  // TS of data

std::size_t data_size(const Range& range) {
  return std::size_t{range.count} * kCodes[range.area].item_size;
}
std::size_t even(std::size_t size) { return size + size % 2; }

std::optional<UnitSizes> sizes_of(const ReadRequest& read) {
  if (read.ranges.empty() || read.ranges.size() > kMaxItems) return std::nullopt;
  UnitSizes sizes{kJobHead + 2 + kItem * read.ranges.size(), kAckHead + 2};
  for (const Range& range : read.ranges) {
    if (!fits(kAreas, range, false)) return std::nullopt;
    const bool last = &range == &read.ranges.back();
    sizes.response += kDataHead + (last ? data_size(range) : even(data_size(range)));
  }
  if (sizes.request > kMaxPdu || sizes.response > kMaxPdu) return std::nullopt;
  return sizes;
}

std::optional<UnitSizes> sizes_of(const WriteRequest& write) {
  const Range& range = write.range;
  if (!fits(kAreas, range, true)) return std::nullopt;
  if (write.items.size() != image_bytes(kAreas[range.area].item_bits, range.count))
    return std::nullopt;
  if (write.bit && (!kAreas[range.area].bit_write || range.count != 1 || *write.bit > 7))
    return std::nullopt;
  return UnitSizes{kJobHead + 2 + kItem + kDataHead + write.items.size(), kAckHead + 2 + 1};
}

void append_item(Bytes& out, const Range& range, std::optional<std::uint8_t> bit = {}) {
  const AreaCode& code = kCodes[range.area];
  std::uint32_t address = range.first;
  if (!code.counted) address = address * (kAreas[range.area].item_bits / 8) * 8 + bit.value_or(0);
  append(out, Bytes{0x12, 0x0A, 0x10, bit ? std::uint8_t{1} : code.transport});
  append_u16(out, static_cast<std::uint16_t>(range.count));
  append_u16(out, range.area == kV ? 1 : 0);
  append_u32(out, std::uint32_t{code.code} << 24 | address);
}

void append_head(Bytes& out, std::uint16_t reference, std::size_t parameters, std::size_t data) {
  append(out, Bytes{kProtocol, kJob, 0, 0});
  append_u16(out, reference);
  append_u16(out, static_cast<std::uint16_t>(parameters));
  append_u16(out, static_cast<std::uint16_t>(data));
}

// Empty for a transport size that memory never uses.
std::optional<std::size_t> announced(std::uint8_t transport, std::uint16_t length) {
  if (transport == kBytesInBits)
    return length % 8 == 0 ? std::optional<std::size_t>{length / 8} : std::nullopt;
  if (transport == kOctets || transport == kBits) return length;
  return std::nullopt;
}

// Timers, counters and high-speed counters may have a status byte before each value.
std::optional<Bytes> image_of(ByteView data, const Range& range) {
  const std::size_t wanted = kAreas[range.area].item_bits / 8;
  if (data.size() % range.count != 0) return std::nullopt;
  const std::size_t each = data.size() / range.count;
  const bool with_status = kCodes[range.area].counted && each == wanted + 1;
  if (each != wanted && !with_status) return std::nullopt;
  Bytes image;
  for (std::size_t at = 0; at < data.size(); at += each)
    append(image, data.subspan(at + each - wanted, wanted));
  return image;
}

std::optional<Reply> read_reply(ByteView data, const ReadRequest& read) {
  Reply reply;
  for (const Range& range : read.ranges) {
    if (data.size() < kDataHead) return std::nullopt;
    const std::uint8_t code = data[0];
    const auto size = code == kGood ? announced(data[1], read_u16(data, 2)) : std::size_t{0};
    if (!size || *size > data.size() - kDataHead) return std::nullopt;
    if (code == kGood) {
      auto image = image_of(data.subspan(kDataHead, *size), range);
      if (!image) return std::nullopt;
      reply.push_back({.items = std::move(*image)});
    } else {
      reply.push_back({.cause = device_code_cause(kErrorCodes, code), .device_code = code});
    }
    const bool last = &range == &read.ranges.back();
    const std::size_t taken = kDataHead + (last ? *size : even(*size));
    if (taken > data.size()) return std::nullopt;
    data = data.subspan(taken);
  }
  if (data.size() > 1) return std::nullopt;  // a fill byte may follow even the last item
  return reply;
}

}  // namespace

std::optional<UnitSizes> unit_sizes(const Request& request) {
  if (const auto* read = std::get_if<ReadRequest>(&request)) return sizes_of(*read);
  if (const auto* write = std::get_if<WriteRequest>(&request)) return sizes_of(*write);
  return std::nullopt;
}

Bytes unit_of(const Request& request, std::uint16_t reference) {
  Bytes unit;
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    append_head(unit, reference, 2 + kItem * read->ranges.size(), 0);
    append(unit, Bytes{kRead, static_cast<std::uint8_t>(read->ranges.size())});
    for (const Range& range : read->ranges) append_item(unit, range);
    return unit;
  }
  const auto& write = std::get<WriteRequest>(request);
  append_head(unit, reference, 2 + kItem, kDataHead + write.items.size());
  append(unit, Bytes{kWrite, 1});
  append_item(unit, write.range, write.bit);
  if (write.bit) {
    append(unit,
           Bytes{0, kBits, 0, 1, static_cast<std::uint8_t>(write.items[0] >> *write.bit & 1)});
  } else {
    append(unit, Bytes{0, kBytesInBits});
    append_u16(unit, static_cast<std::uint16_t>(write.items.size() * 8));
    append(unit, write.items);
  }
  return unit;
}

Judgement judge_unit(ByteView unit, const Request& request, std::uint16_t reference) {
  using Kind = Judgement::Kind;
  if (unit.size() < kAckHead || unit[0] != kProtocol || (unit[1] != kAckData && unit[1] != kAck))
    return {Kind::kMalformed};
  if (read_u16(unit, 4) != reference) return {Kind::kForeign};
  const std::size_t parameters = read_u16(unit, 6);
  const std::size_t data = read_u16(unit, 8);
  if (kAckHead + parameters + data != unit.size()) return {Kind::kMalformed};
  if (const std::uint16_t error = read_u16(unit, 10); error != 0) return {Kind::kRefused, error};
  const auto* read = std::get_if<ReadRequest>(&request);
  const std::size_t items = read != nullptr ? read->ranges.size() : 1;
  if (parameters != 2 || unit[kAckHead] != (read != nullptr ? kRead : kWrite) ||
      unit[kAckHead + 1] != items)
    return {Kind::kMalformed};
  const ByteView body = unit.subspan(kAckHead + 2);
  if (read == nullptr) {
    if (body.size() != 1) return {Kind::kMalformed};
    if (body[0] != kGood) return {Kind::kRefused, body[0]};
    return {Kind::kResponse, 0, Reply(1)};
  }
  auto reply = read_reply(body, *read);
  if (!reply) return {Kind::kMalformed};
  if (items == 1 && reply->front().cause != Cause::kNone)
    return {Kind::kRefused, reply->front().device_code};
  return {Kind::kResponse, 0, std::move(*reply)};
}

std::string_view item_code_text(std::uint8_t code) {
  if (code == kGood) return "good";
  const auto text = device_code_text(kErrorCodes, code);
  return text.empty() ? "unknown code" : text;
}

}  // namespace fieldcast::s7_ppi
