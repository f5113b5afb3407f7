#include "core/protocol/seen_request.hpp"

#include <algorithm>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/modbus/function.hpp"

namespace fieldcast::modbus {
namespace {

constexpr std::size_t kRtuEnvelope = 3;  // unit, CRC
constexpr std::size_t kLeastAscii = 3;   // unit, function, LRC
constexpr std::uint8_t kLastUnit = 247;

bool within(std::size_t value, std::size_t limit) { return value >= 1 && value <= limit; }

bool counts_bytes_of_bits(ByteView pdu) {
  return within(read_u16(pdu, 3), kMaxWriteBits) && pdu[5] == (read_u16(pdu, 3) + 7) / 8;
}
bool counts_bytes_of_registers(ByteView pdu, std::size_t quantity_at, std::size_t limit) {
  const std::size_t quantity = read_u16(pdu, quantity_at);
  return within(quantity, limit) && pdu[quantity_at + 2] == 2 * quantity;
}

// REQUIRES: pdu has request_pdu_size(pdu) bytes.
bool fields_fit(ByteView pdu) {
  switch (pdu[0]) {
    case 1:
    case 2: return within(read_u16(pdu, 3), kMaxReadBits);
    case 3:
    case 4: return within(read_u16(pdu, 3), kMaxReadRegisters);
    case 5: return pdu[4] == 0 && (pdu[3] == 0 || pdu[3] == 0xFF);
    case 6:
    case 22: return true;
    case 15: return counts_bytes_of_bits(pdu);
    case 16: return counts_bytes_of_registers(pdu, 3, kMaxWriteRegisters);
    case 23:
      return within(read_u16(pdu, 3), kMaxReadRegisters) &&
             counts_bytes_of_registers(pdu, 7, kMaxReadWriteRegisters);
    default: return false;
  }
}

// Responses to single writes repeat the request; those to reads may have its length.
bool differs_from_answers(ByteView pdu) {
  const bool repeated = pdu[0] == 5 || pdu[0] == 6 || pdu[0] == 22;
  return !repeated && answer_pdu_size(pdu) != pdu.size();
}

}  // namespace

SeenRequest seen_rtu_request(ByteView bytes) {
  if (bytes.size() < 2 || bytes[0] > kLastUnit) return {};
  const std::size_t pdu_size = request_pdu_size(bytes.subspan(1));
  const std::size_t size = pdu_size + kRtuEnvelope;
  if (pdu_size == 0 || size > kMaxRtuFrame || size > bytes.size()) return {};
  const ByteView pdu = bytes.subspan(1, pdu_size);
  if (!fields_fit(pdu)) return {};
  const std::uint16_t crc = crc16_modbus(bytes.first(size - 2));
  if (crc != (bytes[size - 2] | bytes[size - 1] << 8)) return {};
  return {size, differs_from_answers(pdu)};
}

SeenRequest seen_ascii_request(ByteView bytes) {
  if (bytes.empty() || bytes[0] != ':') return {};
  const auto cr = std::find(bytes.begin(), bytes.end(), '\r');
  if (cr == bytes.end() || cr + 1 == bytes.end() || *(cr + 1) != '\n') return {};
  // Masters write upper-case digits; some devices do not.
  const auto frame = read_hex_bytes(ByteView(bytes.begin() + 1, cr));
  if (!frame || frame->size() < kLeastAscii || frame->size() > kMaxPdu + 2) return {};
  if (sum8(*frame) != 0 || frame->front() > kLastUnit) return {};
  const ByteView pdu = ByteView(*frame).subspan(1, frame->size() - 2);
  if (request_pdu_size(pdu) != pdu.size() || !fields_fit(pdu)) return {};
  return {static_cast<std::size_t>(cr - bytes.begin()) + 2, differs_from_answers(pdu)};
}

}  // namespace fieldcast::modbus
