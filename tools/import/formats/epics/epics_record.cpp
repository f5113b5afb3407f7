// Source: epics-modules/modbus docs/source/creating_driver.rst (data types), device_support.rst
// (interfaces, offsets, masks); epics-modules/asyn devAsynInt32.c, devAsynInt64.c, devAsynFloat64.c
// (bits, conversion of each interface); EPICS record reference (LINR, ASLO, AOFF, DRVH, alarms).
#include "tools/import/formats/epics/epics_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"
#include "tools/import/text/text.hpp"

namespace fieldcast::importing {
namespace {

using MayFail = std::optional<std::string>;

// modbusDataType_t since R3-1, for scripts that use the number.
constexpr std::array<std::string_view, 37> kNumbered{
    "INT16",           "INT16SM",      "BCD_UNSIGNED",  "BCD_SIGNED",
    "UINT16",          "INT32_LE",     "INT32_LE_BS",   "INT32_BE",
    "INT32_BE_BS",     "UINT32_LE",    "UINT32_LE_BS",  "UINT32_BE",
    "UINT32_BE_BS",    "INT64_LE",     "INT64_LE_BS",   "INT64_BE",
    "INT64_BE_BS",     "UINT64_LE",    "UINT64_LE_BS",  "UINT64_BE",
    "UINT64_BE_BS",    "FLOAT32_LE",   "FLOAT32_LE_BS", "FLOAT32_BE",
    "FLOAT32_BE_BS",   "FLOAT64_LE",   "FLOAT64_LE_BS", "FLOAT64_BE",
    "FLOAT64_BE_BS",   "STRING_HIGH",  "STRING_LOW",    "STRING_HIGH_LOW",
    "STRING_LOW_HIGH", "ZSTRING_HIGH", "ZSTRING_LOW",   "ZSTRING_HIGH_LOW",
    "ZSTRING_LOW_HIGH"};

std::string_view field(const EpicsRecord& record, std::string_view name) {
  const auto found = record.fields.find(name);
  return found == record.fields.end() ? std::string_view() : std::string_view(found->second);
}
std::optional<double> number_field(const EpicsRecord& record, std::string_view name) {
  return number_from(field(record, name));
}

std::optional<ModbusArea> area_of(unsigned function) {
  switch (function) {
    case 1:
    case 5:
    case 15: return ModbusArea::kCoil;
    case 2: return ModbusArea::kInput;
    case 4: return ModbusArea::kInputRegister;
    case 3:
    case 6:
    case 16:
    case 123:
    case 223: return ModbusArea::kHolding;
    default: return std::nullopt;
  }
}
bool writes(unsigned function) {
  return function == 5 || function == 6 || function == 15 || function == 16 || function == 223;
}

class RecordReader {
 public:
  RecordReader(const EpicsRecord& record, const AsynLink& link, const ModbusPort& port)
      : record_(record), link_(link), port_(port) {}

  MayFail read(std::vector<Point>& points) {
    const auto area = area_of(port_.function);
    if (!area) return fmt::format("its port uses the function {}", port_.function);
    const auto offset = c_number(link_.offset);
    const std::int64_t first = offset.value_or(-1) + std::max<std::int64_t>(port_.start, 0);
    if (!offset || *offset < 0 || first > 65535)
      return fmt::format("'{}' is no offset", link_.offset);
    point_.name = record_.name;
    point_.origin = record_.origin;
    point_.unit = field(record_, "EGU");
    point_.description = field(record_, "DESC");
    if (const auto fault = read_direction()) return fault;
    if (const auto fault = read_value(*area, *offset)) return fault;
    read_alarms();
    point_.at = address_text(*area, static_cast<std::uint64_t>(first), bit_);
    if (elements_ > 0) {
      append_array(points, point_, *area, static_cast<std::uint32_t>(first), elements_);
    } else {
      points.push_back(std::move(point_));
    }
    return std::nullopt;
  }

 private:
  MayFail read_direction() {
    const bool out = writes(port_.function);
    const bool out_record = record_.fields.contains("OUT") ||
                            field(record_, "DTYP").find("Out") != std::string_view::npos ||
                            field(record_, "DTYP") == "asynOctetWrite";
    if (out_record != out)
      return fmt::format("the record {}, its port has the function {}",
                         out_record ? "writes" : "reads", port_.function);
    if (!out) {
      read_period();
    } else if (port_.poll_ms > 0 && !port_.other_address_back) {
      point_.access = Access::kReadWrite;
      point_.changes.emplace_back("it is read again and again, not only at the start");
    } else {
      point_.access = Access::kWriteOnly;
    }
    return std::nullopt;
  }

