#include "core/protocol/s7_tcp/iso_frame.hpp"

namespace fieldcast::s7_tcp {
namespace {

constexpr std::uint8_t kVersion = 3, kLast = 0x80;
constexpr std::uint8_t kTpduSize = 0xC0, kCallingTsap = 0xC1, kCalledTsap = 0xC2;
constexpr std::size_t kLeastTpdu = 2;  // length and type

void append_tpkt(Bytes& out, std::size_t size) {
  append(out, Bytes{kVersion, 0});
  append_u16(out, static_cast<std::uint16_t>(kTpktHeader + size));
}

}  // namespace

IsoFrame first_iso_frame(ByteView bytes, std::size_t most) {
  const IsoFrame hopeless{.kind = IsoFrame::Kind::kHopeless};
  if (!bytes.empty() && bytes[0] != kVersion) return hopeless;
  if (bytes.size() < kTpktHeader) return {};
  const std::size_t size = read_u16(bytes, 2);
  if (size < kTpktHeader + kLeastTpdu || size > most) return hopeless;
  if (bytes.size() < size) return {};
  const ByteView tpdu = bytes.first(size).subspan(kTpktHeader);
  const std::size_t header = std::size_t{tpdu[0]} + 1;
  if (header < kLeastTpdu || header > tpdu.size()) return hopeless;
  IsoFrame frame{IsoFrame::Kind::kWhole, size, static_cast<Tpdu>(tpdu[1] & 0xF0u), {}};
  if (frame.type != Tpdu::kData) return frame;
  // A PDU of at most 960 bytes fits one TPDU of 1024.
  if (header < 3 || (tpdu[2] & kLast) == 0) return hopeless;
  frame.message = tpdu.subspan(header);
  return frame;
}

void append_connect(Bytes& out, std::uint16_t local_tsap, std::uint16_t tsap) {
  Bytes tpdu{17, static_cast<std::uint8_t>(Tpdu::kConnect), 0, 0, 0, 1, 0, kTpduSize, 1, 10};
  append(tpdu, Bytes{kCallingTsap, 2});
  append_u16(tpdu, local_tsap);
  append(tpdu, Bytes{kCalledTsap, 2});
  append_u16(tpdu, tsap);
  append_tpkt(out, tpdu.size());
  append(out, tpdu);
}

void append_data(Bytes& out, ByteView message) {
  append_tpkt(out, 3 + message.size());
  append(out, Bytes{2, static_cast<std::uint8_t>(Tpdu::kData), kLast});
  append(out, message);
}

}  // namespace fieldcast::s7_tcp
