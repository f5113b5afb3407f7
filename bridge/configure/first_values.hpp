// First values of a device that is not configured, as JSON. Pure.
#pragma once

#include <optional>
#include <string>

#include "core/base/json.hpp"
#include "core/base/time.hpp"
#include "core/bus/command/device_probe.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::configure {

[[nodiscard]] std::optional<DeviceSpec> find_device(const BridgeSpec& spec, const std::string& bus,
                                                    const std::string& device);

// Why the channel has no value; empty if it has one.
[[nodiscard]] std::string error_of(const DeviceSpec& spec, const ProbedChannel& channel);

// {"values": [{"channel", "value", "unit", "quality", "cause", "error", "at_ms", "took_ms"}],
// "left_out": number of channels that were not requested}. `value` is null if there is none.
[[nodiscard]] Json first_values_json(const DeviceSpec& spec, const ProbedDevice& probed,
                                     const UtcMapping& clock);

}  // namespace fieldcast::configure
