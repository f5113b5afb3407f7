/// @file
/// Values, samples and the catalogue, as a station receives them. Plain values; any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace fieldcast::api {
inline namespace v1 {

/// Grows when a program must be compiled again for a new version of the library.
inline constexpr int kAbiVersion = 1;

using Duration = std::chrono::nanoseconds;
/// UTC. The epoch (1970-01-01) means "no time is known".
using Time = std::chrono::sys_time<std::chrono::nanoseconds>;

using Value = std::variant<bool, std::int64_t, std::uint64_t, double, std::string>;
/// "true", "-3", "2.5", or the string itself. A double keeps all its digits.
[[nodiscard]] std::string to_text(const Value& value);
/// Empty for a bool or a string.
[[nodiscard]] std::optional<double> as_number(const Value& value);

/// How far a sample may be trusted; docs/qualities.md explains each.
enum class Quality : std::uint8_t {
  kGood,
  kUncertain,         ///< older than its refresh promises
  kBadNoResponse,     ///< the device does not respond, or its port is closed
  kBadFrame,          ///< responses arrive damaged
  kBadDeviceError,    ///< the device refused; Sample::device_code holds its code
  kBadRange,          ///< the raw value has no meaning in the type of the channel
  kBadConfiguration,  ///< the channel cannot work as configured
  kNotYetRead,
};
[[nodiscard]] std::string_view to_text(Quality quality);  ///< "GOOD", "BAD_NO_ANSWER", ...

/// The name of a channel. With several domains the name of the domain comes before the bus:
/// "north:line-7".
struct Path {
  std::string bus, device, channel;
  [[nodiscard]] std::string text() const { return bus + '/' + device + '/' + channel; }
  friend auto operator<=>(const Path&, const Path&) = default;
};

struct Sample {
  Path path;
  Value value;  ///< the last good value while the quality is bad
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  Time acquired_at;            ///< arrival of the last byte of the response, by the bridge's clock
  std::uint64_t sequence = 0;  ///< grows by one with each sample of the channel
};
/// Time since the bridge acquired the value, by this machine's clock. Both clocks must agree.
[[nodiscard]] Duration age(const Sample& sample);

enum class Access : std::uint8_t { kReadOnly, kReadWrite, kWriteOnly };

/// An entry of the catalogue: a channel that a bridge serves.
struct Channel {
  Path path;
  std::string bridge;
  std::string type;  ///< "float32", "string(16)"
  std::string unit, address, description;
  Access access = Access::kReadOnly;
  Duration refresh{};  ///< 0: the channel is read on request only
  std::optional<double> low_low, low, high, high_high;
  std::optional<double> write_min, write_max;
};

}  // namespace v1
}  // namespace fieldcast::api
