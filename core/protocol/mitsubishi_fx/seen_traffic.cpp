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
  bool of_memory = true;
};
// Longer spellings first, as E10 and E1 begin alike.
constexpr std::array kCommands{
    CommandRow{"E00", "extended read"},
    CommandRow{"E10", "extended write", false, true},
    CommandRow{.spelling = "E01", .text = "program read", .of_memory = false},
    CommandRow{"E11", "program write", false, true, false, false},
    CommandRow{"E7", "extended force on", true},
    CommandRow{"E8", "extended force off", true},
    CommandRow{"0", "read"},
    CommandRow{"1", "write", false, true},
    CommandRow{"7", "force on", true},
    CommandRow{"8", "force off", true},
    CommandRow{"B", "transfer complete", false, false, true, false}};

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

// The last two digits of the head count the data bytes that follow.
bool counts_its_data(const CommandRow& row, ByteView body) {
  if (!row.with_data) return true;
  const std::size_t head = row.spelling.size() + 6;
  const auto count = read_digits(body.subspan(head - 2, 2));
  return count && body.size() == head + 2 * *count;
}

void explain_request(ByteView body, const CommandRow& row, FieldWriter& writer) {
  const std::size_t at = row.spelling.size();
  writer.remark("request");
  writer.add(1, at, "command", printable(body.first(at)) + " " + std::string(row.text));
  if (row.alone) return;
  writer.add(1 + at, 4, "address",
             printable(body.subspan(at, 4)) + (row.force ? ", low pair first" : ""),
             read_digits(body.subspan(at, 4)) ? "" : "not upper-case hexadecimal digits");
  if (row.force) return;
  const auto count = read_digits(body.subspan(at + 4, 2));
  std::string fault;
  if (!count)
    fault = "not upper-case hexadecimal digits";
  else if (row.with_data && body.size() - at - 6 != 2 * *count)
    fault = std::to_string(body.size() - at - 6) + " digits of data follow";
  writer.add(1 + at + 4, 2, "bytes", printable(body.subspan(at + 4, 2)), fault);
  if (body.size() > at + 6)
    writer.add(1 + at + 6, body.size() - at - 6, "data", printable(body.subspan(at + 6)));
}

void explain_response(ByteView body, FieldWriter& writer) {
  writer.remark("response");
  const bool digits = read_hex_bytes(body).has_value();
  writer.add(1, body.size(), "data", printable(body),
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
    writer.remark(printable(frame), "no frame begins so: 02, or one of 05, 06, 15 alone");
    return writer.take();
  }
  const auto etx = std::ranges::find(frame, kEtx);
  if (etx == frame.end()) {
    writer.remark(printable(frame), "incomplete: 03 and the sum are missing");
    return writer.take();
  }
  const auto end = static_cast<std::size_t>(etx - frame.begin());
  const ByteView body = frame.subspan(1, end - 1);
  if (const CommandRow* row = command_of(body))
    explain_request(body, *row, writer);
  else
    explain_response(body, writer);
  const ByteView sum = frame.subspan(end + 1, std::min<std::size_t>(2, frame.size() - end - 1));
  Bytes right;
  append_digits(right, sum8(frame.subspan(1, end)), 2);
  writer.add(end + 1, sum.size(), "sum", printable(sum),
             std::ranges::equal(sum, right) ? "" : "should be " + printable(right));
  if (frame.size() > end + 3)
    writer.add(end + 3, frame.size() - end - 3, "surplus", printable(frame.subspan(end + 3)),
               "characters behind the frame");
  return writer.take();
}

SeenRequest seen_request(ByteView bytes) {
  if (bytes.empty() || bytes[0] != kStx) return {};
  const auto etx = std::ranges::find(bytes, kEtx);
  const auto end = static_cast<std::size_t>(etx - bytes.begin());  // of the body
  if (bytes.size() < end + 3) return {};
  const ByteView body = bytes.subspan(1, end - 1);
  if (read_digits(bytes.subspan(end + 1, 2)) != sum8(bytes.subspan(1, end))) return {};
  const CommandRow* row = command_of(body);
  const bool request = row != nullptr && row->of_memory && counts_its_data(*row, body);
  return {request ? end + 3 : 0, body.size() % 2 == 1};
}

}  // namespace fieldcast::mitsubishi_fx
