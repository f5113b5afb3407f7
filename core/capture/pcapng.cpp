#include "core/capture/pcapng.hpp"

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

namespace fieldcast::pcapng {

namespace {

constexpr std::uint8_t kMicroseconds = 6;      // if_tsresol: 10^-6
constexpr std::size_t kMaxOptionText = 60000;  // a length has 16 bits
constexpr std::size_t kBlockHeader = 8, kLengthBytes = 4;

void append_le(Bytes& out, std::uint64_t value, unsigned bytes) {
  for (unsigned i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

void pad(Bytes& out) { out.resize((out.size() + 3) / 4 * 4); }

// Writes its type and length around the data appended during its lifetime.
class Block {
 public:
  Block(Bytes& out, std::uint32_t type) : out_(out), begin_(out.size()) {
    append_le(out_, type, 4);
    append_le(out_, 0, kLengthBytes);
  }
  ~Block() {
    const std::size_t length = out_.size() - begin_ + kLengthBytes;
    for (unsigned i = 0; i < kLengthBytes; ++i)
      out_[begin_ + kBlockHeader - kLengthBytes + i] = static_cast<std::uint8_t>(length >> (8 * i));
    append_le(out_, length, kLengthBytes);
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  void number(std::uint64_t value, unsigned bytes) { append_le(out_, value, bytes); }
  void bytes(ByteView data) {
    append(out_, data);
    pad(out_);
  }
  void time(UtcTime at) {
    const auto microseconds = static_cast<std::uint64_t>(at.nanoseconds / 1000);
    append_le(out_, microseconds >> 32, 4);
    append_le(out_, microseconds & 0xFFFFFFFF, 4);
  }
  void text(std::uint16_t option, std::string_view text) {
    if (text.empty()) return;
    text = text.substr(0, kMaxOptionText);
    head(option, text.size());
    out_.insert(out_.end(), text.begin(), text.end());
    pad(out_);
  }
  void option(std::uint16_t option, std::uint64_t value, unsigned bytes) {
    head(option, bytes);
    append_le(out_, value, bytes);
    pad(out_);
  }
  void time_option(std::uint16_t option, UtcTime at) {
    head(option, 8);
    time(at);
  }
  void end_options() { head(kEndOfOptions, 0); }

 private:
  void head(std::uint16_t option, std::size_t length) {
    append_le(out_, option, 2);
    append_le(out_, length, 2);
  }

  Bytes& out_;
  const std::size_t begin_;
};

}  // namespace

void append_section(Bytes& out, std::string_view application, std::string_view comment) {
  Block block(out, kSectionHeader);
  block.number(kByteOrderMagic, 4);
  block.number(1, 2);  // version 1.0
  block.number(0, 2);
  block.number(~std::uint64_t{0}, 8);  // its length is unknown
  block.text(kComment, comment);
  block.text(kSectionApplication, application);
  block.end_options();
}

void append_interface(Bytes& out, std::string_view name, std::string_view description) {
  Block block(out, kInterfaceDescription);
  block.number(kLinktypeUpperPdu, 2);
  block.number(0, 2);
  block.number(0, 4);  // packets are not cut
  block.text(kIfName, name);
  block.text(kIfDescription, description);
  block.option(kIfTsresol, kMicroseconds, 1);
  block.end_options();
}

void append_packet(Bytes& out, const Packet& packet) {
  Block block(out, kEnhancedPacket);
  block.number(0, 4);  // the only interface
  block.time(packet.at);
  block.number(packet.data.size(), 4);
  block.number(packet.data.size(), 4);
  block.bytes(packet.data);
  block.text(kComment, packet.comment);
  block.option(kPacketFlags, packet.direction == Direction::kSent ? kOutbound : kInbound, 4);
  block.end_options();
}

void append_statistics(Bytes& out, const Statistics& statistics) {
  Block block(out, kInterfaceStatistics);
  block.number(0, 4);
  block.time(statistics.ended);
  block.text(kComment, statistics.comment);
  block.time_option(kIfStart, statistics.begun);
  block.time_option(kIfEnd, statistics.ended);
  block.option(kIfReceived, statistics.frames, 8);
  block.option(kIfDropped, statistics.dropped, 8);
  block.end_options();
}

}  // namespace fieldcast::pcapng
