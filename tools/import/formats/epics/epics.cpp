// EPICS with the modbus module: a startup script and its records. Files named in a script are
// looked up by file name among the inputs.
//
// Source: epics-modules/modbus docs/source/creating_driver.rst (data types), device_support.rst
// (interfaces, offsets, masks); epics-modules/asyn devAsynInt32.c, devAsynInt64.c, devAsynFloat64.c
// (bits, conversion of each interface); EPICS record reference (LINR, ASLO, AOFF, DRVH, alarms).
#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <map>
#include <tuple>

#include "tools/import/formats/epics/epics_files.hpp"
#include "tools/import/points/address.hpp"
#include "tools/import/points/types.hpp"

namespace fieldcast::importing {
namespace {

struct ModbusPort {
  std::string octet_port;  // port of its line
  std::uint16_t slave = 0;
  unsigned function = 0;
  std::int64_t start = 0;  // -1: offsets are addresses
  std::int64_t length = 0;
  std::string data_type;
  std::int64_t poll_ms = 0;
  bool other_address_back = false;  // Wago: written registers are read at other addresses
};

// "@asynMask(PORT OFFSET MASK TIMEOUT)DRVUSER"
struct AsynLink {
  bool masked = false;
  std::string port, offset, mask, driver_user;
};

// modbusDataType_t since R3-1, for scripts that use the number.
constexpr std::string_view kNumbered =
    "INT16 INT16SM BCD_UNSIGNED BCD_SIGNED UINT16 INT32_LE INT32_LE_BS INT32_BE INT32_BE_BS "
    "UINT32_LE UINT32_LE_BS UINT32_BE UINT32_BE_BS INT64_LE INT64_LE_BS INT64_BE "
    "INT64_BE_BS UINT64_LE UINT64_LE_BS UINT64_BE UINT64_BE_BS FLOAT32_LE FLOAT32_LE_BS "
    "FLOAT32_BE FLOAT32_BE_BS FLOAT64_LE FLOAT64_LE_BS FLOAT64_BE FLOAT64_BE_BS STRING_HIGH "
    "STRING_LOW STRING_HIGH_LOW STRING_LOW_HIGH ZSTRING_HIGH ZSTRING_LOW ZSTRING_HIGH_LOW "
    "ZSTRING_LOW_HIGH";

std::string_view epics_field(const EpicsRecord& record, std::string_view name) {
  const auto found = record.fields.find(name);
  return found == record.fields.end() ? std::string_view() : std::string_view(found->second);
}

// Functions of a port; 123 and 223 read and write with function 23.
constexpr Words<ModbusArea> kAreas[] = {{"1 5 15", ModbusArea::kCoil},
                                        {"2", ModbusArea::kInput},
                                        {"4", ModbusArea::kInputRegister},
                                        {"3 6 16 123 223", ModbusArea::kHolding}};
constexpr std::string_view kWriting = "5 6 15 16 223";

class RecordReader {
 public:
  RecordReader(const EpicsRecord& record, const AsynLink& link, const ModbusPort& port)
      : record_(record),
        link_(link),
        port_(port),
        out_(is_one_of(std::to_string(port.function), kWriting)) {}

