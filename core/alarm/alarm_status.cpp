#include "core/alarm/alarm_status.hpp"

#include <cmath>

namespace fieldcast {

namespace {

bool is_high(LimitKind kind) { return kind == LimitKind::kHigh || kind == LimitKind::kHighHigh; }

}  // namespace

std::string_view to_text(LimitKind kind) {
  switch (kind) {
    case LimitKind::kLowLow: return "low-low";
    case LimitKind::kLow: return "low";
    case LimitKind::kHigh: return "high";
    case LimitKind::kHighHigh: return "high-high";
  }
  return "?";
}

std::optional<LimitKind> limit_kind_from(std::string_view text) {
  for (const LimitKind kind :
       {LimitKind::kLowLow, LimitKind::kLow, LimitKind::kHigh, LimitKind::kHighHigh}) {
    if (text == to_text(kind)) return kind;
  }
  return std::nullopt;
}

std::string_view to_text(AlarmState state) {
  return state == AlarmState::kActive ? "active" : "clear";
}

bool LimitWatch::on_good(double value, Instant acquired, Instant now) {
  if (std::isnan(value)) {
    on_bad();
    return false;
  }
  trusted_ = true;
  newest_ = value;
  newest_at_ = acquired;
  if (state_ == AlarmState::kActive) {
    if (!back_inside(value)) return false;
    state_ = AlarmState::kClear;
    beyond_since_.reset();
    value_ = value;
    since_ = acquired;
    return true;
  }
  if (!beyond(value)) {
    beyond_since_.reset();
    return false;
  }
  if (!beyond_since_) beyond_since_ = acquired;
  value_ = value;
  return raise_if_due(now);
}

bool LimitWatch::on_time(Instant now) { return trusted_ && waiting() && raise_if_due(now); }

void LimitWatch::restore(double value, Instant since) {
  state_ = AlarmState::kActive;
  value_ = value;
  since_ = since;
  if (newest_) (void)on_good(*newest_, newest_at_, newest_at_);
}

bool LimitWatch::raise_if_due(Instant now) {
  if (now - *beyond_since_ < delay_) return false;
  state_ = AlarmState::kActive;
  since_ = *beyond_since_;
  return true;
}

bool LimitWatch::beyond(double value) const {
  return is_high(kind_) ? value > limit_ : value < limit_;
}

bool LimitWatch::back_inside(double value) const {
  return is_high(kind_) ? value <= limit_ - hysteresis_ : value >= limit_ + hysteresis_;
}

std::string to_text(const AlarmKey& key) {
  std::string text = key.bus + '/' + key.device;
  if (!key.channel.empty()) text += '/' + key.channel + ' ' + std::string(to_text(key.limit));
  return text;
}

std::string_view to_text(AlarmStage stage) {
  switch (stage) {
    case AlarmStage::kClear: return "clear";
    case AlarmStage::kUnacknowledged: return "unacknowledged";
    case AlarmStage::kAcknowledged: return "acknowledged";
    case AlarmStage::kReturned: return "returned";
  }
  return "?";
}

std::string_view to_text(AlarmActionKind kind) {
  switch (kind) {
    case AlarmActionKind::kAcknowledge: return "acknowledge";
    case AlarmActionKind::kShelve: return "shelve";
    case AlarmActionKind::kUnshelve: return "unshelve";
    case AlarmActionKind::kMaintenance: return "maintenance";
    case AlarmActionKind::kEndMaintenance: return "end maintenance";
    case AlarmActionKind::kEndSession: return "end programming session";
  }
  return "?";
}

}  // namespace fieldcast
