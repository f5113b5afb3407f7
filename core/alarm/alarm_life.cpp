#include "core/alarm/alarm_life.hpp"

#include <algorithm>
#include <utility>

namespace fieldcast {
namespace {

using enum IsaState;
using enum IsaInput;

constexpr IsaTransition kTransitions[] = {
    {kNormal, kOccurs, kUnacknowledged, "alarm occurs"},
    {kUnacknowledged, kAcknowledge, kAcknowledged, "acknowledge"},
    {kUnacknowledged, kReturns, kReturned, "return to normal, unacknowledged"},
    {kAcknowledged, kReturns, kNormal, "return to normal"},
    {kReturned, kAcknowledge, kNormal, "acknowledge"},
    {kReturned, kOccurs, kUnacknowledged, "re-alarm"},

    {kNormal, kShelve, kShelved, "shelve"},
    {kUnacknowledged, kShelve, kShelved, "shelve"},
    {kAcknowledged, kShelve, kShelved, "shelve"},
    {kReturned, kShelve, kShelved, "shelve"},
    {kShelved, kUnshelveInAlarm, kUnacknowledged, "un-shelve, in alarm"},
    {kShelved, kUnshelveNormal, kNormal, "un-shelve, normal"},

    {kNormal, kRemoveFromService, kOutOfService, "remove from service"},
    {kUnacknowledged, kRemoveFromService, kOutOfService, "remove from service"},
    {kAcknowledged, kRemoveFromService, kOutOfService, "remove from service"},
    {kReturned, kRemoveFromService, kOutOfService, "remove from service"},
    {kShelved, kRemoveFromService, kOutOfService, "remove from service"},
    {kOutOfService, kReturnToServiceInAlarm, kUnacknowledged, "return to service, in alarm"},
    {kOutOfService, kReturnToServiceNormal, kNormal, "return to service, normal"},
    // The standard's diagram has no such transition: an alarm is inactive for one reason only.
    {kOutOfService, kReturnToServiceShelved, kShelved, "return to service, still shelved"},
};

AlarmStage stage_of(IsaState state, bool active) {
  switch (state) {
    case kNormal: return AlarmStage::kClear;
    case kUnacknowledged: return AlarmStage::kUnacknowledged;
    case kAcknowledged: return AlarmStage::kAcknowledged;
    case kReturned: return AlarmStage::kReturned;
    case kShelved:
    case kOutOfService: break;
  }
  return active ? AlarmStage::kUnacknowledged : AlarmStage::kClear;
}

IsaState state_of(const AlarmStatus& kept) {
  if (kept.suppressed.is_set()) return kOutOfService;
  if (kept.shelved.is_set()) return kShelved;
  switch (kept.stage) {
    case AlarmStage::kClear: return kNormal;
    case AlarmStage::kUnacknowledged: return kUnacknowledged;
    case AlarmStage::kAcknowledged: return kAcknowledged;
    case AlarmStage::kReturned: return kReturned;
  }
  return kNormal;
}

}  // namespace

std::span<const IsaTransition> isa_transitions() { return kTransitions; }

std::optional<IsaState> next_state(IsaState from, IsaInput input) {
  const auto* const row =
      std::find_if(std::begin(kTransitions), std::end(kTransitions),
                   [&](const auto& each) { return each.from == from && each.input == input; });
  return row == std::end(kTransitions) ? std::nullopt : std::optional(row->to);
}

bool AlarmLife::take(IsaInput input) {
  const auto next = next_state(state_, input);
  if (next) state_ = *next;
  status_.stage = stage_of(state_, status_.active);
  return next.has_value();
}

void AlarmLife::raise(double value, UtcTime since, UtcTime now) {
  if (status_.active) return;
  status_.active = true;
  status_.value = value;
  status_.raised_at = since;
  status_.cleared_at = {};
  status_.acknowledged = {};
  raised_.push_back(now);
  if (raised_.size() > kMaxCounted) raised_.pop_front();
  (void)count(now);
  take(kOccurs);
}

void AlarmLife::clear(double value, UtcTime since) {
  if (!status_.active) return;
  status_.active = false;
  status_.value = value;
  status_.cleared_at = since;
  take(kReturns);
}

AlarmOutcome AlarmLife::acknowledge(AlarmNote note, UtcTime raised_at) {
  const auto refused = [](std::string reason) {
    return tl::unexpected(AlarmRefusal{Cause::kWrongState, std::move(reason)});
  };
  if (state_ == kOutOfService) return refused("its device is in maintenance");
  if (state_ == kShelved) return refused("the alarm is shelved");
  if (raised_at.nanoseconds != 0 && raised_at != status_.raised_at)
    return refused("the alarm was raised again since then");
  if (!take(kAcknowledge)) {
    return refused(state_ == kAcknowledged
                       ? "it is acknowledged already, by " + status_.acknowledged.by
                       : "the alarm is clear: there is nothing to acknowledge");
  }
  status_.acknowledged = std::move(note);
  return {};
}

void AlarmLife::shelve(AlarmPause pause) {
  status_.shelved = std::move(pause);
  take(kShelve);
}

AlarmOutcome AlarmLife::unshelve() {
  if (!status_.shelved.is_set())
    return tl::unexpected(AlarmRefusal{Cause::kWrongState, "the alarm is not shelved"});
  status_.shelved = {};
  take(status_.active ? kUnshelveInAlarm : kUnshelveNormal);
  return {};
}

void AlarmLife::suppress(AlarmPause pause) {
  status_.suppressed = std::move(pause);
  take(kRemoveFromService);
}

void AlarmLife::end_suppression() {
  status_.suppressed = {};
  if (status_.shelved.is_set()) {
    take(kReturnToServiceShelved);
  } else {
    take(status_.active ? kReturnToServiceInAlarm : kReturnToServiceNormal);
  }
}

bool AlarmLife::count(UtcTime now) {
  const std::int64_t oldest = now.nanoseconds - kChatterWindow.count();
  while (!raised_.empty() && raised_.front().nanoseconds <= oldest) raised_.pop_front();
  const bool chattering =
      status_.chattering ? raised_.size() > kChatterUntil : raised_.size() >= kChatterFrom;
  const auto occurrences = static_cast<std::uint32_t>(raised_.size());
  const bool changed = chattering != status_.chattering || occurrences != status_.occurrences;
  status_.chattering = chattering;
  status_.occurrences = occurrences;
  return changed;
}

void AlarmLife::restore(const AlarmStatus& kept, std::span<const UtcTime> occurrences,
                        UtcTime now) {
  const AlarmPriority priority = status_.priority;
  status_ = kept;
  status_.priority = priority;
  status_.chattering = false;
  state_ = state_of(kept);
  status_.stage = stage_of(state_, status_.active);
  const std::size_t beyond =
      occurrences.size() > kMaxCounted ? occurrences.size() - kMaxCounted : 0;
  raised_.assign(occurrences.begin() + static_cast<std::ptrdiff_t>(beyond), occurrences.end());
  (void)count(now);
}

}  // namespace fieldcast