  MayFail read(std::vector<Point>& points) {
    const auto area = value_of(kAreas, std::to_string(port_.function));
    if (!area) return fmt::format("its port uses the function {}", port_.function);
    const auto offset = c_number(link_.offset);
    const std::int64_t first = offset.value_or(-1) + std::max<std::int64_t>(port_.start, 0);
    if (!offset || *offset < 0 || first > 65535)
      return fmt::format("'{}' is no offset", link_.offset);
    point_.name = record_.name;
    point_.origin = record_.origin;
    point_.unit = field("EGU");
    point_.description = field("DESC");
    if (auto fault = read_direction()) return fault;
    if (auto fault = read_value(*area, *offset)) return fault;
    read_alarms();
    point_.at = address_text(*area, static_cast<std::uint64_t>(first), point_.bit);
    append_points(points, std::move(point_), *area, static_cast<std::uint32_t>(first), elements_);
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::string_view field(std::string_view name) const {
    return epics_field(record_, name);
  }
  [[nodiscard]] std::optional<double> number(std::string_view name) const {
    return number_from(field(name));
  }
  [[nodiscard]] bool is_record(std::string_view types) const {
    return is_one_of(record_.type, types);
  }

  MayFail read_direction() {
    const std::string_view interface = field("DTYP");
    const bool out_record = record_.fields.contains("OUT") || contains(interface, "Out") ||
                            interface == "asynOctetWrite";
    if (out_record != out_)
      return fmt::format("the record {}, its port has the function {}",
                         out_record ? "writes" : "reads", port_.function);
    if (!out_) {
      read_period();
    } else if (port_.poll_ms > 0 && !port_.other_address_back) {
      point_.access = Access::kReadWrite;
      point_.change("it is read again and again, not only at the start");
    } else {
      point_.access = Access::kWriteOnly;
    }
    return std::nullopt;
  }

  // ".1 second", "10 second"; other values use the poll time of the port.
  void read_period() {
    const std::string_view scan = field("SCAN");
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
    const std::string_view interface = field("DTYP");
    if (contains(interface, "Array")) {
      const auto count = whole_from(field("NELM"), 1, 2000);
      if (!count) return "an array without NELM";
      elements_ = static_cast<unsigned>(*count);
    }
    if (holds_bits(area)) {
      point_.type = ValueType::kBool;
      const bool one_bit = !link_.masked || interface != "asynUInt32Digital" ||
                           c_number(link_.mask).value_or(1) == 1;
      if (!one_bit) return "several bits in one record; write a channel for each";
      return is_record("ai ao") ? read_scale(interface) : MayFail();
    }
    if (interface == "asynUInt32Digital") return read_mask();
    return read_typed(interface, offset);
  }

  MayFail read_mask() {
    const auto mask = static_cast<std::uint16_t>(c_number(link_.mask).value_or(0xFFFF));
    if (std::has_single_bit(mask)) {
      point_.bit = static_cast<std::uint8_t>(std::countr_zero(mask));
      point_.type = ValueType::kBool;
      return std::nullopt;
    }
    if (mask != 0 && mask != 0xFFFF)
      return fmt::format("the bits {} of a register; a channel has one bit or all", link_.mask);
    if (is_record("bi bo")) return "a bit without its mask";
    point_.type = ValueType::kUint16;
    return std::nullopt;
  }

  MayFail read_typed(std::string_view interface, std::int64_t offset) {
    std::string name = link_.driver_user;
    if (name.empty() || name == "MODBUS_DATA") name = port_.data_type;
    if (const auto index = c_number(name)) {
      const auto names = split(kNumbered, ' ');
      if (*index < 0 || *index >= static_cast<std::int64_t>(names.size()))
        return fmt::format("the data type {} is unknown", name);
      name = names[static_cast<std::size_t>(*index)];
      if (*index != 0) point_.change("data type {} is taken for {}, as since R3-1", *index, name);
    }
    if (interface.starts_with("asynOctet")) return read_text(name, offset);
    if (contains(name, "STRING")) return "a text in a record of numbers";
    if (name == "INT16SM") return "sign and magnitude is no type of a channel";
    if (name == "BCD_SIGNED") return "signed BCD is no type of a channel";
    if (name == "BCD_UNSIGNED") name = "bcd16";
    const auto type = type_by_name(name);
    if (!type) return fmt::format("the data type {} is unknown", name);
    point_.type = type->type;
    point_.word_order = type->word_order.value_or(WordOrder::kBigEndian);
    point_.byte_order = type->byte_order.value_or(ByteOrder::kBigEndian);
    if (is_record("bi bo")) point_.change("a number: 0 is off, any other is on");
    if (is_record("mbbi mbbo")) point_.change("the number of the register, not its state");
    if (auto fault = read_bits(interface)) return fault;
    if (auto fault = read_scale(interface)) return fault;
    read_drive_limits();
    return std::nullopt;
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
    const bool with_sign = *said < 0;
    bits_ = static_cast<int>(*said);
    if (point_.type == ValueType::kBcd16)
      return bits >= 14 ? MayFail() : fmt::format("{} bits of a BCD number", bits);
    const bool signed_type = point_.type == integer_of(width, true);
    if (bits > width)
      return signed_type && !with_sign ? fmt::format("{} bits of a number of {}", bits, width)
                                       : MayFail();
    if (bits == 8 && width == 16 && !out_) {
      point_.byte = 0;
      point_.type = *integer_of(8, with_sign);
      return std::nullopt;
    }
    if (bits < width && with_sign && !out_)
      return fmt::format("a sign in bit {} of a number of {} bits", bits - 1, width);
    point_.type = *integer_of(width, with_sign);
    if (bits < width) point_.change("bits above {} are not cut off", bits - 1);
    return std::nullopt;
  }

  // Limits of written values in the units of the record; ignored if the upper one is not greater.
  void read_drive_limits() {
    if (!is_number(point_.type) || point_.access == Access::kReadOnly) return;
    const double low = number("DRVL").value_or(0), high = number("DRVH").value_or(0);
    if (high <= low) return;
    point_.write_min = low;
    point_.write_max = high;
    point_.change("a value beyond DRVL and DRVH is refused, not brought to them");
  }

  MayFail read_text(const std::string& name, std::int64_t offset) {
    if (name.ends_with("LOW_HIGH")) {
      point_.byte_order = ByteOrder::kLittleEndian;
    } else if (!name.ends_with("HIGH_LOW")) {
      return kSparseText;
    }
    const auto elements = whole_from(field("NELM"));
    const std::int64_t room = port_.start < 0 ? port_.length : port_.length - offset;
    const std::int64_t wanted =
        is_record("waveform lsi") && elements ? static_cast<std::int64_t>(*elements) : 40;
    const std::int64_t bytes = std::min({wanted, 2 * room, std::int64_t{kMaxStringBytes}});
    if (bytes <= 0) return "a text without a length";
    point_.type = ValueType::kString;
    point_.string_bytes = static_cast<std::uint16_t>(bytes);
    return std::nullopt;
  }

  // VAL = raw * ASLO + AOFF, then LINR; asynFloat64 ignores LINR, asynInt64 returns the raw number.
  MayFail read_scale(std::string_view interface) {
    if (interface.starts_with("asynInt64")) return std::nullopt;
    if (const auto slope = number("ASLO"); slope && *slope != 0) point_.scale = *slope;
    point_.offset = number("AOFF").value_or(0);
    if (interface.starts_with("asynFloat64")) return std::nullopt;
    const std::string_view linear = field("LINR");
    if (linear.empty() || linear.starts_with("NO ")) return std::nullopt;
    if (linear == "LINEAR") return read_range();
    if (linear != "SLOPE") return fmt::format("the conversion {} is not linear", linear);
    apply(number("ESLO").value_or(1), number("EOFF").value_or(0));
    return std::nullopt;
  }

  void apply(double slope, double offset) {
    point_.scale *= slope == 0 ? 1 : slope;
    point_.offset = point_.offset * (slope == 0 ? 1 : slope) + offset;
  }

  MayFail read_range() {
    const double low = number("EGUL").value_or(0), high = number("EGUF").value_or(0);
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
      const std::string_view level = field(severity);
      return level.empty() || level == "NO_ALARM" ? std::nullopt : number(value);
    };
    const std::array limits{limit("LOLO", "LLSV"), limit("LOW", "LSV"), limit("HIGH", "HSV"),
                            limit("HIHI", "HHSV")};
    std::optional<double> before;
    for (const auto& one : limits) {
      if (one && before && *one <= *before) {
        point_.change("without its alarm limits, which do not rise");
        return;
      }
      if (one) before = one;
    }
    std::tie(point_.low_low, point_.low, point_.high, point_.high_high) =
        std::tie(limits[0], limits[1], limits[2], limits[3]);
    const auto hysteresis = number("HYST");
    if (before && hysteresis && *hysteresis > 0) point_.hysteresis = hysteresis;
  }

