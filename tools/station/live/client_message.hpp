// Parses the JSON messages of a client of /live. Pure; the text is untrusted.
//
//     {"subscribe": PATTERN, "refresh_ms": 500}    {"unsubscribe": PATTERN}
//     {"write": {"channel": PATH, "value": 21.5, "verify": true}, "id": 7}
//     {"acquire": {"channel": PATH}, "id": 8}      {"ping": 9}
//
// The response repeats the client's id; the id is optional.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <variant>

#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::web {

struct Subscribe {
  Pattern pattern;
  std::optional<Duration> refresh;  // requested refresh of the channels
};
struct Unsubscribe {
  Pattern pattern;
};
struct WriteChannel {
  ChannelPath path;
  Value value;  // JSON type; not converted to the channel's type yet
  bool verify = false;
};
struct AcquireChannel {
  ChannelPath path;
};
struct Ping {};

struct ClientMessage {
  std::optional<std::uint64_t> id;
  std::variant<Subscribe, Unsubscribe, WriteChannel, AcquireChannel, Ping> what;
};

// Human-readable: one line with the fault and one with the fix.
struct Refusal {
  std::string error, hint;
};
struct MessageFault {
  std::optional<std::uint64_t> id;
  Refusal refusal;
};

inline constexpr std::size_t kMaxMessage = 4096;  // bytes
inline constexpr std::size_t kMaxDepth = 4;       // nested brackets
// Limits of refresh_ms.
inline constexpr Duration kShortestRefresh = std::chrono::milliseconds{50};
inline constexpr Duration kLongestRefresh = std::chrono::hours{1};

using ParsedMessage = tl::expected<ClientMessage, MessageFault>;
[[nodiscard]] ParsedMessage parse_client_message(std::string_view text);

// Converts to the channel's type. A string may contain a number, for integers beyond 2^53. The
// bridge checks the limits.
[[nodiscard]] tl::expected<Value, Refusal> value_for(std::string_view channel_type, Value value);

}  // namespace fieldcast::web
