#include <algorithm>
#include <string>

#include "core/codec/checksum.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/protocol_entry.hpp"
#include "core/protocol/s7_ppi/s7_ppi.hpp"
#include "core/protocol/s7_ppi/telegram.hpp"
#include "core/protocol/s7comm/explain.hpp"
#include "core/protocol/s7comm/s7_200.hpp"

namespace fieldcast::s7_ppi {

namespace {

constexpr std::size_t kMaxExplained = 4096;

std::string hex(std::uint8_t byte) { return to_hex({&byte, 1}); }

std::string control_text(std::uint8_t control) {
  std::string text = hex(control);
  switch (control) {
    case 0x6C: return text + " first request";
    case 0x5C:
    case 0x7C: return text + " request, frame-count bit " + (control == 0x7C ? "1" : "0");
    case 0x49: return text + " status request";
    case 0x08: return text + " data";
    case 0x00: return text + " positive acknowledgement";
    case 0x02: return text + " no resource: ask again later";
    case 0x03: return text + " service not activated";
    case 0x09: return text + " no data";
    default: return text;
  }
}

class PpiExplainer {
 public:
  explicit PpiExplainer(ByteView frame) : frame_(frame) {}

  std::vector<FrameField> run() {
    std::size_t at = 0;
    while (at < frame_.size()) at += telegram(at);
    if (frame_.empty()) writer_.remark("", "nothing to explain");
    return writer_.take();
  }

 private:
  // Returns the size of the telegram.
  std::size_t telegram(std::size_t at) {
    const ByteView bytes = frame_.subspan(at);
    switch (bytes[0]) {
      case kMarkAcknowledge: writer_.add(at, 1, "acknowledge", "E5 received"); return 1;
      case 0xF9:  // sent by some CPUs after STOP and RUN
        writer_.add(at, 1, "acknowledge", "F9 done");
        return 1;
      case kMarkToken: return token(at, bytes);
      case kMarkShort: return short_telegram(at, bytes);
      case kMarkLong: return long_telegram(at, bytes);
      default: break;
    }
    writer_.add(at, bytes.size(), "noise", to_hex(bytes),
                "no telegram begins with " + hex(bytes[0]));
    return bytes.size();
  }

  void ends(std::size_t at, std::uint8_t sum, std::uint8_t right, std::uint8_t end) {
    writer_.add(at, 1, "FCS", hex(sum),
                sum == right ? "" : "FCS is " + hex(sum) + ", should be " + hex(right));
    writer_.add(at + 1, 1, "end", hex(end), end == kEnd ? "" : "must be 16");
  }

  void link(std::size_t at, ByteView bytes) {
    writer_.add(at, 1, "to", std::to_string(bytes[0]));
    writer_.add(at + 1, 1, "from", std::to_string(bytes[1]));
    writer_.add(at + 2, 1, "control", control_text(bytes[2]));
  }

  std::size_t token(std::size_t at, ByteView bytes) {
    if (bytes.size() < 3) {
      writer_.add(at, bytes.size(), "token", to_hex(bytes), "three bytes are needed");
      return bytes.size();
    }
    writer_.add(at, 3, "token",
                "to " + std::to_string(bytes[1]) + " from " + std::to_string(bytes[2]));
    return 3;
  }

  std::size_t short_telegram(std::size_t at, ByteView bytes) {
    if (bytes.size() < kShortSize) {
      writer_.add(at, bytes.size(), "short telegram", to_hex(bytes), "six bytes are needed");
      return bytes.size();
    }
    writer_.add(at, 1, "start", "10 short telegram");
    link(at + 1, bytes.subspan(1));
    ends(at + 4, bytes[4], sum8(bytes.subspan(1, 3)), bytes[5]);
    return kShortSize;
  }

  std::size_t long_telegram(std::size_t at, ByteView bytes) {
    if (bytes.size() < kLongFrame + kLinkHead) {
      writer_.add(at, bytes.size(), "data telegram", to_hex(bytes), "incomplete");
      return bytes.size();
    }
    writer_.add(at, 1, "start", "68 data telegram");
    const std::size_t length = bytes[1];
    writer_.add(at + 1, 2, "length", std::to_string(length),
                bytes[1] == bytes[2] ? "" : "the two lengths differ");
    if (bytes[3] != kMarkLong) writer_.add(at + 3, 1, "start", hex(bytes[3]), "must be 68 again");
    if (length < kLinkHead || length + kLongFrame > bytes.size()) {
      const std::string missing = "incomplete: " + std::to_string(bytes.size()) + " bytes of " +
                                  std::to_string(length + kLongFrame);
      writer_.add(at + 4, bytes.size() - 4, "rest", to_hex(bytes.subspan(4)),
                  length < kLinkHead ? "too short" : missing);
      return bytes.size();
    }
    const ByteView counted = bytes.subspan(4, length);
    link(at + 4, counted);
    FieldWriter inner(at + 4 + kLinkHead, 1, writer_.depth() + 1);
    s7comm::explain(counted.subspan(kLinkHead), s7comm::kS7226Memory, inner);
    writer_.append(inner.take());
    ends(at + 4 + length, bytes[4 + length], sum8(counted), bytes[5 + length]);
    return length + kLongFrame;
  }

  const ByteView frame_;
  FieldWriter writer_;
};

}  // namespace

std::vector<FrameField> explain(ByteView frame) {
  return PpiExplainer(frame.first(std::min(frame.size(), kMaxExplained))).run();
}

// Includes polls. Bit 6 of the frame control shows which side sends.
SeenRequest seen_request(ByteView bytes) {
  constexpr std::uint8_t kRequestFlag = 0x40;
  if (bytes.empty()) return {};
  const Telegram telegram = parse_telegram(bytes);
  const bool whole =
      telegram.kind == Telegram::Kind::kLong || telegram.kind == Telegram::Kind::kShort;
  const bool request = whole && (telegram.control & kRequestFlag) != 0 &&
                       telegram.to <= kHighestAddress && telegram.from <= kHighestAddress;
  return {request ? telegram.size : 0, true};
}

}  // namespace fieldcast::s7_ppi