  const EpicsRecord& record_;
  const AsynLink& link_;
  const ModbusPort& port_;
  const bool out_;
  Point point_;
  unsigned elements_ = 0;  // 0: not an array
  int bits_ = 0;           // of asynMask; negative: signed, 0: unknown
};

std::optional<AsynLink> link_of(const EpicsRecord& record) {
  const std::string_view input = epics_field(record, "INP");
  const std::string_view text = trimmed(input.empty() ? epics_field(record, "OUT") : input);
  AsynLink link;
  link.masked = text.starts_with("@asynMask(");
  if (!link.masked && !text.starts_with("@asyn(")) return std::nullopt;
  const std::size_t open = text.find('('), close = text.find(')');
  if (close == std::string_view::npos) return std::nullopt;
  link.driver_user = trimmed(text.substr(close + 1));
  std::string inside(text.substr(open + 1, close - open - 1));
  std::ranges::replace(inside, ',', ' ');
  auto parts = split(inside, ' ');
  std::erase(parts, "");
  if (parts.empty()) return std::nullopt;
  link.port = parts[0];
  link.offset = parts.size() > 1 ? std::string(parts[1]) : "0";
  if (link.masked && parts.size() > 2) link.mask = parts[2];
  return link;
}

bool uses_epics_field(std::string_view name) {
  return is_one_of(name,
                   "AOFF ASLO DESC DRVH DRVL DTYP EGU EGUF EGUL EOFF ESLO HHSV HIGH HIHI HSV HYST "
                   "INP LINR LLSV LOLO LOW LSV NELM OUT SCAN");
}

// A serial line or a TCP connection.
struct OctetPort {
  Bus bus;
  std::string parity = "N", bits = "8", stop = "1";
  std::optional<Duration> timeout, pause;
};

class EpicsReader {
 public:
  explicit EpicsReader(const EpicsFiles& files) : files_(files) {}

