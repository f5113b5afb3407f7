#include "tools/station/notify/rule_engine.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/station/notify/message_id.hpp"

namespace fieldcast::web {
namespace {

using State = NotifyProgress::State;
using Return = NotifyProgress::Return;

bool is_pending(const AlarmStatus& status) {
  return status.stage == AlarmStage::kUnacknowledged || status.stage == AlarmStage::kReturned;
}

bool is_quiet(const AlarmStatus& status) {
  return status.shelved.is_set() || status.suppressed.is_set();
}

UtcTime plus(UtcTime at, Duration span) { return {saturated_sum(at.nanoseconds, span.count())}; }

Duration elapsed(UtcTime from, UtcTime to) {
  return Duration{saturated_difference(to.nanoseconds, from.nanoseconds)};
}

}  // namespace

std::string_view to_text(NotifyKind kind) {
  switch (kind) {
    case NotifyKind::kRaised: return "raised";
    case NotifyKind::kRepeated: return "repeated";
    case NotifyKind::kEscalated: return "escalated";
    case NotifyKind::kCleared: return "cleared";
    case NotifyKind::kDigest: break;
  }
  return "digest";
}

void RuleEngine::restore(const std::vector<NotifyProgress>& progress,
                         const std::vector<NotifyWindow>& windows) {
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    for (const NotifyProgress& each : progress)
      if (each.rule == rules_[i].name) progress_[{i, each.alarm}] = each;
    for (const NotifyWindow& each : windows)
      if (each.rule == rules_[i].name) windows_[{i, each.target}] = each;
  }
}

void RuleEngine::on_alarm(const AlarmKey& alarm, const AlarmStatus& status, UtcTime now) {
  if (!alarms_.contains(alarm) && alarms_.size() >= kMaxAlarms) return;
  const auto [place, fresh] = alarms_.try_emplace(alarm);
  Seen& seen = place->second;
  if (fresh) {
    for (std::size_t i = 0; i < rules_.size(); ++i) {
      const auto& patterns = rules_[i].patterns;
      if (std::any_of(patterns.begin(), patterns.end(), [&](const Pattern& pattern) {
            return pattern.matches(alarm.bus, alarm.device, alarm.channel);
          }))
        seen.rules.push_back(i);
    }
  }
  // A bridge that takes over may report an alarm that was active all the time as raised later, as
  // its first occurrence. Further occurrences show that it ended while nothing was received.
  const bool ended = status.occurrences > std::max(seen.status.occurrences, 1u);
  const bool continues = !fresh && seen.status.active && status.active && !ended;
  if (fresh || (status.raised_at != seen.status.raised_at && !continues)) seen.at = now;
  seen.status = status;
  for (const std::size_t rule : seen.rules) settle(rule, alarm, seen, continues);
  open_.insert(alarm);
}

void RuleEngine::settle(std::size_t rule, const AlarmKey& alarm, const Seen& seen, bool continues) {
  const auto found = progress_.find({rule, alarm});
  if (found == progress_.end()) return;
  NotifyProgress& progress = found->second;
  const NotifyProgress before = progress;
  const AlarmStatus& status = seen.status;
  if (is_pending(status)) {
    const UtcTime occurrence = status.raised_at.nanoseconds != 0 ? status.raised_at : seen.at;
    // The clock of the bridge may have been set back since an occurrence that is closed.
    const bool later = progress.state == State::kClosed ? occurrence != progress.occurrence
                                                        : occurrence > progress.occurrence;
    const bool told = progress.state != State::kOpen || progress.returned != Return::kNone;
    if (later && status.active && (told || !continues)) {
      progress = {.rule = progress.rule, .alarm = alarm, .occurrence = occurrence};
    } else if (progress.state == State::kAcknowledged && occurrence >= progress.occurrence) {
      progress.state = State::kOpen;  // unacknowledged again, for example after shelving
      progress.last_at = {};
    }
  } else if (status.stage == AlarmStage::kAcknowledged && progress.state == State::kOpen) {
    progress.state = State::kAcknowledged;
  }
  if (!status.active && progress.returned == Return::kNone) progress.returned = Return::kSeen;
  if (progress != before) changed_.insert(found->first);
}

RuleEngine::Due RuleEngine::due(UtcTime now, const LocalMinute& local) {
  end_windows(now);
  std::vector<bool> hours;
  for (const NotifyRule& rule : rules_) hours.push_back(in_hours(rule.hours, local));
  for (auto at = open_.begin(); at != open_.end();) {
    const Seen& seen = alarms_.at(*at);
    bool waits = false;
    for (const std::size_t rule : seen.rules) {
      if (seen.status.priority < rules_[rule].priority) continue;
      const Turn turn{rule, *at, seen, now, hours[rule] && !is_quiet(seen.status)};
      const auto known = progress_.find({rule, *at});
      const bool begun = known != progress_.end() && known->second.count > 0;
      waits |= begun ? proceed(turn, known->second) : begin(turn);
    }
    at = waits ? std::next(at) : open_.erase(at);
  }
  Due due;
  due.messages = std::exchange(messages_, {});
  for (const Key& key : std::exchange(changed_, {})) due.progress.push_back(progress_.at(key));
  for (const WindowKey& key : std::exchange(changed_windows_, {})) {
    const auto window = windows_.find(key);
    due.windows.push_back(window != windows_.end()
                              ? window->second
                              : NotifyWindow{rules_[key.first].name, key.second, {}});
  }
  return due;
}

