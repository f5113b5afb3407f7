#include "core/capture/upper_pdu.hpp"

namespace fieldcast {
namespace {

constexpr std::uint16_t kTagEnd = 0, kTagDissector = 12, kTagPortType = 24, kTagSourcePort = 25,
                        kTagDestinationPort = 26, kTagColumn = 33;
constexpr std::uint32_t kPortTypeTcp = 2;

void append_text(Bytes& out, std::uint16_t tag, std::string_view text) {
  const std::size_t padded = (text.size() + 3) / 4 * 4;
  append_u16(out, tag);
  append_u16(out, static_cast<std::uint16_t>(padded));
  out.insert(out.end(), text.begin(), text.end());
  out.resize(out.size() + padded - text.size());
}

void append_number(Bytes& out, std::uint16_t tag, std::uint32_t value) {
  append_u16(out, tag);
  append_u16(out, 4);
  append_u32(out, value);
}

std::string text_of(ByteView value) {
  std::string text(value.begin(), value.end());
  return text.substr(0, text.find('\0'));
}

}  // namespace

Bytes make_upper_pdu(std::string_view dissector, std::string_view column, Direction direction,
                     ByteView frame) {
  const bool sent = direction == Direction::kSent;
  Bytes out;
  append_text(out, kTagDissector, dissector);
  if (!column.empty()) append_text(out, kTagColumn, column);
  append_number(out, kTagPortType, kPortTypeTcp);
  append_number(out, kTagSourcePort, sent ? kMasterPort : kDevicePort);
  append_number(out, kTagDestinationPort, sent ? kDevicePort : kMasterPort);
  append_u16(out, kTagEnd);
  append_u16(out, 0);
  append(out, frame);
  return out;
}

std::optional<UpperPdu> parse_upper_pdu(ByteView bytes) {
  UpperPdu pdu;
  for (std::size_t at = 0; at + 4 <= bytes.size();) {
    const std::uint16_t tag = read_u16(bytes, at);
    const std::size_t length = read_u16(bytes, at + 2);
    at += 4;
    if (length > bytes.size() - at) return std::nullopt;
    const ByteView value = bytes.subspan(at, length);
    at += length;
    if (tag == kTagEnd) {
      pdu.frame = bytes.subspan(at);
      return pdu;
    }
    if (tag == kTagDissector) pdu.dissector = text_of(value);
    if (tag == kTagColumn) pdu.column = text_of(value);
    if (tag == kTagSourcePort && length == 4) pdu.source_port = read_u32(value);
    if (tag == kTagDestinationPort && length == 4) pdu.destination_port = read_u32(value);
  }
  return std::nullopt;
}

}  // namespace fieldcast