  Found read() {
    found_.refusals = files_.refusals;
    for (const IocCall& call : files_.calls) obey(call);
    for (const EpicsRecord& record : files_.records) read_record(record);
    for (auto& [name, octet] : octets_) {
      Bus& bus = octet.bus;
      if (bus.devices.empty()) continue;
      bus.name = name;
      if (bus.port.tcp.empty() && !bus.port.serial.empty())
        bus.port.line.format = octet.bits + octet.parity + octet.stop;
      for (Device& device : bus.devices) {
        device.timeout = octet.timeout;
        device.pause = octet.pause;
        if (bus.devices.size() == 1) device.name = name;
      }
      found_.buses.push_back(std::move(bus));
    }
    if (files_.driver_records > 0)
      found_.note("{} records about the driver itself (statistics, delays, asyn) are not moved",
                  files_.driver_records);
    if (others_ > 0)
      found_.note("{} records that read no device (calculations, constants) are not moved",
                  others_);
    for (const auto& [file, keys] : other_keys_) keys.tell(file, found_);
    return std::move(found_);
  }

 private:
  void obey(const IocCall& call) {
    const std::string name(call.argument(0));
    if (call.command == "drvAsynIPPortConfigure") {
      const std::string_view host = call.argument(1);
      begin(name, call, "modbus-tcp").tcp = host.substr(0, host.find(' '));
      if (contains(host, "UDP")) found_.note("{}: UDP is not moved; TCP is taken", name);
    } else if (call.command == "drvAsynSerialPortConfigure") {
      Port& port = begin(name, call, "modbus-rtu");
      port.serial = call.argument(1);
      port.usual = {9600, "asyn"};
    } else if (call.command == "asynSetOption") {
      if (!set_option(octets_[name], call.argument(2), call.argument(3)))
        other_keys_[call.origin.file].add(call.argument(2), call.command, call.origin.line);
    } else if (call.command == "modbusInterposeConfig") {
      interpose(octets_[name], call);
    } else if (call.command == "drvModbusAsynConfigure") {
      configure(name, call);
    }
  }

  Port& begin(const std::string& name, const IocCall& call, std::string_view protocol) {
    Bus& bus = octets_[name].bus;
    bus.origin = call.origin;
    if (bus.protocol.empty()) bus.protocol = protocol;
    return bus.port;
  }

