#include "bridge/command/command_router.hpp"

#include "core/model/command.hpp"

namespace fieldcast {
void CommandRouter::add(const std::string& bus, std::shared_ptr<BusRunner> runner) {
  const std::lock_guard lock(mutex_);
  runners_[bus] = std::move(runner);
}

void CommandRouter::remove(const std::string& bus) {
  const std::lock_guard lock(mutex_);
  runners_.erase(bus);
}

bool CommandRouter::completed_elsewhere(const std::string& requester, std::uint64_t request_id,
                                        Instant now) {
  const std::lock_guard lock(mutex_);
  const bool is_new = ledger_.enter(requester, request_id);
  if (is_new) elsewhere_.note({requester, request_id}, now);
  return is_new;
}

bool CommandRouter::was_completed_elsewhere(const Command& command, Instant now) {
  const std::lock_guard lock(mutex_);
  return elsewhere_.lately({command.requester, command.request_id}, now);
}

std::optional<CommandResult> CommandRouter::deduplicate(const Command& command, Instant now,
                                                        std::string late) {
  const std::lock_guard lock(mutex_);
  if (!ledger_.enter(command.requester, command.request_id))
    return rejection(command, Cause::kDuplicate, "this requester used this request_id before", now);
  if (late.empty()) return std::nullopt;
  return refusal(command, CommandState::kExpired, Cause::kExpired, std::move(late), now, now);
}

std::optional<CommandResult> CommandRouter::route(const std::string& bus, const Command& command,
                                                  Identity identity, Instant received) {
  const auto refused = [&](Cause cause, std::string reason) {
    return rejection(command, cause, std::move(reason), received);
  };
  switch (identity) {
    case Identity::kNew: break;
    case Identity::kKnown:
      return refused(Cause::kDuplicate,
                     "this requester used this request_id before this bridge began; whether that "
                     "command was done is not known any more");
    case Identity::kNotKept:
      return refused(Cause::kOffline, "the store is away, which keeps commands from running twice");
    case Identity::kNotNoted:
      return refused(Cause::kOffline,
                     "the other bridges of the standby group did not note it in time, or one of "
                     "them has begun it: commands do not run twice");
  }
  // Posted under the lock: after remove() has returned, the runner gets no more commands.
  const std::lock_guard lock(mutex_);
  const auto found = runners_.find(bus);
  if (found == runners_.end())
    return refused(Cause::kShutdown, "the bridge stops or restarts this bus");
  if (!found->second->post(command))
    return refused(Cause::kQueueFull, "too many commands wait for this bus");
  return std::nullopt;
}

}  // namespace fieldcast
