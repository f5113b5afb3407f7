#include "core/bus/wire/fence_text.hpp"

#include <algorithm>

#include "core/bus/wire/fence_times.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast {
namespace {

std::string listening(const BusSpec& bus) {
  const FenceTimes times = fence_times(bus);
  return "listening: nothing is sent before the wire was silent for " + to_text(times.listen) +
         ", and then something at least each " + to_text(times.hold) +
         "; it needs a line of two wires, on which each bridge hears the other";
}

// With a framed protocol over TCP each client has its own connection.
bool only_network_protocols(const BusSpec& bus) {
  return std::ranges::all_of(bus.devices, [](const DeviceSpec& device) {
    const ProtocolEntry* entry = find_protocol(device.protocol);
    return entry != nullptr && entry->network_only;
  });
}

FenceText of(const SerialPortSpec& port, const BusSpec& bus) {
  if (port.fence.is(Fence::kListen)) return {listening(bus)};
  if (port.fence.is(Fence::kLock))
    return {"the lock of " + port.path + ": it holds between bridges of one host, no further"};
  return {
      "none: two bridges that do not hear of each other could send into each other; set 'fence: "
      "listen', or 'fence: lock' where all bridges of the group run on one host",
      true};
}

FenceText of(const TcpPortSpec& port, const BusSpec& bus) {
  if (port.fence.is(Fence::kListen)) return {listening(bus)};
  if (port.fence.is(Fence::kOneClient)) {
    return {"one client: the server at " + port.name() +
            " must take one connection only; the bridge that has it is the one that sends"};
  }
  if (!port.line && only_network_protocols(bus))
    return {"none is needed: each client has a connection of its own, and no frame is garbled"};
  return {
      "none: two bridges that do not hear of each other could send into each other; let the serial "
      "server take one connection only, and set 'fence: one-client'",
      true};
}

FenceText of(const DialInPortSpec&, const BusSpec&) {
  return {"one client: the module has one connection, to the bridge that it dialled"};
}

}  // namespace

FenceText fence_text(const BusSpec& bus) {
  return std::visit([&](const auto& port) { return of(port, bus); }, bus.port);
}

}  // namespace fieldcast
