// A part of the search of a running bus for devices: which addresses are probed, and what was
// found. Pure.
#pragma once

#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/base/json.hpp"
#include "core/bus/command/device_probe.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/scan_question.hpp"

namespace fieldcast::configure {

struct ScanPart {
  // At most DeviceProbe::kMostDevices, none of the bus. Channels: the questions, then the identity.
  std::vector<DeviceSpec> devices;
  std::size_t questions = 0;
  std::optional<IdentityQuestion> identity;  // of the protocol
  std::optional<std::uint16_t> next;         // first address of the next part; empty at the end
};
// `protocol`: of a device of the bus, whose options and timeout apply. Omits the addresses of the
// bus's devices. Fails with the reason if the bus or the addresses do not allow a search.
[[nodiscard]] tl::expected<ScanPart, std::string> scan_part(const BusSpec& bus,
                                                            const std::string& protocol,
                                                            unsigned first, unsigned last);

// {"found": [{"address", "protocol", "response", "responded", "took_ms", "identity"}], "next":
// address or null, "error": why the search cannot go on; empty if it can}. Found is what sent
// something; `identity` is empty if the device has none.
[[nodiscard]] Json scan_json(const ScanPart& part, const std::vector<ProbedDevice>& probed);

}  // namespace fieldcast::configure
