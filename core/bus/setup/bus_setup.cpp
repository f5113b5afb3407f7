#include "core/bus/setup/bus_setup.hpp"

#include <algorithm>
#include <cassert>

#include "core/model/bus_spec.hpp"
#include "core/protocol/families/registry.hpp"
#include "core/schedule/bus_schedule.hpp"

namespace fieldcast {

BusSetup::BusSetup(const BusSpec& spec)
    : spec_(spec),
      line_(line_of(spec_.port)),
      silence_(silence_for(spec_)),
      timeless_(plain_tcp() && only_network_protocols(spec_)) {
  if (spec_.in_flight > 1) framer_ = find_protocol(spec_.devices.front().protocol)->first_frame;
  for (const DeviceSpec& device : spec_.devices) {
    auto protocol = make_protocol(device, line_);
    assert(protocol && "the loader checks protocols, addresses and options");
    names_.emplace(device.name, static_cast<DeviceIndex>(protocols_.size()));
    protocols_.push_back(std::move(*protocol));
  }
  ad_hoc_.resize(kMostAdHoc);
  protocols_.resize(slots());
}

bool same_address(const DeviceSpec& a, const DeviceSpec& b) {
  return a.protocol == b.protocol && a.link.address == b.link.address &&
         a.link.long_address == b.link.long_address;
}

std::optional<DeviceIndex> BusSetup::find_ad_hoc(const DeviceSpec& device) const {
  for (auto index = static_cast<DeviceIndex>(devices()); index < slots(); ++index) {
    if (protocols_[index] && this->device(index) == device) return index;
  }
  return std::nullopt;
}

std::optional<std::string> BusSetup::why_not_ad_hoc(const DeviceSpec& device) const {
  bool is_spoken = false;
  for (DeviceIndex index = 0; index < devices(); ++index) {
    const DeviceSpec& configured = spec_.devices[index];
    if (same_address(configured, device))
      return "its address is that of the device '" + configured.name + "' of this bus";
    const ProtocolEntry* const entry = find_protocol(configured.protocol);
    if ((entry != nullptr && entry->one_device) ||
        protocol(index).traits().identity == ResponseIdentity::kNone)
      return "the protocol " + configured.protocol + " allows only one device on its bus";
    is_spoken = is_spoken || (configured.protocol == device.protocol &&
                              configured.declaration == device.declaration);
  }
  if (!is_spoken) return "no device of this bus has the protocol " + device.protocol;
  return std::nullopt;
}

bool BusSetup::set_ad_hoc(DeviceIndex index, const DeviceSpec& device) {
  DeviceSpec& former = ad_hoc_[index - devices()];
  const bool is_same = protocols_[index] && same_address(former, device) &&
                       former.link == device.link && former.declaration == device.declaration;
  if (!is_same) {  // exchanges of pending responses refer to the protocol
    auto protocol = make_protocol(device, line_);
    if (!protocol) return false;
    protocols_[index] = std::move(*protocol);
  }
  former = device;
  return true;
}

bool BusSetup::plain_tcp() const {
  const auto* tcp = std::get_if<TcpPortSpec>(&spec_.port);
  return tcp != nullptr && !tcp->line;
}

std::optional<DeviceIndex> BusSetup::find(std::string_view name) const {
  const auto found = names_.find(name);
  if (found == names_.end()) return std::nullopt;
  return found->second;
}

bool only_network_protocols(const BusSpec& bus) {
  return std::ranges::all_of(bus.devices, [](const DeviceSpec& device) {
    const ProtocolEntry* entry = find_protocol(device.protocol);
    return entry != nullptr && entry->network_only;
  });
}

Duration BusSetup::wire_time(DeviceIndex device, const Request& request) const {
  const auto size = protocol(device).size(request);
  return size ? size->wire_time(line_) : Duration{};
}

Duration BusSetup::response_wire_time(DeviceIndex device, const Request& request) const {
  const auto size = protocol(device).size(request);
  return size ? size->response_wire_time(line_) : Duration{};
}

bool BusSetup::response_differs(DeviceIndex device, const Request& request) const {
  if (!protocol(device).traits().echo_is_ambiguous) return true;
  const auto exchange = protocol(device).begin(request, {});
  Bytes sent, out;
  (void)exchange->start(sent);
  return exchange->on_bytes(sent, out).kind != Step::Kind::kDone;
}

std::string BusSetup::text(DeviceIndex device, const Range& range) const {
  std::string text = std::string(area(device, range.area).name) + ':' + std::to_string(range.first);
  if (range.count > 1) text += ".." + std::to_string(range.end() - 1);
  return text;
}

AreaIndex area_of(const Request& request) {
  if (const auto* read = std::get_if<ReadRequest>(&request)) return read->ranges.front().area;
  if (const auto* write = std::get_if<WriteRequest>(&request)) return write->range.area;
  return std::get<WriteReadRequest>(request).read.area;
}

}  // namespace fieldcast
