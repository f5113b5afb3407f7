#include "tests/protocol/dtc/dtc_text.hpp"

#include "core/codec/checksum.hpp"
#include "tests/core/lzw_reference.hpp"

namespace fieldcast::test {

Bytes dtc_message(std::string_view hex_without_crc) {
  Bytes message = *from_hex(hex_without_crc);
  const std::uint16_t crc = crc16_modbus(message);
  message.push_back(static_cast<std::uint8_t>(crc));
  message.push_back(static_cast<std::uint8_t>(crc >> 8));
  return message;
}

Bytes dtc_plain(const Bytes& message) {
  Bytes packet{0};
  append_u16(packet, static_cast<std::uint16_t>(message.size()));
  append(packet, message);
  return packet;
}

Bytes dtc_compressed(const Bytes& message) {
  const Bytes codes = packed(reference_codes(message));
  Bytes packet{1};
  append_u16(packet, static_cast<std::uint16_t>(2 + codes.size()));
  append_u16(packet, static_cast<std::uint16_t>(message.size()));
  append(packet, codes);
  return packet;
}

Bytes dtc_unpacked(const Bytes& packet) {
  if (packet.size() < 3 || packet.size() != 3u + read_u16(packet, 1)) return {};
  if (packet[0] == 0) return {packet.begin() + 3, packet.end()};
  if (packet[0] != 1 || packet.size() < 5) return {};
  return reference_decode(ByteView(packet).subspan(5), read_u16(packet, 3)).value_or(Bytes{});
}

}  // namespace fieldcast::test
