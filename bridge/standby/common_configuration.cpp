#include "bridge/standby/common_configuration.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string_view>

namespace fieldcast {
namespace {

// FNV-1a of 64 bits over the texts with their terminating zeros.
class Sum {
 public:
  void add(std::string_view text) {
    for (const char c : text) add_byte(static_cast<unsigned char>(c));
    add_byte(0);
  }
  void add(std::int64_t number) { add(std::to_string(number)); }
  [[nodiscard]] std::string text() const { return fmt::format("{:016x}", sum_); }

 private:
  void add_byte(unsigned char byte) { sum_ = (sum_ ^ byte) * 1099511628211ULL; }
  std::uint64_t sum_ = 14695981039346656037ULL;
};

void add(Sum& sum, const ChannelSpec& channel) {
  const Encoding& encoding = channel.encoding;
  sum.add(channel.name);
  sum.add(channel.at);
  sum.add(static_cast<std::int64_t>(encoding.type));
  sum.add(encoding.string_bytes);
  sum.add(static_cast<std::int64_t>(encoding.word_order));
  sum.add(static_cast<std::int64_t>(encoding.byte_order));
  sum.add(encoding.bit ? *encoding.bit : -1);
  sum.add(fmt::format("{} {}", encoding.scale, encoding.offset));
  for (const std::uint64_t pattern : encoding.not_available)
    sum.add(static_cast<std::int64_t>(pattern));
  if (encoding.exponent_distance != 0)
    sum.add(fmt::format("exponent {}", encoding.exponent_distance));
  sum.add(channel.refresh.count());
  sum.add(static_cast<std::int64_t>(channel.mode));
  sum.add(static_cast<std::int64_t>(channel.access));
  sum.add(channel.on_interest ? 1 : 0);
}

}  // namespace

std::string common_configuration(const BridgeSpec& spec) {
  Sum sum;
  for (const BusSpec& bus : spec.buses) {
    sum.add(bus.name);
    for (const DeviceSpec& device : bus.devices) {
      sum.add(device.name);
      sum.add(device.protocol);
      sum.add(device.link.address);
      for (const auto& [option, value] : device.link.options) sum.add(option + "=" + value);
      for (const ChannelSpec& channel : device.channels) add(sum, channel);
    }
  }
  return sum.text();
}

}  // namespace fieldcast
