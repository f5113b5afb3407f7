// Fuzzes the simulator: any text as a fault file of a plant, and any bytes from a master for each
// kind of device. A file is valid or has faults with place and reason, and a device sends at most
// one frame.
//
// Input: a line with the protocol of the device, pause in characters(1), then the bytes; or the
// line `faults`, then the file.
#include <algorithm>
#include <cstdlib>
#include <string>

#include "core/protocol/families/registry.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tools/sim/bus/fault_file.hpp"
#include "tools/sim/device/device.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::size_t kLongestAnswer = 4096;

using fuzz::require;

DeviceSpec device_of(std::string_view protocol) {
  DeviceSpec device{.name = "unit", .protocol = std::string(protocol)};
  device.link.address = 1;
  return device;
}

void read_faults(const std::string& text) {
  static const BridgeSpec plant = [] {
    BridgeSpec made;
    made.buses.push_back({.name = "line", .port = SerialPortSpec{"/dev/line"}});
    made.buses.back().devices = {device_of("modbus-rtu"), device_of("dtc")};
    made.buses.back().devices[1].name = "mixer";
    return made;
  }();
  const auto faults = parse_faults(text, "faults.yaml", plant);
  if (faults) return;
  require(!faults.error().empty());
  for (const config::Fault& fault : faults.error())
    require(!fault.what.empty() && fault.line >= 1 && fault.column >= 1 &&
            to_text(fault).find('\n') == std::string::npos);
}

void talk(const DeviceKind& kind, unsigned pause, ByteView bytes) {
  DeviceSetup setup{.spec = device_of(kind.protocol), .stream = !kind.half_duplex};
  setup.first_on_bus = true;
  const auto device = kind.make(setup);
  if (!device) return require(device.error().find('\n') == std::string::npos);
  const auto receiver = (*device)->open_receiver();
  Instant now{std::chrono::seconds{1}};
  const Duration character = setup.line.characters(1);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    now += i % 64 == 63 ? character * (1 + pause) : character;
    Reaction reaction;
    if (receiver->silence_due() <= now) receiver->on_silence(now, reaction);
    receiver->on_character(bytes[i], now, reaction);
    require(reaction.response.size() <= kLongestAnswer);
    if (reaction.hang_up) return;
  }
  for (int i = 0; i < 4 && receiver->silence_due() != kNever; ++i) {
    now = std::max(now, receiver->silence_due());
    Reaction reaction;
    receiver->on_silence(now, reaction);
    require(reaction.response.size() <= kLongestAnswer);
  }
}

void run_sim(ByteView data) {
  const auto end = std::ranges::find(data, '\n');
  const std::string name(data.begin(), end);
  if (data.end() - end < 2) return;
  const ByteView rest(end + 1, data.end());
  if (name == "faults") return read_faults(std::string(rest.begin(), rest.end()));
  if (const DeviceKind* const kind = find_device_kind(name)) talk(*kind, rest[0], rest.subspan(1));
}

}  // namespace
}  // namespace fieldcast::sim

FIELDCAST_FUZZ_TARGET(fieldcast::sim::run_sim)
