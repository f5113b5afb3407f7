#include "core/bus/wire/fence_times.hpp"

#include <algorithm>

#include "core/bus/wire/pending_responses.hpp"
#include "core/model/make_protocol.hpp"

namespace fieldcast {
namespace {

// Delay of the adapters of two bridges (latency timers of 16 ms), with a margin.
constexpr Duration kSlowestAdapters = std::chrono::milliseconds{35};

// Longest silence after a request. Without identity, the bus waits for late responses
// (LateResponseFilter).
Duration silence_behind(const DeviceSpec& device, const BusSpec& bus) {
  const auto protocol = make_protocol(device, line_of(bus.port));
  if (!protocol || device.channels.empty()) return {};
  const bool nameless = (*protocol)->traits().identity == ResponseIdentity::kNone;
  const auto size = (*protocol)->size(ReadRequest{{device.channels.front().range}});
  return device.timeout * (nameless ? PendingResponses::kLateFactor : 1) + bus.gap_allowance +
         device.pause + (size ? size->pauses : Duration{});
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

}  // namespace fieldcast
