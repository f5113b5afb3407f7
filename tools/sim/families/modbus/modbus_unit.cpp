#include "tools/sim/families/modbus/modbus_unit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace fieldcast::sim {
namespace {

void append_registers(Bytes& out, const std::vector<std::uint16_t>& values) {
  for (const std::uint16_t value : values) append_u16(out, value);
}

std::vector<std::uint16_t> registers_from(ByteView bytes) {
  std::vector<std::uint16_t> values;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) values.push_back(read_u16(bytes, i));
  return values;
}

std::string function_name(std::uint8_t function) {
  char text[4];
  std::snprintf(text, sizeof text, "%02X", unsigned{function});
  return text;
}

}  // namespace

Bytes ModbusUnit::exception(std::uint8_t function, std::uint8_t code) {
  ++statistics_.exceptions[code];
  return {static_cast<std::uint8_t>(function | 0x80u), code};
}

std::uint8_t ModbusUnit::refusal(ModbusArea area, std::uint32_t first, std::uint32_t count) const {
  if (first + count > ModbusMemory::kItems)
    return static_cast<std::uint8_t>(ModbusException::kAddress);
  for (const RefusedRange& range : refused_) {
    if (range.area == to_text(area) && range.from < first + count && range.to >= first)
      return range.code;
  }
  for (std::uint32_t i = 0; only_configured_ && i < count; ++i) {
    if (!memory_.configured(area, first + i))
      return static_cast<std::uint8_t>(ModbusException::kAddress);
  }
  return 0;
}

void ModbusUnit::store(ModbusArea area, std::uint32_t first,
                       const std::vector<std::uint16_t>& values) {
  memory_.write(area, first, values);
  ++statistics_.write_requests;
  for (std::size_t i = 0; i < values.size(); ++i) {
    ++statistics_.writes[fmt::format("{}:{}", to_text(area), first + i)];
  }
}

Bytes ModbusUnit::execute(ByteView pdu, Instant now) {
  if (pdu.empty()) return {};
  ++statistics_.requests[function_name(pdu[0])];
  Bytes answer = dispatch(pdu, now);
  ++statistics_.answers;
  return answer;
}

Bytes ModbusUnit::dispatch(ByteView pdu, Instant now) {
  switch (pdu[0]) {
    case 0x01: return read_bits(ModbusArea::kCoil, pdu, now);
    case 0x02: return read_bits(ModbusArea::kInput, pdu, now);
    case 0x03: return read_registers(ModbusArea::kHolding, pdu, now);
    case 0x04: return read_registers(ModbusArea::kInputRegister, pdu, now);
    case 0x05: return write_coil(pdu);
    case 0x06: return write_register(pdu);
    case 0x07: return exception_status(pdu, now);
    case 0x08: return diagnostics(pdu);
    case 0x0F: return write_coils(pdu);
    case 0x10: return write_registers(pdu);
    case 0x16: return mask_write(pdu, now);
    case 0x17: return write_read(pdu, now);
    case 0x2B: return identification(pdu);
    default: return exception(pdu[0], ModbusException::kFunction);
  }
}

// 01/02 first(2) quantity(2) -> function, byte count, bits from the least significant
Bytes ModbusUnit::read_bits(ModbusArea area, ByteView pdu, Instant now) {
  if (pdu.size() != 5) return exception(pdu[0], ModbusException::kValue);
  const std::uint32_t first = read_u16(pdu, 1), quantity = read_u16(pdu, 3);
  if (quantity < 1 || quantity > 2000) return exception(pdu[0], ModbusException::kValue);
  if (const auto code = refusal(area, first, quantity)) return exception(pdu[0], code);
  Bytes answer(2 + (quantity + 7) / 8);
  answer[0] = pdu[0];
  answer[1] = static_cast<std::uint8_t>(answer.size() - 2);
  const auto bits = memory_.read(area, first, quantity, now);
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i] != 0)
      answer[2 + i / 8] = static_cast<std::uint8_t>(answer[2 + i / 8] | 1u << (i % 8));
  }
  return answer;
}

