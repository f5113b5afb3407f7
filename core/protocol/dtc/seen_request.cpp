#include "core/protocol/seen_request.hpp"

#include "core/codec/lzw.hpp"
#include "core/protocol/dtc/dtc.hpp"
#include "core/protocol/dtc/groups.hpp"
#include "core/protocol/dtc/message.hpp"
#include "core/protocol/dtc/packet.hpp"

namespace fieldcast::dtc {

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
  if (message.size() < kMinMessage || message[1] > kWrite || !crc_is_right(message)) return {};
  const bool write = message[1] == kWrite;
  const ByteView rest = message.subspan(kMessageHead, message.size() - kMessageHead - kCrcBytes);
  if (!all_groups(rest, write)) return {};
  return {parsed.size, write};  // the response to a write has no data
}

}  // namespace fieldcast::dtc
