#include "core/model/bus_spec.hpp"

#include "core/protocol/families/registry.hpp"

namespace fieldcast {

tl::expected<std::unique_ptr<Protocol>, OptionFault> make_protocol(const DeviceSpec& device,
                                                                   const LineFormat& line) {
  DeviceLink link = device.link;
  link.line = line;
  if (device.declaration) return declared::make(device.declaration.value, link);
  if (const ProtocolEntry* entry = find_protocol(device.protocol)) return entry->make(link);
  return tl::unexpected(OptionFault{{}, "protocol '" + device.protocol + "' is unknown", {}});
}

}  // namespace fieldcast
