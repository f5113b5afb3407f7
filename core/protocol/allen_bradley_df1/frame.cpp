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

Symbol parse_symbol(ByteView bytes, std::optional<Check> check) {
  using Kind = Symbol::Kind;
  if (bytes[0] != kDle) return {};
  if (bytes.size() == 1) return {.kind = Kind::kOpen, .missing = 1};
  const std::uint8_t code = bytes[1];
  if (code == kAck || code == kNak || code == kEnq || code == kEot)
    return {.kind = Kind::kControl, .size = kSymbol, .control = code};
  if (code != kStx) return {};
  const std::size_t check_size = check ? size_of(*check) : 0;
  Symbol symbol{.kind = Kind::kOpen, .size = kSymbol, .missing = kSymbol + check_size};
  for (std::uint8_t next = 0; next != kEtx;) {
    const ByteView left = bytes.subspan(symbol.size);
    const bool dle = !left.empty() && left[0] == kDle;
    if (left.size() < (dle ? kSymbol : 1)) return symbol;
    next = dle ? left[1] : 0;
    const bool known = !dle || next == kDle || next == kEtx || next == kAck || next == kNak;
    if (!known || symbol.packet.size() > kMaxPacket) symbol.kind = Kind::kBroken;
    if (symbol.kind == Kind::kBroken) return symbol;
    symbol.size += dle ? kSymbol : 1;
    if (!dle || next == kDle) symbol.packet.push_back(left[0]);
  }
  symbol.missing = std::max(symbol.size + check_size, bytes.size()) - bytes.size();
  if (symbol.missing > 0) return symbol;
  const bool right = !check || std::ranges::equal(check_of(symbol.packet, *check, std::nullopt),
                                                  bytes.subspan(symbol.size, check_size));
  symbol.kind = right ? Kind::kPacket : Kind::kBroken;
  symbol.size += check_size;
  return symbol;
}

}  // namespace fieldcast::df1