// 03/04 first(2) quantity(2) -> function, byte count, registers
Bytes ModbusUnit::read_registers(ModbusArea area, ByteView pdu, Instant now) {
  if (pdu.size() != 5) return exception(pdu[0], ModbusException::kValue);
  const std::uint32_t first = read_u16(pdu, 1), quantity = read_u16(pdu, 3);
  if (quantity < 1 || quantity > 125) return exception(pdu[0], ModbusException::kValue);
  if (const auto code = refusal(area, first, quantity)) return exception(pdu[0], code);
  Bytes answer{pdu[0], static_cast<std::uint8_t>(2 * quantity)};
  append_registers(answer, memory_.read(area, first, quantity, now));
  return answer;
}

// 05 address(2) 0000|FF00 -> the request
Bytes ModbusUnit::write_coil(ByteView pdu) {
  if (pdu.size() != 5) return exception(pdu[0], ModbusException::kValue);
  const std::uint16_t address = read_u16(pdu, 1), value = read_u16(pdu, 3);
  if (value != 0x0000 && value != 0xFF00) return exception(pdu[0], ModbusException::kValue);
  if (const auto code = refusal(ModbusArea::kCoil, address, 1)) return exception(pdu[0], code);
  store(ModbusArea::kCoil, address, {static_cast<std::uint16_t>(value != 0 ? 1 : 0)});
  return {pdu.begin(), pdu.end()};
}

// 06 address(2) value(2) -> the request
Bytes ModbusUnit::write_register(ByteView pdu) {
  if (pdu.size() != 5) return exception(pdu[0], ModbusException::kValue);
  const std::uint16_t address = read_u16(pdu, 1);
  if (const auto code = refusal(ModbusArea::kHolding, address, 1)) return exception(pdu[0], code);
  store(ModbusArea::kHolding, address, {read_u16(pdu, 3)});
  return {pdu.begin(), pdu.end()};
}

// 0F first(2) quantity(2) bytes(1) bits.. -> function, first, quantity
Bytes ModbusUnit::write_coils(ByteView pdu) {
  if (pdu.size() < 6) return exception(pdu[0], ModbusException::kValue);
  const std::uint32_t first = read_u16(pdu, 1), quantity = read_u16(pdu, 3), bytes = pdu[5];
  if (quantity < 1 || quantity > 1968 || bytes != (quantity + 7) / 8 || pdu.size() != 6 + bytes) {
    return exception(pdu[0], ModbusException::kValue);
  }
  if (const auto code = refusal(ModbusArea::kCoil, first, quantity)) return exception(pdu[0], code);
  std::vector<std::uint16_t> bits(quantity);
  for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = pdu[6 + i / 8] >> (i % 8) & 1u;
  store(ModbusArea::kCoil, first, bits);
  return {pdu.begin(), pdu.begin() + 5};
}

// 10 first(2) quantity(2) bytes(1) registers.. -> function, first, quantity
Bytes ModbusUnit::write_registers(ByteView pdu) {
  if (pdu.size() < 6) return exception(pdu[0], ModbusException::kValue);
  const std::uint32_t first = read_u16(pdu, 1), quantity = read_u16(pdu, 3), bytes = pdu[5];
  if (quantity < 1 || quantity > 123 || bytes != 2 * quantity || pdu.size() != 6 + bytes) {
    return exception(pdu[0], ModbusException::kValue);
  }
  if (const auto code = refusal(ModbusArea::kHolding, first, quantity))
    return exception(pdu[0], code);
  store(ModbusArea::kHolding, first, registers_from(pdu.subspan(6)));
  return {pdu.begin(), pdu.begin() + 5};
}

