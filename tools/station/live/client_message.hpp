// Parses the JSON messages of a client of /live. Pure; the text is untrusted.
//
//     {"subscribe": PATTERN, "refresh_ms": 500}    {"unsubscribe": PATTERN}
//     {"write": {"channel": PATH, "value": 21.5, "verify": true}, "id": 7}
//     {"acquire": {"channel": PATH}, "id": 8}      {"ping": 9}
//
// The response repeats the client's id; the id is optional.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <variant>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "bridge/http/http_message.hpp"
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
// Of commands for a bus of a site that is read from the stream, without `stream.commands`.
[[nodiscard]] Refusal refusal_of_stream(std::string_view bus);
// Of what the stream never carries.
[[nodiscard]] Refusal refusal_of_device_action(std::string_view bus);
struct MessageFault {
  std::optional<std::uint64_t> id;
  Refusal refusal;
};

inline constexpr std::size_t kMaxMessage = 4096;  // bytes
inline constexpr std::size_t kMaxDepth = 4;       // nested brackets
inline constexpr Duration kShortestRefresh = std::chrono::milliseconds{50};
inline constexpr Duration kLongestRefresh = std::chrono::hours{1};

using ParsedMessage = tl::expected<ClientMessage, MessageFault>;
[[nodiscard]] ParsedMessage parse_client_message(std::string_view text);

// Converts to the channel's type. A string may contain a number, for integers beyond 2^53. The
// bridge checks the limits.
[[nodiscard]] tl::expected<Value, Refusal> value_for(std::string_view channel_type, Value value);

struct CommandOutcome {
  std::uint64_t request_id = 0;
  std::string user;
  std::string target;  // "bus/device/channel"
  // "done", "verified", "rejected", "failed", "expired"; "not-sent": no bridge accepted it;
  // "no-answer": its result did not arrive.
  std::string state;
  std::string cause;  // "NONE", "READ_ONLY", ...
  std::string reason;
  std::vector<Value> values;  // acquired or read back
  UtcTime completed_at;
};
// {"request_id", "target", "state", "cause", "reason", "value", "completed_ms"}, and "values" if
// there are several. "value" is null if there is none.
[[nodiscard]] std::string outcome_json(const CommandOutcome& outcome);

// Interface for commands of users; implemented by CommandController. All calls are on the io
// thread.
class CommandSink {
 public:
  using Done = std::function<void(const CommandOutcome&)>;
  using Submitted = tl::expected<std::uint64_t, Refusal>;

  virtual ~CommandSink() = default;
  // Returns the request_id; `done` is called once, later. If `done` is null, every /live client of
  // the user receives the outcome. Sets requester and request_id. REQUIRES: the role allows it.
  [[nodiscard]] virtual Submitted submit(const Caller& caller, StationCommand command,
                                         Done done) = 0;
  // Also sets the person of the action.
  [[nodiscard]] virtual Submitted submit(const Caller& caller, AlarmAction action, Done done) = 0;
  // "pending" while it has no outcome; empty if unknown or dropped.
  [[nodiscard]] virtual std::optional<CommandOutcome> find(std::string_view user,
                                                           std::uint64_t request_id) const = 0;
  // Whether commands can be sent to sites that are read from the stream.
  [[nodiscard]] virtual bool reaches_stream() const { return false; }
};

[[nodiscard]] StationCommand write_command(const ChannelPath& path, Value value, bool verify);
[[nodiscard]] StationCommand acquire_command(const ChannelPath& path);

}  // namespace fieldcast::web
