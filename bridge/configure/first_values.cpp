#include "bridge/configure/first_values.hpp"

#include <algorithm>

#include "core/base/message_text.hpp"

namespace fieldcast::configure {

std::string error_of(const DeviceSpec& spec, const ProbedChannel& channel) {
  if (channel.cause != Cause::kExpired) return printable(channel.reason);
  return "the reads of the plan left no free time of " + fieldcast::to_text(spec.timeout) +
         " (timeout) in time; give the device a shorter timeout, or read it later";
}

std::optional<DeviceSpec> find_device(const BridgeSpec& spec, const std::string& bus,
                                      const std::string& device) {
  const auto found = std::ranges::find(spec.buses, bus, &BusSpec::name);
  if (found == spec.buses.end()) return std::nullopt;
  const auto named = std::ranges::find(found->devices, device, &DeviceSpec::name);
  return named == found->devices.end() ? std::nullopt : std::optional(*named);
}

Json first_values_json(const DeviceSpec& spec, const ProbedDevice& probed,
                       const UtcMapping& clock) {
  Json values = Json::array();
  for (std::size_t i = 0; i < probed.channels.size(); ++i) {
    const ProbedChannel& channel = probed.channels[i];
    values.push_back({{"channel", channel.name},
                      {"value", channel.value ? Json(*channel.value) : Json(nullptr)},
                      {"unit", spec.channels[i].unit},
                      {"quality", fieldcast::to_text(quality_of(channel.cause))},
                      {"cause", channel.cause == Cause::kNone ? "" : to_name(channel.cause)},
                      {"error", error_of(spec, channel)},
                      {"at_ms", unix_ms(clock.to_utc(channel.at))},
                      {"took_ms", milliseconds(channel.took)}});
  }
  return {{"values", values}, {"left_out", spec.channels.size() - probed.channels.size()}};
}

}  // namespace fieldcast::configure
