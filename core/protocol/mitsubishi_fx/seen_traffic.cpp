#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "core/codec/checksum.hpp"
#include "core/codec/digits.hpp"
#include "core/protocol/field_writer.hpp"
#include "core/protocol/mitsubishi_fx/areas.hpp"
#include "core/protocol/mitsubishi_fx/mitsubishi_fx.hpp"
#include "core/protocol/protocol_entry.hpp"

namespace fieldcast::mitsubishi_fx {

namespace {

struct CommandRow {
  std::string_view spelling;
  std::string_view text;
  bool force = false;
  bool with_data = false;
  bool alone = false;  // without address and count
};
// Longer spellings first, as E10 and E1 begin alike.
constexpr std::array kCommands{CommandRow{"E00", "extended read"},
                               CommandRow{"E10", "extended write", false, true},
                               CommandRow{"E01", "program read"},
                               CommandRow{"E11", "program write", false, true},
                               CommandRow{"E7", "extended force on", true},
                               CommandRow{"E8", "extended force off", true},
                               CommandRow{"0", "read"},
                               CommandRow{"1", "write", false, true},
                               CommandRow{"7", "force on", true},
                               CommandRow{"8", "force off", true},
                               CommandRow{"B", "transfer complete", false, false, true}};

std::string text_of(ByteView characters) {
  std::string text;
  for (const std::uint8_t c : characters)
    text +=
        c >= 0x20 && c < 0x7F ? std::string(1, static_cast<char>(c)) : "<" + to_hex({&c, 1}) + ">";
  return text;
}

// A request has an odd number of digits, a response an even one, except for the extended force.
const CommandRow* command_of(ByteView body) {
  for (const CommandRow& row : kCommands) {
    if (body.size() < row.spelling.size() ||
        !std::equal(row.spelling.begin(), row.spelling.end(), body.begin()))
      continue;
    const std::size_t fixed = row.spelling.size() + (row.alone ? 0 : row.force ? 4 : 6);
    const bool fits = row.with_data ? body.size() >= fixed : body.size() == fixed;
    if (fits && (body.size() % 2 == 1 || row.force)) return &row;
  }
  return nullptr;
}

void explain_request(ByteView body, const CommandRow& row, FieldWriter& writer) {
  const std::size_t at = row.spelling.size();
  writer.remark("request");
  writer.add(1, at, "command", text_of(body.first(at)) + " " + std::string(row.text));
  if (row.alone) return;
  writer.add(1 + at, 4, "address",
             text_of(body.subspan(at, 4)) + (row.force ? ", low pair first" : ""),
             read_digits(body.subspan(at, 4)) ? "" : "not upper-case hexadecimal digits");
  if (row.force) return;
  const auto count = read_digits(body.subspan(at + 4, 2));
  std::string fault;
  if (!count)
    fault = "not upper-case hexadecimal digits";
  else if (row.with_data && body.size() - at - 6 != 2 * *count)
    fault = std::to_string(body.size() - at - 6) + " digits of data follow";
  writer.add(1 + at + 4, 2, "bytes", text_of(body.subspan(at + 4, 2)), fault);
  if (body.size() > at + 6)
    writer.add(1 + at + 6, body.size() - at - 6, "data", text_of(body.subspan(at + 6)));
}

void explain_answer(ByteView body, FieldWriter& writer) {
  writer.remark("response");
  const bool digits = read_hex_bytes(body).has_value();
  writer.add(1, body.size(), "data", text_of(body),
             digits ? "" : "not pairs of upper-case hexadecimal digits");
}

}  // namespace

std::vector<FrameField> explain(ByteView frame) {
  constexpr std::size_t kMaxExplained = 1024;
  frame = frame.first(std::min(frame.size(), kMaxExplained));
  FieldWriter writer;
  if (frame.size() == 1 && (frame[0] == kEnq || frame[0] == kAck || frame[0] == kNak)) {
    writer.add(0, 1, "character",
               frame[0] == kEnq   ? "05 ready?"
               : frame[0] == kAck ? "06 done, or ready"
                                  : "15 refused");
    return writer.take();
  }
  if (frame.empty() || frame[0] != kStx) {
    writer.remark(text_of(frame), "no frame begins so: 02, or one of 05, 06, 15 alone");
    return writer.take();
  }
  const auto etx = std::find(frame.begin(), frame.end(), kEtx);
  if (etx == frame.end()) {
    writer.remark(text_of(frame), "incomplete: 03 and the sum are missing");
    return writer.take();
  }
  const auto end = static_cast<std::size_t>(etx - frame.begin());
  const ByteView body = frame.subspan(1, end - 1);
  if (const CommandRow* row = command_of(body))
    explain_request(body, *row, writer);
  else
    explain_answer(body, writer);
  const ByteView sum = frame.subspan(end + 1, std::min<std::size_t>(2, frame.size() - end - 1));
  Bytes right;
  append_digits(right, sum8(frame.subspan(1, end)), 2);
  writer.add(end + 1, sum.size(), "sum", text_of(sum),
             std::ranges::equal(sum, right) ? "" : "should be " + text_of(right));
  if (frame.size() > end + 3)
    writer.add(end + 3, frame.size() - end - 3, "surplus", text_of(frame.subspan(end + 3)),
               "characters behind the frame");
  return writer.take();
}

// A request has an odd number of digits, a response an even one, except for the extended force.

namespace {

struct Shape {
  std::string_view command;
  std::size_t fixed;  // digits after the command
  bool data = false;  // the last two of the fixed digits count the data bytes that follow
};
constexpr std::array kShapes{Shape{"E00", 6}, Shape{"E10", 6, true}, Shape{"E7", 4}, Shape{"E8", 4},
                             Shape{"0", 6},   Shape{"1", 6, true},   Shape{"7", 4},  Shape{"8", 4}};

bool fits(const Shape& shape, ByteView body) {
  const std::size_t head = shape.command.size() + shape.fixed;
  if (body.size() < head || !std::equal(shape.command.begin(), shape.command.end(), body.begin()))
    return false;
  std::size_t data = 0;
  if (shape.data) {
    const auto count = read_digits(body.subspan(head - 2, 2));
    if (!count) return false;
    data = 2 * *count;
  }
  return body.size() == head + data;
}

}  // namespace

SeenRequest seen_request(ByteView bytes) {
  if (bytes.empty() || bytes[0] != kStx) return {};
  const auto etx = std::find(bytes.begin(), bytes.end(), kEtx);
  const auto end = static_cast<std::size_t>(etx - bytes.begin());  // of the body
  if (bytes.size() < end + 3) return {};
  const ByteView body = bytes.subspan(1, end - 1);
  if (read_digits(bytes.subspan(end + 1, 2)) != sum8(bytes.subspan(1, end))) return {};
  const bool request =
      std::ranges::any_of(kShapes, [&](const Shape& shape) { return fits(shape, body); });
  return {request ? end + 3 : 0, body.size() % 2 == 1};
}

}  // namespace fieldcast::mitsubishi_fx
