// A configured channel, with every default filled in. A plain value; the loader makes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "core/codec/value_codec.hpp"
#include "core/model/calculation.hpp"
#include "core/model/channel_kind.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

struct ChannelSpec {
  std::string name;
  std::string at;             // as written: "holding:100"; if calculated: "= " and the expression
  std::string exponent_from;  // as written, the item of the decimal exponent; empty: none
  Range range;                // as understood, with the item of the exponent
  Encoding encoding;
  Duration refresh = std::chrono::seconds{1};
  Mode mode = Mode::kScheduled;
  Access access = Access::kReadOnly;
  bool on_interest = false;  // `acquire: on-interest`
  bool unsolicited = false;  // the device sends it by itself; never requested
  int priority = 0;          // higher values are stretched later under overload; -100..100
  double elasticity = 1;     // its share of a stretch within its priority; 0.1..10
  std::string unit;          // "°C", up to 32 bytes
  std::optional<std::uint8_t> digits;  // decimals of a shown value, 0..kMostDigits
  std::string description;             // up to 256 bytes
  std::optional<double> deadband;      // smaller changes are not published
  std::optional<Duration> heartbeat;   // with a deadband: the longest gap; default: the refresh
  Limits limits;
  std::optional<double> write_min, write_max;
  Duration write_interval{};  // rate limit of commands; 0 for none
  // Of a calculated channel: it has no address, and its refresh is that of its slowest input.
  SharedCalculation calculation;
  friend bool operator==(const ChannelSpec&, const ChannelSpec&) = default;
};
inline constexpr int kMostDigits = 9;

// Decimals with which programs show the values of a channel.
struct ShownDigits {
  std::uint8_t digits = 0;
  bool configured = false;  // false: from the resolution of the channel
  friend bool operator==(const ShownDigits&, const ShownDigits&) = default;
};
// Without the key `digits`: those of the scale and the offset of an integer, or of a number as
// text. Empty if the resolution is unknown (floats, values with an exponent) or needs more than
// kMostDigits.
[[nodiscard]] std::optional<ShownDigits> shown_digits(const ChannelSpec& channel);

[[nodiscard]] bool read_by_itself(const ChannelSpec& channel);

// Whether a request can read it: it is neither calculated, nor write-only, nor unsolicited.
[[nodiscard]] bool is_requestable(const ChannelSpec& channel);

// The refresh, or the heartbeat with a deadband; empty for channels only read on request.
[[nodiscard]] std::optional<Duration> promised_gap(const ChannelSpec& channel);

}  // namespace fieldcast
