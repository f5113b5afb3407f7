#include "tools/station/live/pending_commands.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast::web {

std::optional<Refusal> PendingCommands::why_not(const std::string& user) const {
  const auto mine = of_user_.find(user);
  if (under_way_.size() >= kMaxUnderWay || (mine != of_user_.end() && mine->second >= kMaxOfUser))
    return Refusal{"too many commands are pending", "try again when they have ended"};
  return std::nullopt;
}

void PendingCommands::add(Asked asked, Done done, Instant deadline) {
  ++of_user_[asked.caller.user];
  const std::uint64_t id = asked.request_id;
  under_way_.emplace(id, Waiting{std::move(asked), std::move(done), deadline});
}

void PendingCommands::on_sent(std::uint64_t request_id, Instant deadline) {
  const auto found = under_way_.find(request_id);
  if (found == under_way_.end()) return;  // the result arrived first
  found->second.sent = true;
  found->second.deadline = deadline;
}

std::optional<PendingCommands::Ended> PendingCommands::end(std::uint64_t request_id,
                                                           CommandOutcome outcome) {
  auto node = under_way_.extract(request_id);
  if (node.empty()) return std::nullopt;
  Waiting& waiting = node.mapped();
  const auto mine = of_user_.find(waiting.asked.caller.user);
  if (--mine->second == 0) of_user_.erase(mine);
  outcome.request_id = request_id;
  outcome.user = waiting.asked.caller.user;
  outcome.target = waiting.asked.target;
  kept_.push_back(outcome);
  if (kept_.size() > kMaxKept) kept_.pop_front();
  return Ended{std::move(waiting.asked), std::move(outcome), std::move(waiting.done)};
}

std::optional<PendingCommands::Ended> PendingCommands::on_fault(std::uint64_t request_id,
                                                                StationFault fault) {
  return end(request_id, {.state = fault == StationFault::kNoResult ? "no-answer" : "not-sent",
                          .cause = "NONE",
                          .reason = std::string(to_text(fault))});
}

std::optional<PendingCommands::Ended> PendingCommands::on_result(const StationResult& result) {
  return end(result.request_id, {.state = std::string(to_text(result.state)),
                                 .cause = result.cause,
                                 .reason = result.reason,
                                 .values = result.values,
                                 .completed_at = result.completed_at});
}

std::optional<PendingCommands::Ended> PendingCommands::take_expired(Instant now) {
  const auto expired = std::find_if(under_way_.begin(), under_way_.end(), [now](const auto& entry) {
    return entry.second.deadline <= now;
  });
  if (expired == under_way_.end()) return std::nullopt;
  return on_fault(expired->first,
                  expired->second.sent ? StationFault::kNoResult : StationFault::kNoBridge);
}

std::optional<CommandOutcome> PendingCommands::find(std::string_view user,
                                                    std::uint64_t request_id) const {
  if (const auto found = under_way_.find(request_id); found != under_way_.end()) {
    const Asked& asked = found->second.asked;
    if (asked.caller.user != user) return std::nullopt;
    return CommandOutcome{.request_id = request_id,
                          .user = asked.caller.user,
                          .target = asked.target,
                          .state = "pending",
                          .cause = "NONE"};
  }
  const auto kept = std::find_if(kept_.rbegin(), kept_.rend(), [&](const CommandOutcome& outcome) {
    return outcome.request_id == request_id && outcome.user == user;
  });
  return kept == kept_.rend() ? std::nullopt : std::optional(*kept);
}

}  // namespace fieldcast::web
