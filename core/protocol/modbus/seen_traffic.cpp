#include <algorithm>
#include <string>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/modbus/areas.hpp"
#include "core/protocol/modbus/explain_pdu.hpp"
#include "core/protocol/modbus/framing.hpp"
#include "core/protocol/modbus/request.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::modbus {

namespace {

constexpr std::size_t kMaxExplained = 4096;  // bytes; a remark mentions the rest

std::string surplus_text(std::size_t count) {
  return std::to_string(count) + " bytes behind the frame";
}

Bytes crc_bytes(ByteView bytes) {
  const std::uint16_t crc = crc16_modbus(bytes);
  return {static_cast<std::uint8_t>(crc), static_cast<std::uint8_t>(crc >> 8)};
}
bool has_right_crc(ByteView frame) { return frame.size() >= 4 && ends_with_crc16(frame); }

// All bytes, or the length given by the fields if a valid CRC confirms it.
std::size_t first_frame(ByteView bytes) {
  if (has_right_crc(bytes) && bytes.size() <= kMaxRtuFrame) return bytes.size();
  if (bytes.size() < 2) return bytes.size();
  for (const std::size_t pdu :
       {response_pdu_size(bytes.subspan(1)), request_pdu_size(bytes.subspan(1))}) {
    if (pdu != 0 && pdu + 3 <= bytes.size() && has_right_crc(bytes.first(pdu + 3))) return pdu + 3;
  }
  return bytes.size();
}

// Stops at the first invalid pair.
Bytes bytes_of_digits(ByteView digits) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    const int high = ascii_digit(digits[i]);
    const int low = ascii_digit(digits[i + 1]);
    if (high < 0 || low < 0) break;
    bytes.push_back(static_cast<std::uint8_t>(high << 4 | low));
  }
  return bytes;
}

}  // namespace

std::vector<FrameField> explain_rtu(ByteView frame) {
  FieldWriter writer;
  if (frame.size() > kMaxExplained) frame = frame.first(kMaxExplained);
  const std::size_t length = first_frame(frame);
  const ByteView own = frame.first(length);
  if (own.size() < 4) {
    writer.remark(to_hex(own),
                  "too short for a frame: unit, function and CRC are 4 bytes at least");
    return writer.take();
  }
  writer.add(0, 1, "unit", unit_text(own[0], true));
  FieldWriter inner(1, 1, 1);
  explain_pdu(own.subspan(1, length - 3), inner);
  writer.append(inner.take());
  const ByteView crc = own.last(2);
  const Bytes right = crc_bytes(own.first(length - 2));
  const bool good = std::ranges::equal(crc, right);
  writer.add(length - 2, 2, "CRC", to_hex(crc, '\0'),
             good ? "" : "CRC is " + to_hex(crc, '\0') + ", should be " + to_hex(right, '\0'));
  if (length > kMaxRtuFrame)
    writer.remark(std::to_string(length) + " bytes", "longer than 256 bytes");
  if (length < frame.size())
    writer.add(length, frame.size() - length, "surplus", to_hex(frame.subspan(length)),
               surplus_text(frame.size() - length));
  return writer.take();
}

namespace {

// CR LF at `end`, and the characters after it.
void explain_ascii_end(ByteView frame, std::size_t end, bool too_long, FieldWriter& writer) {
  const bool ended = end + 1 < frame.size() && frame[end + 1] == '\n';
  writer.add(end, std::min<std::size_t>(2, frame.size() - end), "end", ended ? "CR LF" : "",
             ended ? "" : "CR LF is missing");
  if (too_long)
    writer.remark(std::to_string(frame.size()) + " characters", "longer than 513 characters");
  if (ended && end + 2 < frame.size()) {
    writer.add(end + 2, frame.size() - end - 2, "surplus", to_hex(frame.subspan(end + 2)),
               surplus_text(frame.size() - end - 2));
  }
}

}  // namespace

std::vector<FrameField> explain_ascii(ByteView frame) {
  FieldWriter writer;
  if (frame.size() > kMaxExplained) frame = frame.first(kMaxExplained);
  const auto cr = std::ranges::find(frame, '\r');
  // A colon restarts the frame at any time.
  const auto colon = std::find(std::make_reverse_iterator(cr), frame.rend(), ':').base();
  if (colon == frame.begin()) {
    writer.remark(to_hex(frame), "no ':' begins a frame");
    return writer.take();
  }
  const auto start = static_cast<std::size_t>(colon - frame.begin());  // after the colon
  if (start > 1) writer.add(0, start - 1, "ignored", to_hex(frame.first(start - 1)));
  const ByteView digits(colon, cr);
  const Bytes bytes = bytes_of_digits(digits);
  if (bytes.size() * 2 != digits.size()) {
    const std::size_t at = bytes.size() * 2;
    writer.add(start + at, digits.size() - at, "digits", to_hex(digits.subspan(at)),
               digits.size() - at == 1 ? "an odd number of digits" : "not hexadecimal digits");
  }
  if (bytes.size() < 3) {
    writer.remark("", "too short for a frame: unit, function and LRC are 6 digits at least");
    return writer.take();
  }
  const std::size_t last = bytes.size() - 1;
  FieldWriter outer(start, 2);
  outer.add(0, 1, "unit", unit_text(bytes[0], true));
  writer.append(outer.take());
  FieldWriter inner(start + 2, 2, 1);
  explain_pdu(ByteView(bytes).subspan(1, last - 1), inner);
  writer.append(inner.take());
  const Bytes right{lrc8(ByteView(bytes).first(last))};
  const std::string lrc = to_hex(ByteView(bytes).last(1));
  writer.add(start + 2 * last, 2, "LRC", lrc,
             right[0] == bytes[last] ? "" : "LRC is " + lrc + ", should be " + to_hex(right));
  explain_ascii_end(frame, static_cast<std::size_t>(cr - frame.begin()), bytes.size() > 255,
                    writer);
  return writer.take();
}

