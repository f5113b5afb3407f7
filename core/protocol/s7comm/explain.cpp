#include "core/protocol/s7comm/explain.hpp"

#include <algorithm>
#include <string>

#include "core/protocol/s7comm/message.hpp"

namespace fieldcast::s7comm {
namespace {

std::string hex(std::uint8_t byte) { return to_hex({&byte, 1}); }

class MessageExplainer {
 public:
  MessageExplainer(const Memory& memory, FieldWriter& writer) : memory_(memory), writer_(writer) {}

  void message(ByteView bytes) {
    if (bytes.size() < 10 || bytes[0] != 0x32)
      return writer_.add(0, bytes.size(), "message", to_hex(bytes), "no S7 message");
    const bool response = bytes[1] == 0x02 || bytes[1] == 0x03;
    const std::size_t head = response ? 12 : 10;
    const char* kind = bytes[1] == 0x01   ? "01 request"
                       : response         ? "response"
                       : bytes[1] == 0x07 ? "07 user data"
                                          : "unknown";
    writer_.add(1, 1, "kind", kind);
    writer_.add(4, 2, "reference", to_hex(bytes.subspan(4, 2), '\0'));
    const std::size_t parameters = read_u16(bytes, 6);
    const std::size_t data = read_u16(bytes, 8);
    const bool fits = bytes.size() >= head && head + parameters + data == bytes.size();
    writer_.add(6, 4, "lengths",
                "parameters " + std::to_string(parameters) + ", data " + std::to_string(data),
                fits ? "" : "they do not fit the message");
    if (!fits) return;
    if (response) {
      writer_.add(
          10, 2, "error",
          read_u16(bytes, 10) == 0 ? "none" : device_code_words(kErrorCodes, read_u16(bytes, 10)));
    }
    parameters_and_data(head, bytes.subspan(head, parameters), bytes.subspan(head + parameters),
                        response);
  }

 private:
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
    for (std::size_t i = 0; i < memory_.codes.size(); ++i) {
      const AreaCode& code = memory_.codes[i];
      if (code.code != bytes[8]) continue;
      name = std::string(memory_.areas[i].name);
      if (code.blocks) name += std::to_string(read_u16(bytes, 6)) + ".";
      counted = code.counted;
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
                  fits ? "" : "longer than the message");
      start += 4 + size + size % 2;
    }
  }

  const Memory& memory_;
  FieldWriter& writer_;
};

}  // namespace

void explain(ByteView message, const Memory& memory, FieldWriter& writer) {
  MessageExplainer(memory, writer).message(message);
}

}  // namespace fieldcast::s7comm
