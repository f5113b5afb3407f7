#include <algorithm>
#include <string>

#include "core/codec/checksum.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/protocol_entry.hpp"
#include "core/protocol/s7_ppi/areas.hpp"
#include "core/protocol/s7_ppi/s7_ppi.hpp"
#include "core/protocol/s7_ppi/telegram.hpp"

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
      case kMarkToken:
        if (bytes.size() < 3) break;
        writer_.add(at, 3, "token",
                    "to " + std::to_string(bytes[1]) + " from " + std::to_string(bytes[2]));
        return 3;
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
    writer_.deeper();
    unit(at + 4 + kLinkHead, counted.subspan(kLinkHead));
    writer_.higher();
    ends(at + 4 + length, bytes[4 + length], sum8(counted), bytes[5 + length]);
    return length + kLongFrame;
  }

  void unit(std::size_t at, ByteView bytes) {
    if (bytes.size() < 10 || bytes[0] != 0x32)
      return writer_.add(at, bytes.size(), "unit", to_hex(bytes), "no S7 unit");
    const bool response = bytes[1] == 0x02 || bytes[1] == 0x03;
    const std::size_t head = response ? 12 : 10;
    const char* kind = bytes[1] == 0x01   ? "01 request"
                       : response         ? "response"
                       : bytes[1] == 0x07 ? "07 user data"
                                          : "unknown";
    writer_.add(at + 1, 1, "kind", kind);
    writer_.add(at + 4, 2, "reference", to_hex(bytes.subspan(4, 2), '\0'));
    const std::size_t parameters = read_u16(bytes, 6);
    const std::size_t data = read_u16(bytes, 8);
    const bool fits = bytes.size() >= head && head + parameters + data == bytes.size();
    writer_.add(at + 6, 4, "lengths",
                "parameters " + std::to_string(parameters) + ", data " + std::to_string(data),
                fits ? "" : "they do not fit the telegram");
    if (!fits) return;
    if (response) {
      writer_.add(
          at + 10, 2, "error",
          read_u16(bytes, 10) == 0 ? "none" : device_code_words(kErrorCodes, read_u16(bytes, 10)));
    }
    parameters_and_data(at + head, bytes.subspan(head, parameters),
                        bytes.subspan(head + parameters), response);
  }

  void parameters_and_data(std::size_t at, ByteView parameters, ByteView data, bool response) {
    if (parameters.empty()) return;
    const bool memory = (parameters[0] == 0x04 || parameters[0] == 0x05) && parameters.size() >= 2;
    if (!memory) {
      writer_.add(at, parameters.size(), "parameters", to_hex(parameters));
      if (!data.empty()) writer_.add(at + parameters.size(), data.size(), "data", to_hex(data));
      return;
    }
    const bool read = parameters[0] == 0x04;
    const std::size_t items = parameters[1];
    const std::size_t needed = 2 + (response ? 0 : 12 * items);
    writer_.add(at, 2, "function",
                std::string(read ? "04 read, " : "05 write, ") + std::to_string(items) +
                    (items == 1 ? " item" : " items"),
                parameters.size() == needed
                    ? ""
                    : "the parameters are " + std::to_string(parameters.size()) +
                          " bytes, should be " + std::to_string(needed));
    writer_.deeper();
    for (std::size_t i = 0; !response && i < items && 2 + 12 * (i + 1) <= parameters.size(); ++i) {
      item(at + 2 + 12 * i, parameters.subspan(2 + 12 * i, 12));
    }
    const std::size_t start = at + parameters.size();
    if (response && !read)
      codes(start, data);
    else
      blocks(start, data, response);
    writer_.higher();
  }

  void item(std::size_t at, ByteView bytes) {
    const std::uint32_t address = read_u32(bytes, 8) & 0xFFFFFF;
    std::string name = "area " + hex(bytes[8]) + " ";
    bool counted = false;
    for (AreaIndex area = 0; area < kAreaCount; ++area) {
      if (kCodes[area].code != bytes[8]) continue;
      name = std::string(kAreas[area].name);
      counted = kCodes[area].counted;
    }
    std::string address_text = counted ? std::to_string(address) : std::to_string(address / 8);
    if (bytes[3] == 0x01) address_text += "." + std::to_string(address % 8);
    const bool right = bytes[0] == 0x12 && bytes[1] == 0x0A && bytes[2] == 0x10;
    writer_.add(at, 12, "item",
                name + address_text + ", type " + hex(bytes[3]) + ", count " +
                    std::to_string(read_u16(bytes, 4)),
                right ? "" : "an item begins 12 0A 10");
  }

  void codes(std::size_t at, ByteView data) {
    for (std::size_t i = 0; i < data.size(); ++i)
      writer_.add(at + i, 1, "result", hex(data[i]) + " " + std::string(item_code_text(data[i])));
  }

  void blocks(std::size_t at, ByteView data, bool response) {
    std::size_t start = 0;
    while (start + 4 <= data.size()) {
      const ByteView head = data.subspan(start, 4);
      std::size_t size = read_u16(head, 2);
      if (head[1] == 0x04) size /= 8;
      const bool fits = size <= data.size() - start - 4;
      if (response)
        writer_.add(at + start, 1, "result",
                    hex(head[0]) + " " + std::string(item_code_text(head[0])));
      size = std::min(size, data.size() - start - 4);
      writer_.add(at + start + 1, 3 + size, "data", to_hex(data.subspan(start + 4, size)),
                  fits ? "" : "longer than the telegram");
      start += 4 + size + size % 2;
    }
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
