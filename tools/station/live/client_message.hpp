// What a client of /live may say, from its JSON text. Pure; nothing in a text is trusted.
//
//     {"subscribe": PATTERN, "refresh_ms": 500}    {"unsubscribe": PATTERN}
//     {"write": {"channel": PATH, "value": 21.5, "verify": true}, "id": 7}
//     {"acquire": {"channel": PATH}, "id": 8}      {"ping": 9}
//
// The id is the client's own number for the answer; it may be left out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <variant>

#include "core/base/time.hpp"
#include "core/base/value.hpp"
#include "core/model/channel_path.hpp"
#include "core/model/pattern.hpp"

namespace fieldcast::web {

struct Subscribe {
  Pattern pattern;
  std::optional<Duration> refresh;  // the client wishes these channels read so often
};
struct Unsubscribe {
  Pattern pattern;
};
struct WriteChannel {
  ChannelPath path;
  Value value;  // as the JSON says: its type is not the channel's yet
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

// One line for people about what is wrong, and one about what to do.
struct Refusal {
  std::string error, hint;
};
struct MessageFault {
  std::optional<std::uint64_t> id;
  Refusal refusal;
};

inline constexpr std::size_t kMaxMessage = 4096;  // bytes
inline constexpr std::size_t kMaxDepth = 4;       // of brackets within brackets
// An interest names one device at most, and no refresh outside these.
inline constexpr Duration kShortestRefresh = std::chrono::milliseconds{50};
inline constexpr Duration kLongestRefresh = std::chrono::hours{1};

using ParsedMessage = tl::expected<ClientMessage, MessageFault>;
[[nodiscard]] ParsedMessage parse_client_message(std::string_view text);

// The value as the channel's type wants it: a text is taken for a number where the channel has one,
// so that integers beyond 2^53 can be written. Whether it fits the channel, the bridge says.
[[nodiscard]] tl::expected<Value, Refusal> value_for(std::string_view channel_type, Value value);

}  // namespace fieldcast::web