  // ".1 second", "10 second"; other values use the poll time of the port.
  void read_period() {
    const std::string_view scan = field(record_, "SCAN");
    const std::size_t second = scan.find("second");
    const auto seconds = second == std::string_view::npos
                             ? std::nullopt
                             : number_from(fmt::format("0{}", trimmed(scan.substr(0, second))));
    if (seconds && *seconds > 0 && *seconds < 86400) {
      point_.refresh = std::chrono::milliseconds{static_cast<std::int64_t>(*seconds * 1000)};
    } else if (port_.poll_ms > 0 && port_.poll_ms < 86'400'000) {
      point_.refresh = std::chrono::milliseconds{port_.poll_ms};
    }
  }

  MayFail read_value(ModbusArea area, std::int64_t offset) {
    const std::string_view interface = field(record_, "DTYP");
    if (interface.find("Array") != std::string_view::npos) {
      const auto count = whole_from(field(record_, "NELM"));
      if (!count || *count == 0 || *count > 2000) return "an array without NELM";
      elements_ = static_cast<unsigned>(*count);
    }
    if (holds_bits(area)) {
      point_.type = ValueType::kBool;
      const bool one_bit = !link_.masked || interface != "asynUInt32Digital" ||
                           c_number(link_.mask).value_or(1) == 1;
      if (!one_bit) return "several bits in one record; write a channel for each";
      return record_.type == "ai" || record_.type == "ao" ? read_scale(interface) : MayFail();
    }
    if (interface == "asynUInt32Digital") return read_mask();
    return read_typed(interface, offset);
  }

  MayFail read_mask() {
    const std::int64_t mask = c_number(link_.mask).value_or(0xFFFF) & 0xFFFF;
    if (std::has_single_bit(static_cast<std::uint64_t>(mask))) {
      bit_ = static_cast<std::uint8_t>(std::countr_zero(static_cast<std::uint64_t>(mask)));
      point_.type = ValueType::kBool;
      return std::nullopt;
    }
    if (mask != 0 && mask != 0xFFFF)
      return fmt::format("the bits {} of a register; a channel has one bit or all", link_.mask);
    if (record_.type == "bi" || record_.type == "bo") return "a bit without its mask";
    point_.type = ValueType::kUint16;
    return std::nullopt;
  }

  MayFail read_typed(std::string_view interface, std::int64_t offset) {
    std::string name = link_.driver_user;
    if (name.empty() || name == "MODBUS_DATA") name = port_.data_type;
    if (const auto number = c_number(name)) {
      if (*number < 0 || *number >= static_cast<std::int64_t>(kNumbered.size()))
        return fmt::format("the data type {} is unknown", name);
      name = kNumbered[static_cast<std::size_t>(*number)];
      if (*number != 0)
        point_.changes.push_back(
            fmt::format("data type {} is taken for {}, as since R3-1", *number, name));
    }
    if (interface.starts_with("asynOctet")) return read_text(name, offset);
    if (name.find("STRING") != std::string::npos) return "a text in a record of numbers";
    if (name == "INT16SM") return "sign and magnitude is no type of a channel";
    if (name == "BCD_SIGNED") return "signed BCD is no type of a channel";
    if (name == "BCD_UNSIGNED") name = "bcd16";
    const auto type = type_by_name(name);
    if (!type) return fmt::format("the data type {} is unknown", name);
    point_.type = type->type;
    point_.word_order = type->word_order.value_or(WordOrder::kBigEndian);
    point_.byte_order = type->byte_order.value_or(ByteOrder::kBigEndian);
    note_states();
    if (const auto fault = read_bits(interface)) return fault;
    if (const auto fault = read_scale(interface)) return fault;
    read_drive_limits();
    return std::nullopt;
  }

  // Records with states become the register's number.
  void note_states() {
    if (record_.type == "bi" || record_.type == "bo")
      point_.changes.emplace_back("a number: 0 is off, any other is on");
    if (record_.type == "mbbi" || record_.type == "mbbo")
      point_.changes.emplace_back("the number of the register, not its state");
  }