bool RuleEngine::begin(const Turn& turn) {
  const AlarmStatus& status = turn.seen.status;
  const NotifyRule& rule = rules_[turn.rule];
  if (!is_pending(status)) return false;
  const UtcTime occurrence = status.raised_at.nanoseconds != 0 ? status.raised_at : turn.seen.at;
  // The clock of the bridge may be ahead.
  const UtcTime since = std::min(occurrence, turn.seen.at);
  if (!status.active &&
      (elapsed(since, status.cleared_at) < rule.delay || elapsed(since, turn.now) > kOldest))
    return false;
  if (!turn.may_send || turn.now < plus(since, rule.delay)) return true;
  NotifyProgress& progress = progress_[{turn.rule, turn.alarm}];
  progress = {.rule = rule.name,
              .alarm = turn.alarm,
              .occurrence = occurrence,
              .first_at = turn.now,
              .last_at = turn.now,
              .count = 1,
              .returned = status.active ? Return::kNone : Return::kReported};
  changed_.insert({turn.rule, turn.alarm});
  send(turn, progress, NotifyKind::kRaised, rule.to, 1);
  return true;
}

bool RuleEngine::proceed(const Turn& turn, NotifyProgress& progress) {
  const AlarmStatus& status = turn.seen.status;
  const NotifyRule& rule = rules_[turn.rule];
  if (progress.state == State::kClosed) return false;
  const NotifyProgress before = progress;
  bool waits = false;
  if (!status.active && progress.returned == Return::kSeen && rule.cleared) {
    if (turn.may_send) {
      progress.returned = Return::kReported;
      send(turn, progress, NotifyKind::kCleared, informed(turn.rule, progress), 1);
    } else {
      waits = true;
    }
  }
  if (is_pending(status) && progress.state == State::kOpen) {
    waits = true;
    if (turn.may_send) send_escalations(turn, progress);
    const bool again = progress.last_at.nanoseconds == 0;
    const bool repeats = rule.repeat != Duration{} && progress.count <= rule.repeats &&
                         turn.now >= plus(progress.last_at, rule.repeat);
    if (turn.may_send && (again || repeats)) {
      ++progress.count;
      progress.last_at = turn.now;
      send(turn, progress, NotifyKind::kRepeated, rule.to, progress.count);
    }
  } else if (status.stage == AlarmStage::kClear && !waits) {
    progress.state = State::kClosed;
  }
  if (progress != before) changed_.insert({turn.rule, turn.alarm});
  return waits;
}

void RuleEngine::send_escalations(const Turn& turn, NotifyProgress& progress) {
  const auto& steps = rules_[turn.rule].escalate;
  while (progress.escalated < steps.size() &&
         turn.now >= plus(progress.first_at, steps[progress.escalated].after)) {
    const auto& to = steps[progress.escalated++].to;
    send(turn, progress, NotifyKind::kEscalated, to, progress.escalated);
  }
}

std::vector<std::string> RuleEngine::informed(std::size_t rule, const NotifyProgress& progress) {
  std::vector<std::string> targets = rules_[rule].to;
  const auto& steps = rules_[rule].escalate;
  for (std::size_t i = 0; i < std::min<std::size_t>(progress.escalated, steps.size()); ++i) {
    for (const std::string& target : steps[i].to)
      if (std::find(targets.begin(), targets.end(), target) == targets.end())
        targets.push_back(target);
  }
  return targets;
}

void RuleEngine::send(const Turn& turn, const NotifyProgress& progress, NotifyKind kind,
                      const std::vector<std::string>& targets, std::uint32_t number) {
  for (const std::string& target : targets) {
    if (collect(turn, kind, target)) continue;
    const std::string& rule = rules_[turn.rule].name;
    messages_.push_back({.id = message_id({to_text(kind), rule, target, to_text(turn.alarm),
                                           std::to_string(progress.occurrence.nanoseconds),
                                           std::to_string(number)}),
                         .kind = kind,
                         .rule = rule,
                         .target = target,
                         .at = turn.now,
                         .alarm = turn.alarm,
                         .status = turn.seen.status,
                         .number = number});
  }
}

// Returns true if the message is a line of the next digest.
bool RuleEngine::collect(const Turn& turn, NotifyKind kind, const std::string& target) {
  const NotifyRule& rule = rules_[turn.rule];
  if (rule.digest == 0) return false;
  const WindowKey key{turn.rule, target};
  NotifyWindow& window = windows_[key];
  if (window.start.nanoseconds == 0) window = {rule.name, target, turn.now};
  changed_windows_.insert(key);
  if (window.count < rule.digest) {
    ++window.count;
    return false;
  }
  const auto lines = std::count(window.lines.begin(), window.lines.end(), '\n');
  if (static_cast<std::size_t>(lines) < kMaxLines)
    window.lines += digest_line(to_text(kind), turn.alarm, turn.seen.status) + '\n';
  else
    ++window.more;
  return true;
}

void RuleEngine::end_windows(UtcTime now) {
  for (auto at = windows_.begin(); at != windows_.end();) {
    NotifyWindow& window = at->second;
    const NotifyRule& rule = rules_[at->first.first];
    const Duration age = elapsed(window.start, now);
    if (age >= Duration{} && age < rule.digest_within) {
      ++at;
      continue;
    }
    changed_windows_.insert(at->first);
    if (window.lines.empty()) {
      at = windows_.erase(at);
      continue;
    }
    messages_.push_back({.id = message_id({"digest", rule.name, window.target,
                                           std::to_string(window.start.nanoseconds)}),
                         .kind = NotifyKind::kDigest,
                         .rule = rule.name,
                         .target = window.target,
                         .at = now,
                         .lines = std::exchange(window.lines, {}),
                         .more = std::exchange(window.more, 0)});
    window.start = now;
    window.count = rule.digest;  // until a window without a further message
    ++at;
  }
}

}  // namespace fieldcast::web
