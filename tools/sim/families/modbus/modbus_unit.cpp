#include "tools/sim/families/modbus/modbus_unit.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fieldcast::sim {

namespace {

constexpr std::uint32_t kItems = 65536;      // of coils, inputs and registers
constexpr std::uint32_t kRecords = 10000;    // of each file
constexpr std::uint32_t kObjectBytes = 244;  // of each object of the identification
constexpr std::uint32_t kQueueItems = 32;    // a count and at most 31 registers

bool is_bits(std::size_t area) { return area == ModbusArea::kCoil || area == ModbusArea::kInput; }

// Decimal, or hexadecimal with the prefix 0x.
std::optional<std::uint32_t> number(std::string_view text, std::uint32_t limit) {
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  const auto value = address_number(hex ? text.substr(2) : text, hex ? 16 : 10);
  if (!value || *value > limit) return std::nullopt;
  return static_cast<std::uint32_t>(*value);
}

// "1246", "1246:1"
std::optional<std::uint32_t> queue_item(std::string_view text) {
  const auto colon = text.find(':');
  const auto pointer = number(text.substr(0, colon), kItems - 1);
  if (!pointer || colon == std::string_view::npos)
    return pointer ? std::optional(*pointer * kQueueItems) : std::nullopt;
  const auto position = number(text.substr(colon + 1), kQueueItems - 1);
  if (!position || *position == 0) return std::nullopt;
  return *pointer * kQueueItems + *position;
}

// "4:7" of a file, "0" of an object, "107" elsewhere.
std::optional<std::uint32_t> item_number(std::size_t area, std::string_view text) {
  if (area == ModbusArea::kIdentity) {
    const auto object = number(text, 255);
    return object ? std::optional(*object * kObjectBytes) : std::nullopt;
  }
  if (area == ModbusArea::kFifo) return queue_item(text);
  if (area != ModbusArea::kFile) return number(text, kItems - 1);
  const auto colon = std::min(text.find(':'), text.size());
  const auto file = number(text.substr(0, colon), 65535);
  const auto record = number(text.substr(std::min(colon + 1, text.size())), kRecords - 1);
  return file && record ? std::optional(*file * kRecords + *record) : std::nullopt;
}

// 06 file(2) record(2) quantity(2)
ItemAddress record_at(ByteView pdu, std::size_t at) {
  return {ModbusArea::kFile, read_u16(pdu, at + 1) * kRecords + read_u16(pdu, at + 3), {}};
}
bool within_file(ByteView pdu, std::size_t at) {
  const unsigned record = read_u16(pdu, at + 3), quantity = read_u16(pdu, at + 5);
  return pdu[at] == 6 && quantity >= 1 && record + quantity <= kRecords;
}

}  // namespace

std::vector<ItemArea> modbus_areas() {
  std::vector<ItemArea> areas;
  for (std::size_t area = 0; area < ModbusArea::kFile; ++area)
    areas.push_back({kModbusAreaNames[area], is_bits(area) ? 1u : 16u, kItems, is_bits(area)});
  areas.push_back({kModbusAreaNames[ModbusArea::kFile], 16, 65536 * kRecords});
  areas.push_back({kModbusAreaNames[ModbusArea::kIdentity], 8, 256 * kObjectBytes});
  areas.push_back({kModbusAreaNames[ModbusArea::kFifo], 16, kItems * kQueueItems});
  return areas;
}

std::optional<ItemAddress> parse_modbus_address(std::string_view at) {
  ItemAddress address;
  if (const auto dot = at.rfind('.'); dot != std::string_view::npos) {
    const auto bit = number(at.substr(dot + 1), 15);
    if (!bit) return std::nullopt;
    address.bit = static_cast<std::uint8_t>(*bit);
    at = at.substr(0, dot);
  }
  if (const auto colon = at.find(':'); colon != std::string_view::npos) {
    const std::string_view word = at.substr(0, colon);
    const auto name =
        std::ranges::find(kModbusAreaNames, word == "discrete-input" ? "input" : word);
    if (name == kModbusAreaNames.end()) return std::nullopt;
    address.area = static_cast<std::size_t>(name - kModbusAreaNames.begin());
    const auto first = item_number(address.area, at.substr(colon + 1));
    if (!first) return std::nullopt;
    address.first = *first;
    return address;
  }
  // Classic reference numbers: area digit, then a number from 1; six digits for all 65536 items.
  if (at.size() != 5 && at.size() != 6) return std::nullopt;
  const auto rest = number(at.substr(1), kItems);
  address.area = std::string_view("0143").find(at[0]);  // in the order of ModbusArea
  if (!rest || *rest == 0 || address.area == std::string_view::npos) return std::nullopt;
  address.first = *rest - 1;
  return address;
}

