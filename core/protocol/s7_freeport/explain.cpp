// S7 freeport frames for people.
#include <algorithm>
#include <array>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/s7_freeport/s7_freeport.hpp"

namespace fieldcast::s7_freeport {
namespace {

std::string_view refusal_text(std::uint32_t code) {
  const auto text = device_code_text(kRefusals, static_cast<std::uint16_t>(code));
  return text.empty() ? "no such code" : text;
}

}  // namespace

std::vector<FrameField> explain(ByteView frame) {
  FieldWriter writer;
  if (frame.empty()) return {FrameField{.name = "frame", .fault = "no character"}};
  const auto field = [&](std::size_t at, std::size_t length, const char* name,
                         const std::string& comment = {}) {
    const ByteView part = frame.subspan(at, length);
    const bool digits = read_digits(part.last(part.size() > 1 ? 2 : 1)).has_value() &&
                        read_hex_bytes(part).has_value();
    writer.add(at, length, name,
               std::string(part.begin(), part.end()) + (comment.empty() ? "" : " " + comment),
               digits ? "" : "not upper-case digits");
  };
  const bool marked = frame.size() > 2 && frame.front() == 'q' && frame.back() == 'Q';
  const bool refused = frame.size() == kRefusal;
  if (!marked || (frame.size() != kRequest && frame.size() != kAnswer && !refused)) {
    std::string text;
    for (const std::uint8_t c : frame.first(std::min<std::size_t>(frame.size(), 64)))
      text += c > ' ' && c < 0x7F ? static_cast<char>(c) : '.';
    const std::string what = frame.front() != 'q'  ? "begins without q"
                             : frame.back() != 'Q' ? "ends without Q"
                                                   : std::to_string(frame.size()) + " characters";
    writer.remark(text,
                  what + ": a request has 17 characters from q to Q, an answer 12, a refusal 7");
    return writer.take();
  }
  writer.remark(frame.size() == kRequest ? "request" : refused ? "refusal" : "answer");
  if (frame.size() == kRequest) {
    const bool known = frame[1] == 'W' || frame[1] == 'R';
    writer.add(1, 1, "command",
               frame[1] == 'W'   ? "W reads from the PLC"
               : frame[1] == 'R' ? "R writes to the PLC"
                                 : "",
               known ? "" : "neither W nor R");
    field(2, 2, "station");
    field(4, 2, "length");
    if (const auto length = read_digits(frame.subspan(4, 2));
        length && (*length < 1 || *length > 4))
      writer.remark("", "the length must be 01..04");
  } else if (refused) {
    writer.add(1, 1, "refusal", "E", frame[1] == 'E' ? "" : "must be E");
    field(2, 2, "code", std::string(refusal_text(read_digits(frame.subspan(2, 2)).value_or(0))));
  }
  if (!refused) field(frame.size() - 11, 8, "window");
  Bytes right;
  append_digits(right, xor8(frame.subspan(1, frame.size() - 4)), 2);
  const ByteView check = frame.subspan(frame.size() - 3, 2);
  const bool good = std::ranges::equal(check, right);
  writer.add(frame.size() - 3, 2, "check", std::string(check.begin(), check.end()),
             good ? "" : "should be " + std::string(right.begin(), right.end()));
  return writer.take();
}

}  // namespace fieldcast::s7_freeport