  // @asynMask(PORT OFFSET BITS) of asynInt32: bits of read values, negative: signed. Written values
  // are not masked.
  MayFail read_bits(std::string_view interface) {
    if (!link_.masked || !interface.starts_with("asynInt32")) return std::nullopt;
    const auto said = c_number(link_.mask);
    if (!said || *said > 32 || *said < -32) return fmt::format("{} bits", link_.mask);
    if (*said == 0 || std::abs(*said) == 32) return std::nullopt;
    if (point_.type == ValueType::kFloat32 || point_.type == ValueType::kFloat64)
      return fmt::format("{} bits of a floating-point number", link_.mask);
    Encoding encoding;
    encoding.type = point_.type;
    const unsigned width = width_bits(encoding), bits = static_cast<unsigned>(std::abs(*said));
    const bool with_sign = *said < 0, reads = !writes(port_.function);
    bits_ = static_cast<int>(*said);
    if (point_.type == ValueType::kBcd16)
      return bits >= 14 ? MayFail() : fmt::format("{} bits of a BCD number", bits);
    const bool signed_type = point_.type == integer_of(width, true);
    if (bits > width)
      return signed_type && !with_sign ? fmt::format("{} bits of a number of {}", bits, width)
                                       : MayFail();
    if (bits == 8 && width == 16 && reads) {
      point_.byte = 0;
      point_.type = *integer_of(8, with_sign);
      return std::nullopt;
    }
    if (bits < width && with_sign && reads)
      return fmt::format("a sign in bit {} of a number of {} bits", bits - 1, width);
    point_.type = *integer_of(width, with_sign);
    if (bits < width)
      point_.changes.push_back(fmt::format("bits above {} are not cut off", bits - 1));
    return std::nullopt;
  }

  // Limits of written values in the units of the record; ignored if the upper one is not greater.
  void read_drive_limits() {
    if (!is_number(point_.type) || point_.access == Access::kReadOnly) return;
    const double low = number_field(record_, "DRVL").value_or(0);
    const double high = number_field(record_, "DRVH").value_or(0);
    if (high <= low) return;
    point_.write_min = low;
    point_.write_max = high;
    point_.changes.emplace_back("a value beyond DRVL and DRVH is refused, not brought to them");
  }

  MayFail read_text(const std::string& name, std::int64_t offset) {
    if (name.ends_with("LOW_HIGH")) {
      point_.byte_order = ByteOrder::kLittleEndian;
    } else if (!name.ends_with("HIGH_LOW")) {
      return "a text with one character in each register";
    }
    const auto elements = whole_from(field(record_, "NELM"));
    const bool waveform = record_.type == "waveform" || record_.type == "lsi";
    const std::int64_t room = port_.start < 0 ? port_.length : port_.length - offset;
    const std::int64_t wanted = waveform && elements ? static_cast<std::int64_t>(*elements) : 40;
    const std::int64_t bytes = std::min({wanted, 2 * room, std::int64_t{kMaxStringBytes}});
    if (bytes <= 0) return "a text without a length";
    point_.type = ValueType::kString;
    point_.string_bytes = static_cast<std::uint16_t>(bytes);
    return std::nullopt;
  }

  // VAL = raw * ASLO + AOFF, then LINR; asynFloat64 ignores LINR, asynInt64 returns the raw number.
  MayFail read_scale(std::string_view interface) {
    if (interface.starts_with("asynInt64")) return std::nullopt;
    if (const auto slope = number_field(record_, "ASLO"); slope && *slope != 0)
      point_.scale = *slope;
    point_.offset = number_field(record_, "AOFF").value_or(0);
    if (interface.starts_with("asynFloat64")) return std::nullopt;
    const std::string_view linear = field(record_, "LINR");
    if (linear.empty() || linear == "NO CONVERSION" || linear.starts_with("NO "))
      return std::nullopt;
    if (linear == "SLOPE") {
      apply(number_field(record_, "ESLO").value_or(1), number_field(record_, "EOFF").value_or(0));
      return std::nullopt;
    }
    if (linear != "LINEAR") return fmt::format("the conversion {} is not linear", linear);
    return read_range();
  }