std::vector<FrameField> explain_tcp(ByteView frame) {
  FieldWriter writer;
  if (frame.size() > kMaxExplained) frame = frame.first(kMaxExplained);
  if (frame.size() < 8) {
    writer.remark(to_hex(frame), "too short for a frame: the header and a function are 8 bytes");
    return writer.take();
  }
  const std::size_t counted = read_u16(frame, 4);
  const std::size_t present = frame.size() - 6;
  writer.add(0, 2, "transaction",
             to_hex(frame.first(2), '\0') + " = " + std::to_string(read_u16(frame)));
  writer.add(2, 2, "protocol", to_hex(frame.subspan(2, 2), '\0'),
             read_u16(frame, 2) == 0 ? "" : "must be 0000");
  std::string fault;
  if (counted < 2 || counted > 254)
    fault = "must be 2..254";
  else if (counted > present)
    fault = "only " + std::to_string(present) + " bytes follow";
  writer.add(4, 2, "length", std::to_string(counted), fault);
  writer.add(6, 1, "unit", unit_text(frame[6], false));
  const std::size_t inside = std::clamp<std::size_t>(counted, 2, present);
  FieldWriter inner(7, 1, 1);
  explain_pdu(frame.subspan(7, inside - 1), inner);
  writer.append(inner.take());
  if (inside < present)
    writer.add(6 + inside, present - inside, "surplus", to_hex(frame.subspan(6 + inside)),
               surplus_text(present - inside));
  return writer.take();
}

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

// Groups of function 20, or of function 21 with their registers.
bool holds_groups(ByteView pdu) {
  std::size_t at = 2;
  while (at + kGroupBytes <= pdu.size() && pdu[at] == 6)
    at += kGroupBytes + (pdu[0] == 21 ? 2 * std::size_t{read_u16(pdu, at + 5)} : 0);
  return at > 2 && at == pdu.size();
}

// REQUIRES: pdu has request_pdu_size(pdu) bytes.
bool fields_fit(ByteView pdu) {
  switch (pdu[0]) {
    case 1:
    case 2:
    case 3:
    case 4: return within(read_u16(pdu, 3), row_of_function(pdu[0]).most);
    case 5: return pdu[4] == 0 && (pdu[3] == 0 || pdu[3] == 0xFF);
    case 6:
    case 22:
    case 24: return true;
    case 15: return counts_bytes_of_bits(pdu);
    case 16: return counts_bytes_of_registers(pdu, 3, kMaxWriteRegisters);
    case 20:
    case 21: return holds_groups(pdu);
    case 23:
      return within(read_u16(pdu, 3), kMaxReadRegisters) &&
             counts_bytes_of_registers(pdu, 7, kMaxReadWriteRegisters);
    case 43: return pdu[1] == 0x0E && within(pdu[2], 4);
    default: return false;
  }
}

// Responses to single writes repeat the request; those to reads may have its length.
bool differs_from_responses(ByteView pdu) {
  const bool repeated = pdu[0] == 5 || pdu[0] == 6 || pdu[0] == 21 || pdu[0] == 22;
  return !repeated && response_pdu_size(pdu) != pdu.size();
}

}  // namespace

SeenRequest seen_rtu_request(ByteView bytes) {
  if (bytes.size() < 2 || bytes[0] > kLastUnit) return {};
  const std::size_t pdu_size = request_pdu_size(bytes.subspan(1));
  const std::size_t size = pdu_size + kRtuEnvelope;
  if (pdu_size == 0 || size > kMaxRtuFrame || size > bytes.size()) return {};
  const ByteView pdu = bytes.subspan(1, pdu_size);
  if (!fields_fit(pdu)) return {};
  if (!ends_with_crc16(bytes.first(size))) return {};
  return {size, differs_from_responses(pdu)};
}

SeenRequest seen_ascii_request(ByteView bytes) {
  if (bytes.empty() || bytes[0] != ':') return {};
  const auto cr = std::ranges::find(bytes, '\r');
  if (cr == bytes.end() || cr + 1 == bytes.end() || *(cr + 1) != '\n') return {};
  // Masters write upper-case digits; some devices do not.
  const auto frame = read_hex_bytes(ByteView(bytes.begin() + 1, cr));
  if (!frame || frame->size() < kLeastAscii || frame->size() > kMaxPdu + 2) return {};
  if (sum8(*frame) != 0 || frame->front() > kLastUnit) return {};
  const ByteView pdu = ByteView(*frame).subspan(1, frame->size() - 2);
  if (request_pdu_size(pdu) != pdu.size() || !fields_fit(pdu)) return {};
  return {static_cast<std::size_t>(cr - bytes.begin()) + 2, differs_from_responses(pdu)};
}

}  // namespace fieldcast::modbus