Bytes ModbusUnit::exception(ByteView pdu, std::uint8_t code) {
  ++statistics_.exceptions[code];
  return {static_cast<std::uint8_t>(pdu[0] | 0x80u), code};
}

Bytes ModbusUnit::registers(std::uint8_t function, const Items& items, Instant now) const {
  Bytes response{function, static_cast<std::uint8_t>(2 * items.count)};
  for (std::uint32_t i = 0; i < items.count; ++i) append_u16(response, value(items, i, now));
  return response;
}

void ModbusUnit::store(const Items& items, ByteView data) {
  ++statistics_.write_requests;
  for (std::uint32_t i = 0; i < items.count; ++i) {
    const std::uint64_t item =
        is_bits(items.area) ? data[i / 8] >> i % 8 & 1u : std::uint64_t{read_u16(data, 2 * i)};
    memory_.write(items.area, items.first + i, item, statistics_);
  }
}

Bytes ModbusUnit::execute(ByteView pdu, Instant now) {
  if (pdu.empty()) return {};
  ++statistics_.requests[fmt::format("{:02X}", pdu[0])];
  Bytes response = dispatch(pdu, now);
  ++statistics_.responses;
  return response;
}

Bytes ModbusUnit::dispatch(ByteView pdu, Instant now) {
  switch (pdu[0]) {
    case 0x01: return read(ModbusArea::kCoil, pdu, now);
    case 0x02: return read(ModbusArea::kInput, pdu, now);
    case 0x03: return read(ModbusArea::kHolding, pdu, now);
    case 0x04: return read(ModbusArea::kInputRegister, pdu, now);
    case 0x05: return write_coil(pdu);
    case 0x06: return write_register(pdu);
    case 0x07: return exception_status(pdu, now);
    case 0x08: return diagnostics(pdu);
    case 0x0F: return write_many(ModbusArea::kCoil, pdu);
    case 0x10: return write_many(ModbusArea::kHolding, pdu);
    case 0x14: return read_file(pdu, now);
    case 0x15: return write_file(pdu);
    case 0x16: return mask_write(pdu, now);
    case 0x17: return write_read(pdu, now);
    case 0x18: return read_fifo(pdu, now);
    case 0x2B: return identification(pdu, now);
    default: return exception(pdu, kFunction);
  }
}

// 01..04 first(2) quantity(2) -> function, byte count, registers or bits from the least significant
Bytes ModbusUnit::read(std::size_t area, ByteView pdu, Instant now) {
  if (pdu.size() != 5) return exception(pdu, kValue);
  const Items items{area, read_u16(pdu, 1), read_u16(pdu, 3)};
  if (items.count < 1 || items.count > (is_bits(area) ? 2000u : 125u))
    return exception(pdu, kValue);
  if (const auto code = refusal(items)) return exception(pdu, code);
  if (!is_bits(area)) return registers(pdu[0], items, now);
  Bytes response(2 + (items.count + 7) / 8);
  response[0] = pdu[0];
  response[1] = static_cast<std::uint8_t>(response.size() - 2);
  for (std::uint32_t i = 0; i < items.count; ++i) {
    std::uint8_t& byte = response[2 + i / 8];
    byte = static_cast<std::uint8_t>(byte | (value(items, i, now) != 0 ? 1u : 0u) << i % 8);
  }
  return response;
}

// 05 address(2) 0000|FF00 -> the request
Bytes ModbusUnit::write_coil(ByteView pdu) {
  if (pdu.size() != 5) return exception(pdu, kValue);
  const Items items{ModbusArea::kCoil, read_u16(pdu, 1)};
  const std::uint16_t wanted = read_u16(pdu, 3);
  if (wanted != 0x0000 && wanted != 0xFF00) return exception(pdu, kValue);
  if (const auto code = refusal(items)) return exception(pdu, code);
  store(items, Bytes{static_cast<std::uint8_t>(wanted != 0 ? 1 : 0)});
  return {pdu.begin(), pdu.end()};
}

// 06 address(2) value(2) -> the request
Bytes ModbusUnit::write_register(ByteView pdu) {
  if (pdu.size() != 5) return exception(pdu, kValue);
  const Items items{ModbusArea::kHolding, read_u16(pdu, 1)};
  if (const auto code = refusal(items)) return exception(pdu, code);
  store(items, pdu.subspan(3));
  return {pdu.begin(), pdu.end()};
}

// 0F|10 first(2) quantity(2) bytes(1) bits or registers.. -> function, first, quantity
Bytes ModbusUnit::write_many(std::size_t area, ByteView pdu) {
  if (pdu.size() < 6) return exception(pdu, kValue);
  const Items items{area, read_u16(pdu, 1), read_u16(pdu, 3)};
  const std::uint32_t bytes = is_bits(area) ? (items.count + 7) / 8 : 2 * items.count;
  if (items.count < 1 || items.count > (is_bits(area) ? 1968u : 123u) || pdu[5] != bytes ||
      pdu.size() != 6 + bytes)
    return exception(pdu, kValue);
  if (const auto code = refusal(items)) return exception(pdu, code);
  store(items, pdu.subspan(6));
  return {pdu.begin(), pdu.begin() + 5};
}

