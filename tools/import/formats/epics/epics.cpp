// EPICS with the modbus module: a startup script and its records. Files named in a script are
// looked up by file name among the inputs.
#include <map>

#include "tools/import/formats/epics/epics_files.hpp"
#include "tools/import/formats/epics/epics_record.hpp"

namespace fieldcast::importing {
namespace {

struct OctetPort {
  Port port;
  char parity = 'N';
  std::string bits = "8", stop = "1";
  std::string protocol;
  std::optional<Duration> timeout, pause;
  Origin origin;
};

class EpicsReader {
 public:
  explicit EpicsReader(const EpicsFiles& files) : files_(files) {}

  Found read() {
    found_.refusals = files_.refusals;
    for (const IocCall& call : files_.calls) obey(call);
    for (const EpicsRecord& record : files_.records) read_record(record);
    for (auto& [name, bus] : buses_) {
      const OctetPort& octet = octets_[name];
      bus.name = name;
      bus.port = octet.port;
      if (bus.port.tcp.empty() && !bus.port.serial.empty())
        bus.port.line.format = octet.bits + octet.parity + octet.stop;
      bus.protocol = octet.protocol;
      bus.origin = octet.origin;
      for (Device& device : bus.devices) {
        device.timeout = octet.timeout;
        device.pause = octet.pause;
        if (bus.devices.size() == 1) device.name = name;
      }
      found_.buses.push_back(std::move(bus));
    }
    if (files_.driver_records > 0)
      found_.notes.push_back(
          fmt::format("{} records about the driver itself (statistics, delays, asyn) are not moved",
                      files_.driver_records));
    if (others_ > 0)
      found_.notes.push_back(fmt::format(
          "{} records that read no device (calculations, constants) are not moved", others_));
    for (const auto& [file, keys] : other_keys_) keys.tell(file, found_);
    return std::move(found_);
  }

 private:
  void obey(const IocCall& call) {
    const std::string name(call.argument(0));
    if (call.command == "drvAsynIPPortConfigure") {
      const std::string_view host = call.argument(1);
      OctetPort& octet = octet_of(name, call, "modbus-tcp");
      octet.port.tcp = host.substr(0, host.find(' '));
      if (contains(host, "UDP"))
        found_.notes.push_back(fmt::format("{}: UDP is not moved; TCP is taken", name));
    } else if (call.command == "drvAsynSerialPortConfigure") {
      OctetPort& octet = octet_of(name, call, "modbus-rtu");
      octet.port.serial = call.argument(1);
      octet.port.usual = {9600, "asyn"};
    } else if (call.command == "asynSetOption") {
      if (!set_option(octets_[name], call.argument(2), call.argument(3)))
        other_keys_[call.origin.file].add(call.argument(2), call.command, call.origin.line);
    } else if (call.command == "modbusInterposeConfig") {
      interpose(octets_[name], call);
    } else if (call.command == "drvModbusAsynConfigure") {
      configure(name, call);
    }
  }

  OctetPort& octet_of(const std::string& name, const IocCall& call, std::string_view protocol) {
    OctetPort& octet = octets_[name];
    octet.origin = call.origin;
    if (octet.protocol.empty()) octet.protocol = protocol;
    return octet;
  }

  // False if no line of a bus has the option.
  static bool set_option(OctetPort& octet, std::string_view key, std::string_view value) {
    if (key == "baud") {
      if (const auto baud = whole_from(value, 0, 9'999'999))
        octet.port.line.baud = static_cast<std::uint32_t>(*baud);
    } else if (key == "bits") {
      octet.bits = value;
    } else if (key == "stop") {
      octet.stop = value;
    } else if (key == "parity") {
      octet.parity = value.starts_with('e') ? 'E' : value.starts_with('o') ? 'O' : 'N';
    } else {
      return false;
    }
    return true;
  }

  static void interpose(OctetPort& octet, const IocCall& call) {
    constexpr std::string_view kLinks[] = {"modbus-tcp", "modbus-rtu", "modbus-ascii",
                                           "modbus-tcp"};
    if (const auto link = c_number(call.argument(1), 0, 3)) octet.protocol = kLinks[*link];
    if (const auto timeout = c_number(call.argument(2), 1, 60'000))
      octet.timeout = std::chrono::milliseconds{*timeout};
    if (const auto pause = c_number(call.argument(3), 1, 60'000))
      octet.pause = std::chrono::milliseconds{*pause};
  }

  void configure(const std::string& name, const IocCall& call) {
    const auto slave = c_number(call.argument(2)), function = c_number(call.argument(3), 0, 255),
               start = c_number(call.argument(4)), length = c_number(call.argument(5));
    const auto refuse = [&](std::string reason) {
      found_.refusals.push_back({name, call.origin, std::move(reason)});
    };
    if (slave && (*slave < 0 || *slave > 255))
      return refuse(fmt::format("{} is no address of a device on its bus", *slave));
    if (!slave || !function || !start || *start > 65535 || !length)
      return refuse("the arguments of drvModbusAsynConfigure are no numbers");
    ModbusPort port;
    port.octet_port = call.argument(1);
    port.slave = static_cast<std::uint16_t>(*slave);
    port.function = static_cast<unsigned>(*function);
    port.start = *start;
    port.length = *length;
    port.data_type = call.argument(6);
    port.poll_ms = c_number(call.argument(7)).value_or(0);
    port.other_address_back = contains(call.argument(8), "Wago");
    ports_[name] = std::move(port);
  }

  void read_record(const EpicsRecord& record) {
    const auto link = link_of(record);
    if (!link) {
      ++others_;
      return;
    }
    const auto refuse = [&](std::string reason) {
      found_.refusals.push_back({record.name, record.origin, std::move(reason)});
    };
    const auto port = ports_.find(link->port);
    if (port == ports_.end())
      return refuse(files_.has_script
                        ? fmt::format("no drvModbusAsynConfigure makes the port '{}'", link->port)
                        : "the startup script (st.cmd) names the line; give it as well");
    Device& device = device_at(buses_[port->second.octet_port], port->second.slave);
    device.name = fmt::format("{}-{}", port->second.octet_port, port->second.slave);
    if (auto fault = read_epics_record(record, *link, port->second, device.points))
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
  std::map<std::string, Bus> buses_;  // by asyn port
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

Read read_epics(std::span<const SourceText> sources, const ReadOptions&) {
  const EpicsFiles files = load_epics(sources);
  return EpicsReader(files).read();
}

}  // namespace

constinit const Format kEpicsFormat{"epics", "EPICS modbus: st.cmd, databases, substitutions",
                                    recognise_epics, read_epics, "0"};

}  // namespace fieldcast::importing
