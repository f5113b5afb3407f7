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

void CommandRouter::keep_identities(Keep keep, Refused refused) {
  const std::lock_guard lock(mutex_);
  keep_ = std::move(keep);
  refused_ = std::move(refused);
}

bool CommandRouter::answered_elsewhere(const std::string& requester, std::uint64_t request_id,
                                       Instant now) {
  const std::lock_guard lock(mutex_);
  const bool is_new = ledger_.enter(requester, request_id);
  if (is_new) elsewhere_.note({requester, request_id}, now);
  return is_new;
}

bool CommandRouter::was_answered_elsewhere(const Command& command, Instant now) {
  const std::lock_guard lock(mutex_);
  return elsewhere_.lately({command.requester, command.request_id}, now);
}

std::optional<CommandResult> CommandRouter::take(const std::string& bus, Command command,
                                                 Instant now, std::string late) {
  Keep keep;
  {
    const std::lock_guard lock(mutex_);
    if (!ledger_.enter(command.requester, command.request_id)) {
      return rejection(command, Cause::kDuplicate, "this requester used this request_id before",
                       now);
    }
    if (!late.empty())
      return refusal(command, CommandState::kExpired, Cause::kExpired, std::move(late), now, now);
    // A read may run twice.
    if (!keep_ || command.operation != Operation::kWrite) return post(bus, std::move(command), now);
    keep = keep_;
  }
  // Outside the lock, because it may call back immediately.
  keep(bus, command.requester, command.request_id,
       [this, bus, command, now](Identity identity) { on_identity(bus, command, identity, now); });
  return std::nullopt;
}

std::optional<CommandResult> CommandRouter::post(const std::string& bus, Command command,
                                                 Instant now) {
  // Posted under the lock: after remove() has returned, the runner gets no more commands.
  const auto found = runners_.find(bus);
  if (found == runners_.end())
    return rejection(command, Cause::kShutdown, "the bridge is stopping this bus", now);
  CommandResult full =
      rejection(command, Cause::kQueueFull, "too many commands wait for this bus", now);
  if (!found->second->post(std::move(command))) return full;
  return std::nullopt;
}

void CommandRouter::on_identity(const std::string& bus, Command command, Identity identity,
                                Instant received) {
  std::optional<CommandResult> result;
  Refused refused;
  {
    const std::lock_guard lock(mutex_);
    refused = refused_;
    switch (identity) {
      case Identity::kNew: result = post(bus, std::move(command), received); break;
      case Identity::kKnown:
        result = rejection(command, Cause::kDuplicate,
                           "this requester used this request_id before this bridge began; whether "
                           "that command was done is not known any more",
                           received);
        break;
      case Identity::kNotKept:
        result = rejection(command, Cause::kOffline,
                           "the store is away, which keeps commands from running twice", received);
        break;
      case Identity::kNotNoted:
        result = rejection(command, Cause::kOffline,
                           "the other bridges of the standby group did not note it in time, or one "
                           "of them has begun it: commands do not run twice",
                           received);
        break;
    }
  }
  if (result && refused) refused(bus, *result);
}

}  // namespace fieldcast