// 16 address(2) and(2) or(2) -> the request; new = (old AND and) OR (or AND NOT and)
Bytes ModbusUnit::mask_write(ByteView pdu, Instant now) {
  if (pdu.size() != 7) return exception(pdu, kValue);
  const Items items{ModbusArea::kHolding, read_u16(pdu, 1)};
  const std::uint16_t keep = read_u16(pdu, 3), set = read_u16(pdu, 5);
  if (const auto code = refusal(items)) return exception(pdu, code);
  Bytes masked;
  append_u16(masked, static_cast<std::uint16_t>((value(items, 0, now) & keep) | (set & ~keep)));
  store(items, masked);
  return {pdu.begin(), pdu.end()};
}

// 17 read first(2) quantity(2), write first(2) quantity(2) bytes(1) registers.. -> as 03
Bytes ModbusUnit::write_read(ByteView pdu, Instant now) {
  if (pdu.size() < 10) return exception(pdu, kValue);
  const Items wanted{ModbusArea::kHolding, read_u16(pdu, 1), read_u16(pdu, 3)};
  const Items written{ModbusArea::kHolding, read_u16(pdu, 5), read_u16(pdu, 7)};
  if (wanted.count < 1 || wanted.count > 125 || written.count < 1 || written.count > 121 ||
      pdu[9] != 2 * written.count || pdu.size() != 10 + std::size_t{pdu[9]})
    return exception(pdu, kValue);
  for (const Items& items : {wanted, written}) {
    if (const auto code = refusal(items)) return exception(pdu, code);
  }
  store(written, pdu.subspan(10));
  return registers(pdu[0], wanted, now);
}

// 07 -> eight bits; here the first eight coils, as in Modicon controllers
Bytes ModbusUnit::exception_status(ByteView pdu, Instant now) {
  if (pdu.size() != 1) return exception(pdu, kValue);
  unsigned status = 0;
  for (std::uint32_t i = 0; i < 8; ++i)
    status |= (value({ModbusArea::kCoil}, i, now) != 0 ? 1u : 0u) << i;
  return {pdu[0], static_cast<std::uint8_t>(status)};
}

// 08 0000 data.. -> the request; other sub-functions are not supported
Bytes ModbusUnit::diagnostics(ByteView pdu) {
  if (pdu.size() < 3 || read_u16(pdu, 1) != 0) return exception(pdu, kFunction);
  if (pdu.size() < 5) return exception(pdu, kValue);
  return {pdu.begin(), pdu.end()};
}

// 14 bytes(1) [06 file(2) record(2) quantity(2)].. -> bytes(1) [bytes(1) 06 registers..]..
// (V1.1b3, 6.14). File 0 is not in the standard, but devices have it.
Bytes ModbusUnit::read_file(ByteView pdu, Instant now) {
  if (pdu.size() < 2 || pdu.size() != 2u + pdu[1] || pdu[1] < 7 || pdu[1] > 0xF5 || pdu[1] % 7 != 0)
    return exception(pdu, kValue);
  Bytes response{pdu[0], 0};
  for (std::size_t at = 2; at < pdu.size(); at += 7) {
    if (!within_file(pdu, at)) return exception(pdu, kAddress);
    const Items items{ModbusArea::kFile, record_at(pdu, at).first, read_u16(pdu, at + 5)};
    if (response.size() + 2 + 2 * items.count > 2 + 0xF5) return exception(pdu, kValue);
    if (const auto code = refusal(items)) return exception(pdu, code);
    response.push_back(static_cast<std::uint8_t>(1 + 2 * items.count));
    response.push_back(6);
    for (std::uint32_t i = 0; i < items.count; ++i) append_u16(response, value(items, i, now));
  }
  response[1] = static_cast<std::uint8_t>(response.size() - 2);
  return response;
}

// 15 bytes(1) [06 file(2) record(2) quantity(2) registers..].. -> the request (V1.1b3, 6.15)
Bytes ModbusUnit::write_file(ByteView pdu) {
  if (pdu.size() < 2 || pdu.size() != 2u + pdu[1] || pdu[1] < 9 || pdu[1] > 0xFB)
    return exception(pdu, kValue);
  std::vector<std::pair<Items, ByteView>> groups;
  for (std::size_t at = 2; at < pdu.size();) {
    if (pdu.size() < at + 7) return exception(pdu, kValue);
    if (!within_file(pdu, at)) return exception(pdu, kAddress);
    const Items items{ModbusArea::kFile, record_at(pdu, at).first, read_u16(pdu, at + 5)};
    at += 7;
    if (pdu.size() < at + 2 * items.count) return exception(pdu, kValue);
    if (const auto code = refusal(items)) return exception(pdu, code);
    groups.emplace_back(items, pdu.subspan(at, 2 * items.count));
    at += 2 * items.count;
  }
  for (const auto& [items, data] : groups) store(items, data);
  return {pdu.begin(), pdu.end()};
}

