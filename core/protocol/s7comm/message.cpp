#include "core/protocol/s7comm/message.hpp"

#include <algorithm>

namespace fieldcast::s7comm {
namespace {

constexpr std::uint8_t kProtocol = 0x32, kJob = 0x01, kAck = 0x02, kAckData = 0x03;
constexpr std::uint8_t kRead = 0x04, kWrite = 0x05, kGood = 0xFF;
constexpr std::size_t kJobHead = 10, kAckHead = 12, kItem = 12, kDataHead = 4;
constexpr std::uint8_t kBits = 0x03, kBytesInBits = 0x04, kOctets = 0x09;  // TS of data

std::size_t data_size(const Memory& memory, const Range& range) {
  return std::size_t{range.count} * memory.codes[range.area].item_size;
}
std::size_t even(std::size_t size) { return size + size % 2; }

bool reaches(const Memory& memory, const Range& range, bool write) {
  return fits(memory.areas, range, write) &&
         in_one_bank(memory.areas[range.area], range.first, range.end());
}

std::optional<MessageSizes> sizes_of(const Memory& memory, const ReadRequest& read) {
  if (read.ranges.empty() || read.ranges.size() > kMaxItems) return std::nullopt;
  MessageSizes sizes{kJobHead + 2 + kItem * read.ranges.size(), kAckHead + 2};
  for (const Range& range : read.ranges) {
    if (!reaches(memory, range, false)) return std::nullopt;
    const std::size_t size = data_size(memory, range);
    const bool last = &range == &read.ranges.back();
    sizes.response += kDataHead + (last ? size : even(size));
  }
  if (sizes.request > memory.pdu || sizes.response > memory.pdu) return std::nullopt;
  return sizes;
}

std::optional<MessageSizes> sizes_of(const Memory& memory, const WriteRequest& write) {
  const Range& range = write.range;
  if (!reaches(memory, range, true)) return std::nullopt;
  const Area& area = memory.areas[range.area];
  if (write.items.size() != image_bytes(area.item_bits, range.count)) return std::nullopt;
  if (write.bit && (!area.bit_write || range.count != 1 || *write.bit > 7)) return std::nullopt;
  return MessageSizes{kJobHead + 2 + kItem + kDataHead + write.items.size(), kAckHead + 2 + 1};
}

void append_item(Bytes& out, const Memory& memory, const Range& range,
                 std::optional<std::uint8_t> bit = {}) {
  const AreaCode& code = memory.codes[range.area];
  const std::uint32_t first = code.blocks ? range.first % kBlockBytes : range.first;
  const std::uint32_t address =
      code.counted ? first : first * memory.areas[range.area].item_bits + bit.value_or(0);
  append(out, Bytes{0x12, 0x0A, 0x10, bit ? std::uint8_t{1} : code.transport});
  append_u16(out, static_cast<std::uint16_t>(range.count));
  append_u16(out,
             code.blocks ? static_cast<std::uint16_t>(range.first / kBlockBytes + 1) : code.block);
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

// Timers and counters may have a status byte before each value.
std::optional<Bytes> image_of(ByteView data, const Memory& memory, const Range& range) {
  const std::size_t wanted = memory.areas[range.area].item_bits / 8;
  if (data.size() % range.count != 0) return std::nullopt;
  const std::size_t each = data.size() / range.count;
  const bool with_status = memory.codes[range.area].counted && each == wanted + 1;
  if (each != wanted && !with_status) return std::nullopt;
  Bytes image;
  for (std::size_t at = 0; at < data.size(); at += each)
    append(image, data.subspan(at + each - wanted, wanted));
  return image;
}

std::optional<Reply> read_reply(ByteView data, const Memory& memory, const ReadRequest& read) {
  Reply reply;
  for (const Range& range : read.ranges) {
    if (data.size() < kDataHead) return std::nullopt;
    const std::uint8_t code = data[0];
    const auto size = code == kGood ? announced(data[1], read_u16(data, 2)) : std::size_t{0};
    if (!size || *size > data.size() - kDataHead) return std::nullopt;
    if (code == kGood) {
      auto image = image_of(data.subspan(kDataHead, *size), memory, range);
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

std::optional<MessageSizes> message_sizes(const Memory& memory, const Request& request) {
  if (const auto* read = std::get_if<ReadRequest>(&request)) return sizes_of(memory, *read);
  if (const auto* write = std::get_if<WriteRequest>(&request)) return sizes_of(memory, *write);
  return std::nullopt;
}

Bytes message_of(const Memory& memory, const Request& request, std::uint16_t reference) {
  Bytes message;
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    append_head(message, reference, 2 + kItem * read->ranges.size(), 0);
    append(message, Bytes{kRead, static_cast<std::uint8_t>(read->ranges.size())});
    for (const Range& range : read->ranges) append_item(message, memory, range);
    return message;
  }
  const auto& write = std::get<WriteRequest>(request);
  append_head(message, reference, 2 + kItem, kDataHead + write.items.size());
  append(message, Bytes{kWrite, 1});
  append_item(message, memory, write.range, write.bit);
  if (write.bit) {
    append(message,
           Bytes{0, kBits, 0, 1, static_cast<std::uint8_t>(write.items[0] >> *write.bit & 1)});
  } else {
    append(message, Bytes{0, kBytesInBits});
    append_u16(message, static_cast<std::uint16_t>(write.items.size() * 8));
    append(message, write.items);
  }
  return message;
}

Judgement judge(ByteView message, const Memory& memory, const Request& request,
                std::uint16_t reference) {
  using Kind = Judgement::Kind;
  if (message.size() < kAckHead || message[0] != kProtocol ||
      (message[1] != kAckData && message[1] != kAck))
    return {Kind::kMalformed};
  if (read_u16(message, 4) != reference) return {Kind::kForeign};
  const std::size_t parameters = read_u16(message, 6);
  const std::size_t data = read_u16(message, 8);
  if (kAckHead + parameters + data != message.size()) return {Kind::kMalformed};
  if (const std::uint16_t error = read_u16(message, 10); error != 0) return {Kind::kRefused, error};
  const auto* read = std::get_if<ReadRequest>(&request);
  const std::size_t items = read != nullptr ? read->ranges.size() : 1;
  if (parameters != 2 || message[kAckHead] != (read != nullptr ? kRead : kWrite) ||
      message[kAckHead + 1] != items)
    return {Kind::kMalformed};
  const ByteView body = message.subspan(kAckHead + 2);
  if (read == nullptr) {
    if (body.size() != 1) return {Kind::kMalformed};
    if (body[0] != kGood) return {Kind::kRefused, body[0]};
    return {Kind::kResponse, 0, Reply(1)};
  }
  auto reply = read_reply(body, memory, *read);
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

}  // namespace fieldcast::s7comm
