#include "core/bus/wire/fence_setup.hpp"

#include <algorithm>
#include <set>

#include "core/bus/setup/bus_setup.hpp"
#include "core/bus/wire/pending_responses.hpp"
#include "core/model/bus_spec.hpp"
#include "core/protocol/families/registry.hpp"

namespace fieldcast {

namespace {

// Delay of the adapters of two bridges (latency timers of 16 ms), with a margin.
constexpr Duration kSlowestAdapters = std::chrono::milliseconds{35};

// Longest silence after a request, including the wait for late responses without identity.
Duration silence_behind(const DeviceSpec& device, const BusSpec& bus) {
  const auto protocol = make_protocol(device, line_of(bus.port));
  const auto read = std::ranges::find_if(
      device.channels, [](const ChannelSpec& channel) { return !channel.calculation; });
  if (!protocol || read == device.channels.end()) return {};
  const bool nameless = (*protocol)->traits().identity == ResponseIdentity::kNone;
  const auto size = (*protocol)->size(ReadRequest{{read->range}});
  Duration wait = device.timeout * (nameless ? PendingResponses::kLateFactor : 1);
  for (const Area& area : (*protocol)->areas()) wait = std::max(wait, area.no_response);
  return wait + bus.gap_allowance + device.pause + (size ? size->pauses : Duration{});
}

}  // namespace

FenceTimes fence_times(const BusSpec& bus) {
  FenceTimes times;
  times.hold = fence_of(bus.port).hold;
  times.quiet = times.hold;
  for (const DeviceSpec& device : bus.devices)
    times.quiet = std::max(times.quiet, silence_behind(device, bus));
  times.claim = times.quiet + times.hold;
  times.listen = times.claim + times.hold;
  times.slot = std::max(times.hold / 4, kSlowestAdapters + line_of(bus.port).characters(2));
  return times;
}

namespace {

std::string listening(const BusSpec& bus) {
  const FenceTimes times = fence_times(bus);
  return "listening: nothing is sent before the wire was silent for " + to_text(times.listen) +
         ", and then something at least each " + to_text(times.hold) +
         "; it needs a line of two wires, on which each bridge hears the other";
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

// A serial server, with or without RFC 2217.
FenceText of_server(const FenceSpec& fence, const std::string& name, const BusSpec& bus) {
  if (fence.is(Fence::kListen)) return {listening(bus)};
  if (fence.is(Fence::kOneClient)) {
    return {"one client: the server at " + name +
            " must take one connection only; the bridge that has it is the one that sends"};
  }
  return {
      "none: two bridges that do not hear of each other could send into each other; let the serial "
      "server take one connection only, and set 'fence: one-client'",
      true};
}

FenceText of(const TcpPortSpec& port, const BusSpec& bus) {
  // With a framed protocol over TCP each client has its own connection.
  const bool fenced = port.fence.is(Fence::kListen) || port.fence.is(Fence::kOneClient);
  if (!fenced && !port.line && only_network_protocols(bus))
    return {"none is needed: each client has a connection of its own, and no frame is garbled"};
  return of_server(port.fence, port.name(), bus);
}

FenceText of(const Rfc2217PortSpec& port, const BusSpec& bus) {
  return of_server(port.fence, port.name(), bus);
}

FenceText of(const DialInPortSpec&, const BusSpec&) {
  return {"one client: the module has one connection, to the bridge that it dialled"};
}

}  // namespace

FenceText fence_text(const BusSpec& bus) {
  return std::visit([&](const auto& port) { return of(port, bus); }, bus.port);
}

namespace {

constexpr std::size_t kLeastFrame = 4;  // fewer characters can match by chance

// Spurious character of an RS-485 driver that changes its direction.
bool is_turnaround(std::uint8_t byte) { return byte == 0x00 || byte == 0xFF; }

bool has_fault(const std::vector<FrameField>& fields) {
  return std::ranges::any_of(fields, [](const FrameField& field) { return !field.fault.empty(); });
}

}  // namespace

RequestFinder::RequestFinder(const BusSpec& bus) {
  std::set<std::string> known;
  for (const DeviceSpec& device : bus.devices) {
    if (!known.insert(device.protocol).second) continue;
    if (const auto declaration = device.declaration) {
      families_.push_back(
          {[declaration](ByteView bytes) {
             return declared::seen_request(*declaration.value, bytes);
           },
           [declaration](ByteView bytes) { return declared::explain(*declaration.value, bytes); }});
    } else if (const ProtocolEntry* entry = find_protocol(device.protocol)) {
      if (entry->seen_request) families_.push_back({entry->seen_request, entry->explain});
    }
  }
}

RequestFinder::Found RequestFinder::find(ByteView bytes) const {
  Found doubtful;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const Family& family : families_) {
      const SeenRequest seen = family.seen(bytes.subspan(at));
      if (seen && seen.certain) return {at, seen.size, true};
      if (seen && doubtful.size == 0) doubtful = {at, seen.size, false};
    }
  }
  return doubtful;
}

bool RequestFinder::is_frame(ByteView bytes) const {
  while (!bytes.empty() && is_turnaround(bytes.front()) && bytes.size() > kLeastFrame) {
    if (std::ranges::any_of(
            families_, [&](const Family& family) { return !has_fault(family.explain(bytes)); }))
      return true;
    bytes = bytes.subspan(1);
  }
  return bytes.size() >= kLeastFrame && std::ranges::any_of(families_, [&](const Family& family) {
           return !has_fault(family.explain(bytes));
         });
}

}  // namespace fieldcast