// 18 pointer(2) -> bytes(2) count(2) registers..; more than 31 are refused (V1.1b3, 6.18). Without
// a count in the memory, the last register that it holds ends the queue. A waveform stays below 32.
Bytes ModbusUnit::read_fifo(ByteView pdu, Instant now) {
  if (pdu.size() != 3) return exception(pdu, kValue);
  const std::uint32_t first = read_u16(pdu, 1) * kQueueItems;
  std::uint32_t count = 0;
  if (memory_.holds(ModbusArea::kFifo, first)) {
    count = static_cast<std::uint16_t>(memory_.read(ModbusArea::kFifo, first, now));
    if (memory_.configured(ModbusArea::kFifo, first)) count %= kQueueItems;
  } else {
    for (std::uint32_t at = 1; at < kQueueItems; ++at)
      if (memory_.holds(ModbusArea::kFifo, first + at)) count = at;
  }
  if (count >= kQueueItems) return exception(pdu, kValue);
  const Items queue{ModbusArea::kFifo, first, count + 1};
  const auto code = memory_.refusal(queue.area, first, queue.count, 0);
  if (code != 0) return exception(pdu, code);
  Bytes response{pdu[0]};
  append_u16(response, static_cast<std::uint16_t>(2 + 2 * count));
  append_u16(response, static_cast<std::uint16_t>(count));
  for (std::uint32_t i = 1; i <= count; ++i) append_u16(response, value(queue, i, now));
  return response;
}

void ModbusUnit::identify_as(const std::vector<std::string>& objects, std::uint8_t conformity) {
  conformity_ = conformity;
  std::uint32_t first = 0;
  for (const std::string& text : objects) {
    for (std::uint32_t i = 0; i < kObjectBytes; ++i, ++first)
      memory_.write(ModbusArea::kIdentity, first,
                    i < text.size() ? static_cast<std::uint8_t>(text[i]) : 0);
  }
}

// Empty if no character of the object exists. 0 behind the last character is no part of it.
std::optional<std::string> ModbusUnit::object(unsigned id, Instant now) const {
  std::string text;
  bool exists = id < 3;  // mandatory
  const std::uint32_t first = id * kObjectBytes;
  for (std::uint32_t item = first; item < first + kObjectBytes; ++item) {
    exists = exists || memory_.holds(ModbusArea::kIdentity, item);
    text.push_back(static_cast<char>(memory_.read(ModbusArea::kIdentity, item, now)));
  }
  if (!exists) return std::nullopt;
  while (text.ends_with('\0')) text.pop_back();
  return text;
}

// 2B 0E code object -> 0E code conformity more next objects [object length text..]..; codes 1 to 3
// are streams of objects, 4 is one object (V1.1b3, 6.21)
Bytes ModbusUnit::identification(ByteView pdu, Instant now) {
  constexpr unsigned kEnds[] = {3, 7, 256};  // of the objects of each code
  if (pdu.size() < 2 || pdu[1] != 0x0E) return exception(pdu, kFunction);
  if (pdu.size() != 4 || pdu[2] < 1 || pdu[2] > 4) return exception(pdu, kValue);
  const bool alone = pdu[2] == 4;
  if (alone && conformity_ < 0x80) return exception(pdu, kValue);
  const auto asked = object(pdu[3], now);
  if (alone && !asked) return exception(pdu, kAddress);
  const Items all{ModbusArea::kIdentity, pdu[3] * kObjectBytes, 1};
  const auto code = alone ? refusal(all) : std::uint8_t{0};
  if (code != 0) return exception(pdu, code);
  Bytes response{pdu[0], pdu[1], pdu[2], conformity_, 0x00, 0x00, 0};
  // A stream from an unknown object begins with the first one.
  const unsigned begin = asked ? pdu[3] : 0, end = alone ? begin + 1 : kEnds[pdu[2] - 1];
  for (unsigned id = begin; id < end; ++id) {
    const auto text = object(id, now);
    if (!text) continue;
    if (response.size() + 2 + text->size() > kMaxPdu) {
      response[4] = 0xFF;
      response[5] = static_cast<std::uint8_t>(id);
      break;
    }
    ++response[6];
    response.push_back(static_cast<std::uint8_t>(id));
    response.push_back(static_cast<std::uint8_t>(text->size()));
    response.insert(response.end(), text->begin(), text->end());
  }
  return response;
}

}  // namespace fieldcast::sim
