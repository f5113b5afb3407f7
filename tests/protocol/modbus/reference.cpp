#include "tests/protocol/modbus/reference.hpp"

#include "core/codec/checksum.hpp"

namespace fieldcast::modbus::reference {
namespace {

unsigned at16(ByteView bytes, std::size_t at) { return bytes[at] * 256u + bytes[at + 1]; }
Bytes bits(ByteView packed, unsigned count) {
  Bytes items;
  for (unsigned i = 0; i < count; ++i)
    items.push_back((packed[i / 8] & (1u << i % 8)) != 0 ? 1 : 0);
  return items;
}
Bytes copy(ByteView bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

std::optional<Opened> open(const std::string& framing, ByteView frame) {
  if (framing == "rtu") {
    // The CRC over a frame including its own CRC is 0.
    if (frame.size() < 4 || crc16_modbus(frame) != 0) return std::nullopt;
    return Opened{frame[0], 0, copy(frame.subspan(1, frame.size() - 3))};
  }
  if (framing == "tcp") {
    if (frame.size() < 8 || at16(frame, 2) != 0 || at16(frame, 4) != frame.size() - 6 ||
        frame.size() > 260)
      return std::nullopt;
    return Opened{frame[6], static_cast<std::uint16_t>(at16(frame, 0)), copy(frame.subspan(7))};
  }
  const std::string text(frame.begin(), frame.end());
  if (text.size() < 9 || text.front() != ':' || text.substr(text.size() - 2) != "\r\n")
    return std::nullopt;
  const auto bytes = from_hex(text.substr(1, text.size() - 3));
  if (!bytes || sum8(*bytes) != 0) return std::nullopt;
  return Opened{bytes->front(), 0, Bytes(bytes->begin() + 1, bytes->end() - 1)};
}

std::optional<Meant> request_of(ByteView pdu) {
  if (pdu.size() == 4 && pdu[0] == 43 && pdu[1] == 14 && pdu[2] == 4)
    return Meant{ReadRequest{{{5, pdu[3] * 244u, 244}}}, {}};
  if (pdu.size() == 3 && pdu[0] == 24) return Meant{ReadRequest{{{6, at16(pdu, 1) * 32, 32}}}, {}};
  if (pdu.size() < 5) return std::nullopt;
  const unsigned function = pdu[0];
  if (function == 20 && pdu[1] % 7 == 0 && pdu.size() == 2u + pdu[1]) {
    ReadRequest read;
    for (std::size_t at = 2; at < pdu.size(); at += 7)
      read.ranges.push_back({4, at16(pdu, at + 1) * 10000 + at16(pdu, at + 3), at16(pdu, at + 5)});
    return Meant{read, {}};
  }
  if (function == 21 && pdu.size() > 9 && pdu.size() == 2u + pdu[1] &&
      pdu.size() == 9 + 2 * at16(pdu, 7))
    return Meant{WriteRequest{.range = {4, at16(pdu, 3) * 10000 + at16(pdu, 5), at16(pdu, 7)},
                              .items = copy(pdu.subspan(9))},
                 {}};
  const unsigned first = at16(pdu, 1);
  const unsigned count = at16(pdu, 3);
  if (function >= 1 && function <= 4 && pdu.size() == 5) {
    return Meant{ReadRequest{{{static_cast<AreaIndex>(function - 1), first, count}}}, {}};
  }
  if (function == 5 && (count == 0xFF00 || count == 0)) {
    return Meant{WriteRequest{.range = {0, first, 1},
                              .items = {count != 0 ? std::uint8_t{1} : std::uint8_t{0}}},
                 {}};
  }
  if (function == 6)
    return Meant{WriteRequest{.range = {2, first, 1}, .items = copy(pdu.subspan(3, 2))}, {}};
  if ((function == 15 || function == 16) && pdu.size() > 6 && pdu.size() == 6u + pdu[5]) {
    const bool coils = function == 15;
    if (pdu[5] != (coils ? (count + 7) / 8 : count * 2)) return std::nullopt;
    WriteRequest write{.range = {static_cast<AreaIndex>(coils ? 0 : 2), first, count},
                       .items = coils ? bits(pdu.subspan(6), count) : copy(pdu.subspan(6))};
    return Meant{std::move(write), {.write_multiple = true}};
  }
  if (function == 23 && pdu.size() > 10 && pdu.size() == 10u + pdu[9] &&
      pdu[9] == 2 * at16(pdu, 7)) {
    WriteRequest write{.range = {2, at16(pdu, 5), at16(pdu, 7)}, .items = copy(pdu.subspan(10))};
    return Meant{WriteReadRequest{std::move(write), {2, first, count}}, {}};
  }
  return std::nullopt;
}

std::optional<Meant> request_for(ByteView answer) {
  if (answer.size() < 2) return std::nullopt;
  const unsigned function = answer[0] & 0x7Fu;
  const bool refused = answer[0] != function;
  const unsigned items = refused ? 1u : (function <= 2 ? answer[1] * 8u : answer[1] / 2u);
  if (function >= 1 && function <= 4)
    return Meant{ReadRequest{{{static_cast<AreaIndex>(function - 1), 0, items}}}, {}};
  switch (function) {
    case 5: return Meant{WriteRequest{.range = {0, 0, 1}, .items = {1}}, {}};
    case 6: return Meant{WriteRequest{.range = {2, 0, 1}, .items = {0, 1}}, {}};
    case 15: return Meant{WriteRequest{.range = {0, 0, 1}, .items = {1}}, {.write_multiple = true}};
    case 16:
      return Meant{WriteRequest{.range = {2, 0, 1}, .items = {0, 1}}, {.write_multiple = true}};
    case 23: return Meant{WriteReadRequest{{.range = {2, 0, 1}, .items = {0, 1}}, {2, 0, 1}}, {}};
    default: return std::nullopt;
  }
}

Bytes items_of(ByteView answer, const Request& request) {
  if (const auto* read = std::get_if<ReadRequest>(&request)) {
    const Range& range = read->ranges.back();
    if (range.area == 4) return copy(answer.last(2 * range.count));
    if (range.area == 5) {
      Bytes text = copy(answer.subspan(9));
      text.resize(range.count);
      return text;
    }
    if (range.area == 6) {
      Bytes queue = copy(answer.subspan(3));
      queue.resize(2 * range.count);
      return queue;
    }
    return range.area < 2 ? bits(answer.subspan(2), range.count) : copy(answer.subspan(2));
  }
  return std::holds_alternative<WriteReadRequest>(request) ? copy(answer.subspan(2)) : Bytes{};
}

}  // namespace fieldcast::modbus::reference