// 16 address(2) and(2) or(2) -> the request; new = (old AND and) OR (or AND NOT and)
Bytes ModbusUnit::mask_write(ByteView pdu, Instant now) {
  if (pdu.size() != 7) return exception(pdu[0], ModbusException::kValue);
  const std::uint16_t address = read_u16(pdu, 1), keep = read_u16(pdu, 3), set = read_u16(pdu, 5);
  if (const auto code = refusal(ModbusArea::kHolding, address, 1)) return exception(pdu[0], code);
  const std::uint16_t old = memory_.read(ModbusArea::kHolding, address, 1, now)[0];
  store(ModbusArea::kHolding, address, {static_cast<std::uint16_t>((old & keep) | (set & ~keep))});
  return {pdu.begin(), pdu.end()};
}

// 17 read first(2) quantity(2), write first(2) quantity(2) bytes(1) registers.. -> as 03
Bytes ModbusUnit::write_read(ByteView pdu, Instant now) {
  if (pdu.size() < 10) return exception(pdu[0], ModbusException::kValue);
  const std::uint32_t read_first = read_u16(pdu, 1), read_quantity = read_u16(pdu, 3);
  const std::uint32_t write_first = read_u16(pdu, 5), write_quantity = read_u16(pdu, 7),
                      bytes = pdu[9];
  if (read_quantity < 1 || read_quantity > 125 || write_quantity < 1 || write_quantity > 121 ||
      bytes != 2 * write_quantity || pdu.size() != 10 + bytes) {
    return exception(pdu[0], ModbusException::kValue);
  }
  if (const auto code = refusal(ModbusArea::kHolding, read_first, read_quantity))
    return exception(pdu[0], code);
  if (const auto code = refusal(ModbusArea::kHolding, write_first, write_quantity))
    return exception(pdu[0], code);
  store(ModbusArea::kHolding, write_first, registers_from(pdu.subspan(10)));
  Bytes answer{pdu[0], static_cast<std::uint8_t>(2 * read_quantity)};
  append_registers(answer, memory_.read(ModbusArea::kHolding, read_first, read_quantity, now));
  return answer;
}

// 07 -> eight bits; here the first eight coils, as in Modicon controllers
Bytes ModbusUnit::exception_status(ByteView pdu, Instant now) {
  if (pdu.size() != 1) return exception(pdu[0], ModbusException::kValue);
  const auto coils = memory_.read(ModbusArea::kCoil, 0, 8, now);
  unsigned status = 0;
  for (std::size_t i = 0; i < coils.size(); ++i) status |= (coils[i] != 0 ? 1u : 0u) << i;
  return {pdu[0], static_cast<std::uint8_t>(status)};
}

// 08 0000 data.. -> the request; other sub-functions are not supported
Bytes ModbusUnit::diagnostics(ByteView pdu) {
  if (pdu.size() < 3 || read_u16(pdu, 1) != 0) return exception(pdu[0], ModbusException::kFunction);
  if (pdu.size() < 5) return exception(pdu[0], ModbusException::kValue);
  return {pdu.begin(), pdu.end()};
}

// 2B 0E 01 00: basic identification as a stream (V1.1b3, 6.21); other codes are not supported
Bytes ModbusUnit::identification(ByteView pdu) {
  if (pdu.size() < 2 || pdu[1] != 0x0E) return exception(pdu[0], ModbusException::kFunction);
  if (pdu.size() != 4 || pdu[2] != 0x01) return exception(pdu[0], ModbusException::kValue);
  if (pdu[3] >= identification_.size()) return exception(pdu[0], ModbusException::kAddress);
  Bytes answer{0x2B,
               0x0E,
               0x01,
               0x01,
               0x00,
               0x00,
               static_cast<std::uint8_t>(identification_.size() - pdu[3])};
  for (std::size_t id = pdu[3]; id < identification_.size(); ++id) {
    const std::string& text = identification_[id];
    answer.push_back(static_cast<std::uint8_t>(id));
    answer.push_back(static_cast<std::uint8_t>(text.size()));
    answer.insert(answer.end(), text.begin(), text.end());
  }
  return answer;
}

}  // namespace fieldcast::sim
