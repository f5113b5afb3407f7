#include "core/protocol/allen_bradley_df1/frame.hpp"

#include <algorithm>

#include "core/codec/checksum.hpp"

namespace fieldcast::df1 {
namespace {

void append_data(Bytes& out, ByteView data) {
  for (const std::uint8_t byte : data) {
    if (byte == kDle) out.push_back(kDle);
    out.push_back(byte);
  }
}

}  // namespace

Bytes check_of(ByteView packet, Check check, std::optional<std::uint8_t> station) {
  Bytes counted;
  if (station) counted.push_back(*station);
  if (check == Check::kBcc) {
    append(counted, packet);
    return {lrc8(counted)};
  }
  if (station) counted.push_back(kStx);
  append(counted, packet);
  counted.push_back(kEtx);
  const std::uint16_t crc = crc16_arc(counted);
  return {static_cast<std::uint8_t>(crc), static_cast<std::uint8_t>(crc >> 8)};
}

void append_packet(Bytes& out, ByteView packet, Check check, std::optional<std::uint8_t> station) {
  if (station) {
    append_symbol(out, kSoh);
    append_data(out, {&*station, 1});
  }
  append_symbol(out, kStx);
  append_data(out, packet);
  append_symbol(out, kEtx);
  append(out, check_of(packet, check, station));
}

void append_poll(Bytes& out, std::uint8_t station) {
  append_symbol(out, kEnq);
  append_data(out, {&station, 1});
  out.push_back(lrc8({&station, 1}));
}

Body parse_body(ByteView bytes) {
  Body body{.data = {}, .size = 2};
  while (body.size < bytes.size() && body.data.size() <= kMaxPacket) {
    const std::uint8_t byte = bytes[body.size];
    if (byte != kDle) {
      body.data.push_back(byte);
      ++body.size;
      continue;
    }
    if (body.size + 1 == bytes.size()) return body;
    const std::uint8_t next = bytes[body.size + 1];
    body.broken = next != kDle && next != kEtx && next != kAck && next != kNak;
    if (body.broken) return body;
    body.size += 2;
    if (next == kDle) body.data.push_back(kDle);
    body.ended = next == kEtx;
    if (body.ended) return body;
  }
  body.broken = body.data.size() > kMaxPacket;
  return body;
}

Symbol parse_symbol(ByteView bytes, Check check) {
  using Kind = Symbol::Kind;
  if (bytes[0] != kDle) return {};
  if (bytes.size() == 1) return {.kind = Kind::kOpen, .missing = 1};
  const std::uint8_t code = bytes[1];
  if (code == kAck || code == kNak || code == kEnq || code == kEot)
    return {.kind = Kind::kControl, .size = 2, .control = code};
  if (code != kStx) return {};
  Body body = parse_body(bytes);
  if (body.broken) return {.kind = Kind::kBroken, .size = body.size};
  if (!body.ended)
    return {.kind = Kind::kOpen, .size = bytes.size(), .missing = 2 + size_of(check)};
  const std::size_t size = body.size + size_of(check);
  if (bytes.size() < size)
    return {.kind = Kind::kOpen, .size = bytes.size(), .missing = size - bytes.size()};
  const bool right = std::ranges::equal(check_of(body.data, check, std::nullopt),
                                        bytes.subspan(body.size, size_of(check)));
  return {
      .kind = right ? Kind::kPacket : Kind::kBroken, .size = size, .packet = std::move(body.data)};
}

}  // namespace fieldcast::df1