  static bool set_option(OctetPort& octet, std::string_view key, std::string_view value) {
    if (key == "baud") {
      if (const auto baud = whole_from<std::uint32_t>(value, 0, 9'999'999))
        octet.bus.port.line.baud = baud;
    } else if (key == "bits") {
      octet.bits = value;
    } else if (key == "stop") {
      octet.stop = value;
    } else if (key == "parity") {
      octet.parity = value.starts_with('e') ? "E" : value.starts_with('o') ? "O" : "N";
    } else {
      return false;
    }
    return true;
  }

  static void interpose(OctetPort& octet, const IocCall& call) {
    constexpr std::string_view kLinks[] = {"modbus-tcp", "modbus-rtu", "modbus-ascii",
                                           "modbus-tcp"};
    if (const auto link = c_number(call.argument(1), 0, 3)) octet.bus.protocol = kLinks[*link];
    if (const auto timeout = c_number(call.argument(2), 1, 60'000))
      octet.timeout = std::chrono::milliseconds{*timeout};
    if (const auto pause = c_number(call.argument(3), 1, 60'000))
      octet.pause = std::chrono::milliseconds{*pause};
  }

  void configure(const std::string& name, const IocCall& call) {
    const auto slave = c_number(call.argument(2)), function = c_number(call.argument(3), 0, 255),
               start = c_number(call.argument(4)), length = c_number(call.argument(5));
    if (slave && (*slave < 0 || *slave > 255))
      return found_.refuse(name, call.origin,
                           fmt::format("{} is no address of a device on its bus", *slave));
    if (!slave || !function || !start || *start > 65535 || !length)
      return found_.refuse(name, call.origin,
                           "the arguments of drvModbusAsynConfigure are no numbers");
    ports_[name] = {.octet_port = std::string(call.argument(1)),
                    .slave = static_cast<std::uint16_t>(*slave),
                    .function = static_cast<unsigned>(*function),
                    .start = *start,
                    .length = *length,
                    .data_type = std::string(call.argument(6)),
                    .poll_ms = c_number(call.argument(7)).value_or(0),
                    .other_address_back = contains(call.argument(8), "Wago")};
  }

  void read_record(const EpicsRecord& record) {
    const auto link = link_of(record);
    if (!link) return static_cast<void>(++others_);
    const auto refuse = [&](std::string reason) {
      found_.refuse(record.name, record.origin, std::move(reason));
    };
    const auto port = ports_.find(link->port);
    if (port == ports_.end())
      return refuse(files_.has_script
                        ? fmt::format("no drvModbusAsynConfigure makes the port '{}'", link->port)
                        : "the startup script (st.cmd) names the line; give it as well");
    const auto& [octet_port, slave] = std::tie(port->second.octet_port, port->second.slave);
    Device& device = device_at(octets_[octet_port].bus, slave);
    device.name = fmt::format("{}-{}", octet_port, slave);
    if (auto fault = RecordReader(record, *link, port->second).read(device.points))
      return refuse(std::move(*fault));
    for (const auto& [name, value] : record.fields) {
      if (!uses_epics_field(name))
        other_keys_[record.origin.file].add(name, "a record", record.origin.line);
    }
  }

  const EpicsFiles& files_;
  Found found_;
  std::map<std::string, OctetPort> octets_;
  std::map<std::string, ModbusPort, std::less<>> ports_;
  std::size_t others_ = 0;
  std::map<std::string, OtherKeys> other_keys_;  // by file
};

Confidence recognise_epics(const SourceText& source) {
  const std::string_view text = source.text;
  if (contains(text, "drvModbusAsynConfigure")) return kCertain;
  if (is_database(text) && contains(text, "asyn")) return kCertain;
  if (is_startup_script(text)) return kLikely;
  return is_substitutions(text) ? kLikely : is_database(text) ? kGuess : 0;
}

Read read_epics(Sources sources, const ReadOptions&) {
  const EpicsFiles files = load_epics(sources);
  return EpicsReader(files).read();
}

}  // namespace

constinit const Format kEpicsFormat{"epics", "EPICS modbus: st.cmd, databases, substitutions",
                                    recognise_epics, read_epics, "0"};

}  // namespace fieldcast::importing
