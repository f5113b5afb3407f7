// Interface for commands of users; implemented by CommandController. All calls are on the io
// thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "tools/station/http/http_message.hpp"
#include "tools/station/live/client_message.hpp"

namespace fieldcast::web {

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
};

[[nodiscard]] StationCommand write_command(const ChannelPath& path, Value value, bool verify);
[[nodiscard]] StationCommand acquire_command(const ChannelPath& path);

}  // namespace fieldcast::web
