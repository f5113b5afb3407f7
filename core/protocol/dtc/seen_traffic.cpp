#include <algorithm>
#include <string>

#include "core/codec/checksum.hpp"
#include "core/codec/lzw.hpp"
#include "core/protocol/dtc/dtc.hpp"
#include "core/protocol/dtc/message.hpp"
#include "core/protocol/dtc/packet.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::dtc {

namespace {

constexpr std::size_t kMaxExplained = 2 * (kPacketHead + kMaxMessage);

std::string hex(std::uint8_t byte) { return to_hex({&byte, 1}); }

void explain_message(FieldWriter& writer, ByteView message) {
  writer.add(0, 1, "address", std::to_string(message[0]));
  const bool refused = (message[1] & kRefused) != 0;
  const std::uint8_t command = message[1] & static_cast<std::uint8_t>(~kRefused);
  const std::string name = command == kRead ? " read" : command == kWrite ? " write" : " unknown";
  writer.add(1, 1, "command", hex(message[1]) + name + (refused ? " refused" : ""),
             command > kWrite ? "neither 00 nor 01" : "");
  const ByteView rest = message.subspan(kMessageHead, message.size() - kMessageHead - kCrcBytes);
  if (refused) {
    writer.add(kMessageHead, rest.size(), "code",
               rest.empty() ? "" : hex(rest[0]) + " " + std::string(refusal_text(rest[0])),
               rest.size() == 1 ? "" : "a refusal has one byte of code");
  } else if (const bool write = command == kWrite; all_groups(rest, write)) {
    for (std::size_t at = 0; at < rest.size();) {
      const ByteView group = rest.subspan(at);
      const std::size_t size = group_size(group, write);
      std::string text = std::string(kTypeNames[group[2]]) + ":" + std::to_string(read_u16(group)) +
                         ", count " + std::to_string(read_u16(group, 3));
      if (write) text += " = " + to_hex(group.subspan(kGroupHead, size - kGroupHead));
      writer.add(kMessageHead + at, size, "group", text,
                 inside(group) ? "" : "beyond the last variable");
      at += size;
    }
  } else if (write && !rest.empty()) {
    writer.add(kMessageHead, rest.size(), "groups", to_hex(rest), "not a list of whole groups");
  } else if (!rest.empty()) {
    writer.add(kMessageHead, rest.size(), "data", to_hex(rest));
  }
  const std::size_t end = message.size() - kCrcBytes;
  Bytes right(message.begin(), message.end() - kCrcBytes);
  append_crc16(right);
  writer.add(
      end, kCrcBytes, "CRC", to_hex(message.last(kCrcBytes)),
      ends_with_crc16(message) ? "" : "should be " + to_hex(ByteView(right).last(kCrcBytes)));
}

// Returns the size of the packet, or of all bytes if there is none.
std::size_t explain_packet(FieldWriter& all, std::size_t at, ByteView bytes) {
  const ParseResult parsed = parse_packet(bytes);
  if (parsed.kind != ParseResult::Kind::kWhole) {
    const bool open = parsed.kind == ParseResult::Kind::kOpen;
    all.add(at, bytes.size(), "packet",
            to_hex(bytes.first(std::min<std::size_t>(bytes.size(), 64))),
            open ? "incomplete: " + std::to_string(bytes.size()) + " bytes of at least " +
                       std::to_string(parsed.size)
                 : "no packet: flag 00 or 01, then a length that a message can have");
    return bytes.size();
  }
  all.add(at, 1, "flag", parsed.compressed ? "01 compressed" : "00 plain");
  all.add(at + 1, 2, "length", std::to_string(parsed.size - kPacketHead));
  const std::size_t start = at + parsed.size - parsed.content.size();
  if (!parsed.compressed) {
    FieldWriter inner(start, 1, 1);
    explain_message(inner, parsed.content);
    all.append(inner.take());
    return parsed.size;
  }
  all.add(at + kPacketHead, 2, "original length", std::to_string(parsed.original));
  Bytes message;
  const auto expanded = lzw_decode(parsed.content, parsed.original, message);
  all.add(start, parsed.content.size(), "LZW codes",
          std::to_string(parsed.content.size()) + " bytes",
          expanded ? "" : std::string(to_text(expanded.error())));
  if (!expanded) return parsed.size;
  FieldWriter inner(start, 0, 1);  // compressed bytes have no own position on the wire
  explain_message(inner, message);
  all.append(inner.take());
  return parsed.size;
}

}  // namespace

std::vector<FrameField> explain(ByteView frame) {
  FieldWriter writer;
  frame = frame.first(std::min(frame.size(), kMaxExplained));
  for (std::size_t at = 0; at < frame.size();) at += explain_packet(writer, at, frame.subspan(at));
  if (frame.empty()) writer.remark("", "nothing to explain");
  return writer.take();
}

SeenRequest seen_request(ByteView bytes) {
  if (bytes.empty()) return {};
  const ParseResult parsed = parse_packet(bytes);
  if (parsed.kind != ParseResult::Kind::kWhole) return {};
  Bytes expanded;
  ByteView message = parsed.content;
  if (parsed.compressed) {
    if (!lzw_decode(parsed.content, parsed.original, expanded)) return {};
    message = expanded;
  }
  if (message.size() < kMinMessage || message[1] > kWrite || !ends_with_crc16(message)) return {};
  const bool write = message[1] == kWrite;
  const ByteView rest = message.subspan(kMessageHead, message.size() - kMessageHead - kCrcBytes);
  if (!all_groups(rest, write)) return {};
  return {parsed.size, write};  // the response to a write has no data
}

}  // namespace fieldcast::dtc