  void apply(double slope, double offset) {
    point_.scale *= slope == 0 ? 1 : slope;
    point_.offset = point_.offset * (slope == 0 ? 1 : slope) + offset;
  }

  // LINEAR maps the range of the bits to EGUL .. EGUF. Signed values do not use the lowest number.
  MayFail read_range() {
    const double low = number_field(record_, "EGUL").value_or(0);
    const double high = number_field(record_, "EGUF").value_or(0);
    if (low == high) return "LINR is LINEAR without EGUL and EGUF";
    if (bits_ == 0) return "LINR is LINEAR without a number of bits";
    const double steps = static_cast<double>(std::int64_t{1} << std::abs(bits_));
    const double raw_low = bits_ < 0 ? 1 - steps / 2 : 0;
    const double raw_high = bits_ < 0 ? steps / 2 - 1 : steps - 1;
    if (raw_high == raw_low) return "LINR is LINEAR of one bit with a sign";
    const double slope = (high - low) / (raw_high - raw_low);
    apply(slope, low - raw_low * slope);
    return std::nullopt;
  }

  // Limits with a severity; they must increase.
  void read_alarms() {
    if (!is_number(point_.type) || point_.access == Access::kWriteOnly) return;
    const auto limit = [&](std::string_view value, std::string_view severity) {
      const std::string_view level = field(record_, severity);
      return level.empty() || level == "NO_ALARM" ? std::nullopt : number_field(record_, value);
    };
    const std::array limits{limit("LOLO", "LLSV"), limit("LOW", "LSV"), limit("HIGH", "HSV"),
                            limit("HIHI", "HHSV")};
    std::optional<double> before;
    for (const auto& one : limits) {
      if (one && before && *one <= *before) {
        point_.changes.emplace_back("without its alarm limits, which do not rise");
        return;
      }
      if (one) before = one;
    }
    point_.low_low = limits[0];
    point_.low = limits[1];
    point_.high = limits[2];
    point_.high_high = limits[3];
    const auto hysteresis = number_field(record_, "HYST");
    if (before && hysteresis && *hysteresis > 0) point_.hysteresis = hysteresis;
  }

  const EpicsRecord& record_;
  const AsynLink& link_;
  const ModbusPort& port_;
  Point point_;
  std::optional<std::uint8_t> bit_;
  unsigned elements_ = 0;  // 0: not an array
  int bits_ = 0;           // of asynMask; negative: signed, 0: unknown
};

}  // namespace

std::optional<AsynLink> link_of(const EpicsRecord& record) {
  std::string_view text = field(record, "INP");
  if (text.empty()) text = field(record, "OUT");
  text = trimmed(text);
  AsynLink link;
  link.masked = text.starts_with("@asynMask(");
  if (!link.masked && !text.starts_with("@asyn(")) return std::nullopt;
  const std::size_t open = text.find('('), close = text.find(')');
  if (close == std::string_view::npos) return std::nullopt;
  link.driver_user = trimmed(text.substr(close + 1));
  std::string inside(text.substr(open + 1, close - open - 1));
  std::ranges::replace(inside, ',', ' ');
  std::vector<std::string_view> parts;
  for (const std::string_view part : split(inside, ' ')) {
    if (!part.empty()) parts.push_back(part);
  }
  if (parts.empty()) return std::nullopt;
  link.port = parts[0];
  link.offset = parts.size() > 1 ? std::string(parts[1]) : "0";
  if (link.masked && parts.size() > 2) link.mask = parts[2];
  return link;
}

bool uses_epics_field(std::string_view name) {
  constexpr std::array<std::string_view, 25> kUsed{
      "AOFF", "ASLO", "DESC", "DRVH", "DRVL", "DTYP", "EGU",  "EGUF", "EGUL",
      "EOFF", "ESLO", "HHSV", "HIGH", "HIHI", "HSV",  "HYST", "INP",  "LINR",
      "LLSV", "LOLO", "LOW",  "LSV",  "NELM", "OUT",  "SCAN"};
  return std::ranges::find(kUsed, name) != kUsed.end();
}

std::optional<std::string> read_epics_record(const EpicsRecord& record, const AsynLink& link,
                                             const ModbusPort& port, std::vector<Point>& points) {
  return RecordReader(record, link, port).read(points);
}

}  // namespace fieldcast::importing
