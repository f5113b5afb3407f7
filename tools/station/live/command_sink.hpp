// Where commands of people go, and what comes back. An interface: the real one is the command desk.
// All calls both ways on the io thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "tools/station/live/client_message.hpp"
#include "tools/station/web/http_message.hpp"

namespace fieldcast::web {

// What became of a command.
struct CommandOutcome {
  std::uint64_t request_id = 0;
  std::string user;
  std::string target;  // "bus/device/channel"
  // Of a result: "done", "verified", "rejected", "failed", "expired". "not-sent": no bridge has
  // taken it. "no-answer": it was sent, and nobody knows what became of it.
  std::string state;
  std::string cause;  // "NONE", "READ_ONLY", ...
  std::string reason;
  std::vector<Value> values;  // acquired or read back
  UtcTime completed_at;
};
// {"request_id", "target", "state", "cause", "reason", "value", "completed_ms"}, and "values" where
// there are several. The value is null where there is none.
[[nodiscard]] std::string outcome_json(const CommandOutcome& outcome);

class CommandSink {
 public:
  using Done = std::function<void(const CommandOutcome&)>;
  using Submitted = tl::expected<std::uint64_t, Refusal>;

  virtual ~CommandSink() = default;
  // The request_id: `done` is called once, later. With a null one the outcome is told to every
  // client of /live of this user. Requester and request_id are filled in. The caller has been
  // found to have the role for it.
  [[nodiscard]] virtual Submitted submit(const Caller& caller, StationCommand command,
                                         Done done) = 0;
  // The person of the action is filled in, too.
  [[nodiscard]] virtual Submitted submit(const Caller& caller, AlarmAction action, Done done) = 0;
  // Of a command or an action of this user: the outcome, with the state "pending" while it is under
  // way. Nothing: unknown, or too long ago.
  [[nodiscard]] virtual std::optional<CommandOutcome> find(std::string_view user,
                                                           std::uint64_t request_id) const = 0;
};

// The command that writes one value to a channel, or reads it now.
[[nodiscard]] StationCommand write_command(const ChannelPath& path, Value value, bool verify);
[[nodiscard]] StationCommand acquire_command(const ChannelPath& path);

}  // namespace fieldcast::web
