#include "tests/campaign/day_faults.hpp"

namespace fieldcast::test {
namespace {

using namespace std::chrono_literals;

// Returns true for Modbus. Its CRC detects frames that a collision with a second master garbles; an
// 8-bit sum, as of modbus-ascii, misses one in 256 of them.
bool has_crc(const std::string& protocol) { return protocol.starts_with("modbus-"); }

double one_of(std::mt19937_64& random, std::initializer_list<double> values) {
  return values.begin()[random() % values.size()];
}

sim::DeviceFaults device_faults(std::mt19937_64& random, Duration length, bool tcp) {
  constexpr Duration kLate[] = {80ms, 150ms, 205ms, 250ms, 320ms, 450ms, 560ms};
  sim::DeviceFaults faults;
  faults.queues = true;
  faults.delay.base = std::chrono::milliseconds{1 + random() % 20};
  faults.delay.spread = std::chrono::milliseconds{random() % 10};
  if (random() % 4 == 0) return faults;  // a healthy device
  faults.loss = one_of(random, {0, 0.001, 0.01, 0.05});
  faults.late_probability = one_of(random, {0, 0.001, 0.01, 0.05});
  faults.late = kLate[random() % std::size(kLate)];
  faults.doubled = one_of(random, {0, 0.001, 0.02});
  // On a TCP stream, half a response occurs only when the connection ends.
  if (!tcp) faults.truncate = one_of(random, {0, 0.001, 0.02});
  for (Duration from{};;) {
    from += std::chrono::seconds{600 + random() % 14'400};
    const Duration to = from + std::chrono::seconds{1 + random() % 300};
    if (to > length - kCalm) return faults;
    faults.silence.push_back({from, to});
    from = to;
  }
}

}  // namespace

sim::BusFaults bus_faults(const StormKind& kind, const BusSpec& spec, std::mt19937_64& random,
                          Duration length) {
  sim::BusFaults faults;
  // s7-freeport has no checksum, so noise would give wrong values; TCP removes noise.
  const bool tcp = std::holds_alternative<TcpPortSpec>(spec.port);
  if (kind.protocol != "s7-freeport" && !tcp) faults.noise = one_of(random, {0, 1e-7, 1e-6});
  if (has_crc(kind.protocol) && kind.protocol != "modbus-ascii")
    faults.foreign = one_of(random, {0, 0, 0.002});
  for (const DeviceSpec& device : spec.devices)
    faults.devices[device.name] = device_faults(random, length, tcp);
  return faults;
}

BusSpec variant_of(const BusSpec& whole, std::mt19937_64& random) {
  BusSpec spec = whole;
  const auto base = std::chrono::seconds{5 + random() % 56};
  if (random() % 5 == 0) spec.planner = Planner::kDynamicBlocks;
  for (DeviceSpec& device : spec.devices) {
    while (device.channels.size() > 6)
      device.channels.own().erase(device.channels.begin() +
                                  static_cast<std::ptrdiff_t>(random() % device.channels.size()));
    for (std::size_t c = 0; c < device.channels.size(); ++c) {
      ChannelSpec& channel = device.channels[c];
      channel.refresh = base * static_cast<int>(1 + c % 3);
      if (c == 3 && channel.encoding.type != ValueType::kBool) channel.deadband = 0.5;
      if (channel.deadband) channel.heartbeat = 3 * channel.refresh;
      if (c == 4) channel.on_interest = true;
    }
  }
  return spec;
}

}  // namespace fieldcast::test
