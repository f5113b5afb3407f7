#include "core/bus/wire/request_finder.hpp"

#include <algorithm>
#include <set>

namespace fieldcast {
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
