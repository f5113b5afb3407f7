// Source: wirenboard/wb-mqtt-serial README.md (keys of a channel), src/register.cpp (addresses of
// parts), docs of Wiren Board MQTT conventions (units by control type).
#include "tools/import/formats/wb_channel.hpp"

#include <algorithm>

#include "tools/import/formats/format.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"

namespace fieldcast::importing {
namespace {

constexpr Words<ModbusArea> kWbAreas[] = {
    {"coil", ModbusArea::kCoil},
    {"discrete", ModbusArea::kInput},
    {"input press_counter", ModbusArea::kInputRegister},
    {"holding holding_single holding_multi", ModbusArea::kHolding}};
// Formats that are also names of types.
constexpr std::string_view kFormats =
    "u16 s16 u8 s8 u32 s32 u64 s64 float double bcd8 bcd16 bcd32 string8";

struct WbUnit {
  std::string_view word, unit;
};
constexpr WbUnit kUnits[] = {{"deg C", "°C"},   {"%, RH", "% RH"}, {"m^3", "m³"}, {"m^3/h", "m³/h"},
                             {"g/m^3", "g/m³"}, {"Па", "Pa"},      {"deg", "°"}};
constexpr WbUnit kUnitsOfTypes[] = {{"temperature", "°C"},
                                    {"rel_humidity", "% RH"},
                                    {"voltage", "V"},
                                    {"current", "A"},
                                    {"power", "W"},
                                    {"power_consumption", "kWh"},
                                    {"lux", "lx"},
                                    {"sound_level", "dB"},
                                    {"concentration", "ppm"},
                                    {"pressure", "bar"},
                                    {"resistance", "Ω"},
                                    {"atmospheric_pressure", "mbar"},
                                    {"heat_power", "Gcal/h"},
                                    {"heat_energy", "Gcal"},
                                    {"water_flow", "m³/h"},
                                    {"water_consumption", "m³"}};

std::string unit_of(const Node& channel) {
  const std::string_view said = text_at(channel, "units");
  const auto known = std::ranges::find(kUnits, said, &WbUnit::word);
  if (known != std::end(kUnits)) return std::string(known->unit);
  if (!said.empty()) return std::string(said);
  const auto by_type = std::ranges::find(kUnitsOfTypes, text_at(channel, "type"), &WbUnit::word);
  return by_type == std::end(kUnitsOfTypes) ? std::string() : std::string(by_type->unit);
}

// "109", "0x6D", "109:1:2": some bits of a register.
struct WbAddress {
  std::uint32_t first = 0;
  std::optional<std::uint64_t> shift, width;  // of some bits
};

Result<WbAddress> address_of(const Node& channel, Point& point) {
  std::string_view text = text_at(channel, "address");
  const std::string_view other = text_at(channel, "write_address");
  if (text.empty()) {
    if (other.empty()) return refused("no address");
    text = other;
    point.access = Access::kWriteOnly;
  } else if (!other.empty() && whole_from(other) != whole_from(text)) {
    point.access = Access::kReadOnly;
    point.changes.push_back(fmt::format("read only: it is written at the address {}", other));
  }
  const auto parts = split(text, ':');
  const auto first = whole_from(parts[0], 0, 65535);
  const auto shift = parts.size() > 1 ? whole_from(parts[1], 0, 63) : std::nullopt;
  const auto width = parts.size() > 2 ? whole_from(parts[2], 1, 64) : std::nullopt;
  if (!first || (parts.size() > 1 && (!shift || !width)))
    return refused("'{}' is no address of Modbus", text);
  return WbAddress{static_cast<std::uint32_t>(*first), shift, width};
}

MayFail read_format(const Node& channel, Point& point) {
  std::string_view format = text_at(channel, "format");
  if (format.empty()) format = "u16";
  if (format == "string") return kSparseText;
  if (!is_one_of(format, kFormats)) return fmt::format("the format {} has no counterpart", format);
  point.type = type_by_name(format)->type;
  if (is_byte(point.type) || point.type == ValueType::kBcd8) point.byte = 0;
  if (point.type == ValueType::kString) {
    const auto registers = small_at(channel, "string_data_size", 1, kMaxStringBytes / 2);
    if (!registers) return kTextLength;
    point.string_bytes = static_cast<std::uint16_t>(2 * *registers);
  }
  if (text_at(channel, "word_order") == "little_endian")
    point.word_order = WordOrder::kLittleEndian;
  if (text_at(channel, "byte_order") == "little_endian") {
    point.byte_order = ByteOrder::kLittleEndian;
    if (point.byte) point.byte = 1;
  }
  return std::nullopt;
}

// A part of a register: one bit, one byte, or all of it.
MayFail read_part(const WbAddress& address, Point& point, std::optional<std::uint8_t>& bit) {
  if (!address.width) return std::nullopt;
  const bool one_register = registers_of(point.type, 2) == 1;
  if (*address.width == 16 && *address.shift == 0 && one_register) return std::nullopt;
  if (!one_register || *address.shift > 15) return "bits of a value of several registers";
  if (*address.width == 1) {
    point.type = ValueType::kBool;
    const bool swapped = point.byte_order == ByteOrder::kLittleEndian;
    bit = static_cast<std::uint8_t>(swapped ? (*address.shift + 8) % 16 : *address.shift);
    point.byte.reset();
    return std::nullopt;
  }
  if (*address.width == 8 && *address.shift % 8 == 0) {
    const bool with_sign = point.type == ValueType::kInt8 || point.type == ValueType::kInt16;
    point.type = with_sign ? ValueType::kInt8 : ValueType::kUint8;
    const bool high = (*address.shift == 8) != (point.byte_order == ByteOrder::kLittleEndian);
    point.byte = high ? 1 : 0;
    return std::nullopt;
  }
  return fmt::format("{} bits of a register; a channel has one bit, a byte or all", *address.width);
}

MayFail read_numbers(const Node& channel, Point& point) {
  if (auto fault = read_scale_at(channel, "scale", point.scale)) return fault;
  if (auto fault = fault_of_number(channel, "offset")) return fault;
  point.offset = number_at(channel, "offset").value_or(0);
  if (const std::string_view error = text_at(channel, "error_value"); !error.empty())
    point.changes.push_back(fmt::format("the raw value {} means an error", error));
  if (point.access == Access::kReadOnly || !is_number(point.type)) return std::nullopt;
  const auto low = number_at(channel, "min"), high = number_at(channel, "max");
  if (low && high && *low <= *high) {
    point.write_min = low;
    point.write_max = high;
  }
  return std::nullopt;
}

// Values for on and off. For a single bit, 1 is always on.
MayFail read_switch(const Node& channel, Point& point) {
  std::string_view on = text_at(channel, "on_value"), off = text_at(channel, "off_value");
  if (on.empty() && off.empty()) return std::nullopt;
  if (on.empty()) on = "1";
  if (off.empty()) off = "0";
  if (point.type != ValueType::kBool) {
    point.changes.push_back(fmt::format("a number: {} is on, {} is off", on, off));
  } else if (whole_from(on) == 0u || whole_from(off) != 0u) {
    return fmt::format(
        "a bit that means the opposite (on_value {}, off_value {}); a channel's is on at 1", on,
        off);
  }
  return std::nullopt;
}

}  // namespace

MayFail read_wb_channel(const Node& channel, const WbBase& base, Point& point) {
  if (child(channel, "consists_of") != nullptr)
    return "one control of several registers; write a channel for each";
  std::string_view type = text_at(channel, "reg_type");
  if (type.empty()) type = "holding";
  const auto area = value_of(kWbAreas, type);
  if (!area) return fmt::format("register type '{}' is not of Modbus", type);
  point.access = can_be_written(*area) && bool_at(channel, "readonly") != true ? Access::kReadWrite
                                                                               : Access::kReadOnly;
  const auto address = address_of(channel, point);
  if (!address) return address.error();
  if (point.access == Access::kWriteOnly && !can_be_written(*area))
    return "a write address of an area that cannot be written";
  std::optional<std::uint8_t> bit;
  if (holds_bits(*area)) {
    point.type = ValueType::kBool;
  } else {
    if (auto fault = read_format(channel, point)) return fault;
    if (auto fault = read_part(*address, point, bit)) return fault;
  }
  const std::uint64_t wide = holds_bits(*area) ? 1 : registers_of(point.type, point.string_bytes);
  point.at =
      address_text(*area, std::uint64_t{address->first} + base.shift + base.stride * wide, bit);
  point.unit = point.type == ValueType::kBool ? std::string() : unit_of(channel);
  if (point.byte && point.access != Access::kReadOnly) {
    point.access = Access::kReadOnly;
    point.changes.emplace_back("read only: half of a register");
  }
  if (auto fault = read_numbers(channel, point)) return fault;
  return read_switch(channel, point);
}

}  // namespace fieldcast::importing
