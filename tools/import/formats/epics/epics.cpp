// EPICS with the modbus module: a startup script and its records. Files named in a script are
// looked up by file name among the inputs.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "tools/import/formats/epics/epics_files.hpp"
#include "tools/import/formats/epics/epics_record.hpp"
#include "tools/import/formats/format.hpp"
#include "tools/import/points/names.hpp"
#include "tools/import/text/text.hpp"

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
      octets_[name].port.tcp = host.substr(0, host.find(' '));
      octets_[name].origin = call.origin;
      if (host.find("UDP") != std::string_view::npos)
        found_.notes.push_back(fmt::format("{}: UDP is not moved; TCP is taken", name));
      if (octets_[name].protocol.empty()) octets_[name].protocol = "modbus-tcp";
    } else if (call.command == "drvAsynSerialPortConfigure") {
      octets_[name].port.serial = call.argument(1);
      octets_[name].port.usual = {9600, "asyn"};
      octets_[name].origin = call.origin;
      if (octets_[name].protocol.empty()) octets_[name].protocol = "modbus-rtu";
    } else if (call.command == "asynSetOption") {
      if (!set_option(octets_[name], call.argument(2), call.argument(3)))
        other_keys_[call.origin.file].add(call.argument(2), call.command, call.origin.line);
    } else if (call.command == "modbusInterposeConfig") {
      interpose(octets_[name], call);
    } else if (call.command == "drvModbusAsynConfigure") {
      configure(name, call);
    }
  }

  // False if no line of a bus has the option.
  static bool set_option(OctetPort& octet, std::string_view key, std::string_view value) {
    if (key == "baud") {
      const auto baud = whole_from(value);
      if (baud && *baud < 10'000'000) octet.port.line.baud = static_cast<std::uint32_t>(*baud);
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
    const auto link = c_number(call.argument(1));
    if (link && *link >= 0 && *link < 4) octet.protocol = kLinks[*link];
    const auto timeout = c_number(call.argument(2)), pause = c_number(call.argument(3));
    if (timeout && *timeout > 0 && *timeout <= 60'000)
      octet.timeout = std::chrono::milliseconds{*timeout};
    if (pause && *pause > 0 && *pause <= 60'000) octet.pause = std::chrono::milliseconds{*pause};
  }

  void configure(const std::string& name, const IocCall& call) {
    ModbusPort port;
    port.octet_port = call.argument(1);
    const auto slave = c_number(call.argument(2)), function = c_number(call.argument(3)),
               start = c_number(call.argument(4)), length = c_number(call.argument(5));
    if (slave && (*slave < 0 || *slave > 255)) {
      found_.refusals.push_back(
          {name, call.origin, fmt::format("{} is no address of a device on its bus", *slave)});
      return;
    }
    if (!slave || !function || *function < 0 || *function > 255 || !start || *start > 65535 ||
        !length) {
      found_.refusals.push_back(
          {name, call.origin, "the arguments of drvModbusAsynConfigure are no numbers"});
      return;
    }
    port.slave = static_cast<std::uint16_t>(*slave);
    port.function = static_cast<unsigned>(*function);
    port.start = *start;
    port.length = *length;
    port.data_type = call.argument(6);
    port.poll_ms = c_number(call.argument(7)).value_or(0);
    port.other_address_back = call.argument(8).find("Wago") != std::string_view::npos;
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
    std::vector<Point>& points = device_of(port->second).points;
    if (auto fault = read_epics_record(record, *link, port->second, points))
      return refuse(std::move(*fault));
    for (const auto& [name, value] : record.fields) {
      if (!uses_epics_field(name))
        other_keys_[record.origin.file].add(name, "a record", record.origin.line);
    }
  }

  Device& device_of(const ModbusPort& port) {
    Bus& bus = buses_[port.octet_port];
    for (Device& device : bus.devices) {
      if (device.address == port.slave) return device;
    }
    Device& device = bus.devices.emplace_back();
    device.address = port.slave;
    device.name = fmt::format("{}-{}", port.octet_port, port.slave);
    return device;
  }

  const EpicsFiles& files_;
  Found found_;
  std::map<std::string, OctetPort> octets_;
  std::map<std::string, ModbusPort, std::less<>> ports_;
  std::map<std::string, Bus> buses_;  // by asyn port
  std::size_t others_ = 0;
  std::map<std::string, OtherKeys> other_keys_;  // by file
};

}  // namespace

Confidence recognise_epics(const SourceText& source) {
  const std::string_view text = source.text;
  if (text.find("drvModbusAsynConfigure") != std::string_view::npos) return kCertain;
  if (is_database(text) && text.find("asyn") != std::string_view::npos) return kCertain;
  if (is_startup_script(text)) return kLikely;
  return is_substitutions(text) ? kLikely : is_database(text) ? kGuess : 0;
}

Read read_epics(std::span<const SourceText> sources, const ReadOptions&) {
  const EpicsFiles files = load_epics(sources);
  return EpicsReader(files).read();
}

}  // namespace fieldcast::importing
