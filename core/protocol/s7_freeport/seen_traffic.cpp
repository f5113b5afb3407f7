#include <algorithm>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/protocol_entry.hpp"
#include "core/protocol/s7_freeport/s7_freeport.hpp"

namespace fieldcast::s7_freeport {

namespace {

std::string_view refusal_text(std::uint32_t code) {
  const auto text = device_code_text(kRefusals, static_cast<std::uint16_t>(code));
  return text.empty() ? "no such code" : text;
}

void add_field(FieldWriter& writer, ByteView frame, std::size_t at, std::size_t length,
               const char* name, const std::string& comment = {}) {
  const ByteView part = frame.subspan(at, length);
  const bool digits = read_digits(part.last(part.size() > 1 ? 2 : 1)).has_value() &&
                      read_hex_bytes(part).has_value();
  writer.add(at, length, name,
             std::string(part.begin(), part.end()) + (comment.empty() ? "" : " " + comment),
             digits ? "" : "not upper-case digits");
}

void explain_no_frame(FieldWriter& writer, ByteView frame) {
  std::string text;
  for (const std::uint8_t c : frame.first(std::min<std::size_t>(frame.size(), 64)))
    text += c > ' ' && c < 0x7F ? static_cast<char>(c) : '.';
  const std::string what = frame.front() != 'q'  ? "begins without q"
                           : frame.back() != 'Q' ? "ends without Q"
                                                 : std::to_string(frame.size()) + " characters";
  writer.remark(text,
                what + ": a request has 17 characters from q to Q, a response 12, a refusal 7");
}

void explain_request(FieldWriter& writer, ByteView frame) {
  const bool known = frame[1] == 'W' || frame[1] == 'R';
  writer.add(1, 1, "command",
             frame[1] == 'W'   ? "W reads from the PLC"
             : frame[1] == 'R' ? "R writes to the PLC"
                               : "",
             known ? "" : "neither W nor R");
  add_field(writer, frame, 2, 2, "station");
  add_field(writer, frame, 4, 2, "length");
  if (const auto length = read_digits(frame.subspan(4, 2)); length && (*length < 1 || *length > 4))
    writer.remark("", "the length must be 01..04");
}

void explain_refusal(FieldWriter& writer, ByteView frame) {
  writer.add(1, 1, "refusal", printable(frame.subspan(1, 1)), frame[1] == 'E' ? "" : "must be E");
  add_field(writer, frame, 2, 2, "code",
            std::string(refusal_text(read_digits(frame.subspan(2, 2)).value_or(0))));
}

void explain_check(FieldWriter& writer, ByteView frame) {
  Bytes right;
  append_digits(right, xor8(frame.subspan(1, frame.size() - 4)), 2);
  const ByteView check = frame.subspan(frame.size() - 3, 2);
  const bool good = std::ranges::equal(check, right);
  writer.add(frame.size() - 3, 2, "check", std::string(check.begin(), check.end()),
             good ? "" : "should be " + std::string(right.begin(), right.end()));
}

}  // namespace

std::vector<FrameField> explain(ByteView frame) {
  FieldWriter writer;
  if (frame.empty()) return {FrameField{.name = "frame", .fault = "no character"}};
  const bool marked = frame.size() > 2 && frame.front() == 'q' && frame.back() == 'Q';
  const bool request = frame.size() == kRequest, refusal = frame.size() == kRefusal;
  if (!marked || (!request && !refusal && frame.size() != kResponse)) {
    explain_no_frame(writer, frame);
    return writer.take();
  }
  writer.remark(request ? "request" : refusal ? "refusal" : "response");
  if (request) explain_request(writer, frame);
  if (refusal) explain_refusal(writer, frame);
  if (!refusal) add_field(writer, frame, frame.size() - 11, 8, "window");
  explain_check(writer, frame);
  return writer.take();
}

// No response has 17 characters.
SeenRequest seen_request(ByteView bytes) {
  if (bytes.size() < kRequest) return {};
  const ByteView frame = bytes.first(kRequest);
  const bool marked = frame.front() == 'q' && frame.back() == 'Q';
  if (!marked || (frame[1] != 'W' && frame[1] != 'R')) return {};
  const auto check = read_digits(frame.subspan(kRequest - 3, 2));
  if (check != xor8(frame.subspan(1, kRequest - 4))) return {};
  return {kRequest, true};
}

}  // namespace fieldcast::s7_freeport
