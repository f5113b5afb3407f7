#include "bridge/dds/receivers/sample_load.hpp"

#include <fmt/format.h>

namespace fieldcast {
namespace {

// Row of a block: number, kind, quality, value, sequence, and sometimes the time.
constexpr double kBytesOfSample = 30;
// Headers of RTPS, bus, lengths of columns, a heartbeat. A block on a network has some 35 rows.
constexpr double kBytesOfMessage = 200, kRowsOfMessage = 35;

}  // namespace

std::uint64_t sample_load(const BridgeSpec& spec) {
  double samples = 0;  // per second
  for (const BusSpec& bus : spec.buses) {
    for (const DeviceSpec& device : bus.devices) {
      for (const ChannelSpec& channel : device.channels) {
        if (const auto gap = promised_gap(channel))
          samples += 1 / std::chrono::duration<double>(*gap).count();
      }
    }
  }
  return static_cast<std::uint64_t>(samples * (kBytesOfSample + kBytesOfMessage / kRowsOfMessage));
}

std::optional<std::string> rate_remark(const BridgeSpec& spec) {
  const std::uint64_t load = sample_load(spec), rate = spec.dds.max_rate;
  if (rate == 0 || load <= rate) return std::nullopt;
  return fmt::format(
      "max-rate: {} kB/s, and the samples for one station are at least {} kB/s: values come late, "
      "and some never; a larger max-rate, or longer refreshes",
      rate / 1000, load / 1000);
}

}  // namespace fieldcast
