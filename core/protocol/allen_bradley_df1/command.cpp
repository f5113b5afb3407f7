#include "core/protocol/allen_bradley_df1/command.hpp"

#include <algorithm>

#include "core/protocol/allen_bradley_df1/frame.hpp"

namespace fieldcast::df1 {
namespace {

const FileRow& row_of(const Range& range) { return file_rows()[range.area]; }

void append_low_first(Bytes& out, std::uint32_t number) {
  const Bytes bytes{static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8)};
  append(out, bytes);
}

void append_number(Bytes& out, std::uint32_t number) {
  if (number >= 0xFF) out.push_back(0xFF);
  if (number >= 0xFF) return append_low_first(out, number);
  out.push_back(static_cast<std::uint8_t>(number));
}

// The low byte is first on the wire, last in the image.
Bytes turned(ByteView bytes, std::size_t each) {
  Bytes result(bytes.begin(), bytes.end());
  for (auto at = result.begin(); at != result.end(); at += static_cast<std::ptrdiff_t>(each))
    std::reverse(at, at + static_cast<std::ptrdiff_t>(each));
  return result;
}

}  // namespace

Bytes command_of(const Request& request, const Nodes& nodes, std::uint16_t tns) {
  const auto* write = std::get_if<WriteRequest>(&request);
  const Range& range = write != nullptr ? write->range : std::get<ReadRequest>(request).ranges[0];
  const FileRow& row = row_of(range);
  const Place place = place_of(row, range, write != nullptr);
  Bytes out;
  append_number(out, nodes.plc);
  append_number(out, nodes.source);
  out.insert(out.end(), {kCommand, 0});
  append_low_first(out, tns);
  out.push_back(write == nullptr ? kRead : write->bit ? kWriteMasked : kWrite);
  out.push_back(static_cast<std::uint8_t>(place.bytes));
  append_number(out, place.file);
  out.push_back(row.code);
  append_number(out, place.element);
  append_number(out, place.sub);
  if (write == nullptr) return out;
  if (write->bit) append_low_first(out, 1u << *write->bit);
  append(out, turned(write->items, row.item_bits / 8));
  return out;
}

std::size_t response_size(const Request& request) {
  const auto* read = std::get_if<ReadRequest>(&request);
  if (read == nullptr) return kHead;
  return kHead + place_of(row_of(read->ranges[0]), read->ranges[0], false).bytes;
}

Judgement judge(ByteView packet, const Request& request, const Nodes& nodes, std::uint16_t tns) {
  // A gateway may replace our node number.
  if (packet.size() < kHead || packet[1] != nodes.plc || packet[2] != (kCommand | kReply) ||
      (packet[4] | packet[5] << 8) != tns)
    return {Cause::kForeign};
  const ByteView data = packet.subspan(kHead);
  std::uint16_t code = packet[3];
  if (code == kExtended && !data.empty()) code = static_cast<std::uint16_t>(0xF000 | data[0]);
  if (code != 0) return {device_code_cause(kCodes, code), code};
  if (packet.size() != response_size(request)) return {Cause::kMalformed};
  Judgement judgement{.reply = Reply(1)};
  const auto* read = std::get_if<ReadRequest>(&request);
  if (read == nullptr) return judgement;
  const Range& range = read->ranges[0];
  const FileRow& row = row_of(range);
  const std::size_t each = row.item_bits / 8, skipped = row.words == 3 ? range.first % 3 : 0;
  judgement.reply[0].items = turned(data.subspan(skipped * each, range.count * each), each);
  return judgement;
}

}  // namespace fieldcast::df1
