#include "core/protocol/dtc/message.hpp"

#include <array>

#include "core/codec/checksum.hpp"
#include "core/protocol/dtc/types.hpp"

namespace fieldcast::dtc {
namespace {

bool fits(const Range& range) {
  return range.area < kTypeCount && range.count >= 1 && range.count <= 0xFFFF &&
         range.first < kVariables && range.count <= kVariables - range.first;
}

void append_group(Bytes& out, const Range& range) {
  append_u16(out, static_cast<std::uint16_t>(range.first));
  out.push_back(range.area);
  append_u16(out, static_cast<std::uint16_t>(range.count));
}

// Packs bits of one byte each, as in protocol.hpp, into eight per byte.
void append_bits(Bytes& out, ByteView bits) {
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (i % 8 == 0) out.push_back(0);
    out.back() = static_cast<std::uint8_t>(out.back() | (bits[i] != 0 ? 1u : 0u) << i % 8);
  }
}

Bytes image_of(const Range& range, ByteView data) {
  if (range.area != kBit) return {data.begin(), data.end()};
  Bytes bits(range.count);
  for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = data[i / 8] >> i % 8 & 1u;
  return bits;
}

}  // namespace

std::optional<MessageSizes> message_sizes(const Request& request, std::size_t longest) {
  MessageSizes sizes{kMessageHead + kCrcBytes, kMessageHead + kCrcBytes};
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    if (read->ranges.empty()) return std::nullopt;
    for (const Range& range : read->ranges) {
      if (!fits(range)) return std::nullopt;
      sizes.request += kGroupHead;
      sizes.answer += data_bytes(range.area, range.count);
    }
  } else if (const auto* write = std::get_if<WriteRequest>(&request)) {
    const Range& range = write->range;
    if (!fits(range) || write->bit ||
        write->items.size() != image_bytes(kTypeBits[range.area], range.count))
      return std::nullopt;
    sizes.request += kGroupHead + data_bytes(range.area, range.count);
  } else {
    return std::nullopt;
  }
  if (sizes.request > longest || sizes.answer > longest) return std::nullopt;
  return sizes;
}

Bytes message_of(std::uint8_t address, const Request& request) {
  Bytes message{address, kRead};
  if (const auto* write = std::get_if<WriteRequest>(&request)) {
    message[1] = kWrite;
    append_group(message, write->range);
    if (write->range.area == kBit)
      append_bits(message, write->items);
    else
      append(message, write->items);
  } else {
    for (const Range& range : std::get<ReadRequest>(request).ranges) append_group(message, range);
  }
  const std::uint16_t crc = crc16_modbus(message);
  message.push_back(static_cast<std::uint8_t>(crc));
  message.push_back(static_cast<std::uint8_t>(crc >> 8));
  return message;
}

bool crc_is_right(ByteView message) {
  const std::size_t end = message.size() - kCrcBytes;
  return crc16_modbus(message.first(end)) == (message[end] | message[end + 1] << 8);
}

Reply reply_of(const Request& request, ByteView data) {
  const auto* read = std::get_if<ReadRequest>(&request);
  if (read == nullptr) return Reply(1);
  Reply reply;
  reply.reserve(read->ranges.size());
  for (const Range& range : read->ranges) {
    const std::size_t size = data_bytes(range.area, range.count);
    reply.push_back({.items = image_of(range, data.first(size))});
    data = data.subspan(size);
  }
  return reply;
}

std::string_view refusal_text(std::uint8_t code) {
  const auto text = device_code_text(kRefusals, code);
  return text.empty() ? "no such code" : text;
}

}  // namespace fieldcast::dtc
