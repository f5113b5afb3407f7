#include "core/bus/command/channel_table.hpp"

#include <algorithm>
#include <cmath>

namespace fieldcast {
namespace {

Value zero_of(const Encoding& encoding) {
  if (encoding.type == ValueType::kBool) return false;
  if (encoding.type == ValueType::kString) return std::string{};
  if (encoding.scaled() || encoding.type == ValueType::kFloat32 ||
      encoding.type == ValueType::kFloat64)
    return 0.0;
  switch (encoding.type) {
    case ValueType::kInt8:
    case ValueType::kInt16:
    case ValueType::kInt32:
    case ValueType::kInt64: return std::int64_t{0};
    default: return std::uint64_t{0};
  }
}

bool moved(const Value& a, const Value& b, double deadband) {
  if (deadband == 0) return a != b;  // also of integers that no double represents
  const auto x = as_number(a);
  const auto y = as_number(b);
  return x && y ? std::abs(*x - *y) > deadband : a != b;
}

// Whether one of the values is beyond a limit, or inside it again by the hysteresis, and the other
// is not: an alarm depends on the newest value (LimitWatch).
bool crosses_limit(const Value& a, const Value& b, const Limits& limits) {
  const auto x = as_number(a);
  const auto y = as_number(b);
  if (!x || !y) return false;
  const double inside = limits.hysteresis;
  const auto below = [&](double edge) { return (*x < edge) != (*y < edge); };
  const auto above = [&](double edge) { return (*x > edge) != (*y > edge); };
  const auto low = [&](const std::optional<double>& limit) {
    return limit && (below(*limit) || below(*limit + inside));
  };
  const auto high = [&](const std::optional<double>& limit) {
    return limit && (above(*limit) || above(*limit - inside));
  };
  return low(limits.low_low) || low(limits.low) || high(limits.high) || high(limits.high_high);
}

// The inputs of a calculated channel report first that they are late.
constexpr Duration kBehindInputs = std::chrono::milliseconds{100};

// Longest promised time between two samples: with a deadband, the heartbeat.
Duration gap_of(const ChannelSpec& spec, std::optional<Duration> refresh) {
  if (!refresh) return Duration::zero();
  return spec.on_interest ? *refresh : promised_gap(spec).value_or(*refresh);
}

}  // namespace

ChannelTable::ChannelTable(const BusSpec& bus, TextCodec& codec) : codec_(codec) {
  DeviceIndex device = 0;
  for (const DeviceSpec& spec : bus.devices) {
    first_.push_back(static_cast<ChannelIndex>(entries_.size()));
    for (const ChannelSpec& channel : spec.channels) {
      const auto index = static_cast<ChannelIndex>(entries_.size());
      Entry entry;
      entry.spec = &channel;
      entry.device = device;
      entry.last.channel = index;
      entry.last.value = zero_of(channel.encoding);
      const Duration spare = channel.calculation ? kBehindInputs : Duration::zero();
      if (read_by_itself(channel))
        entry.freshness =
            Freshness(channel.refresh + spare, gap_of(channel, channel.refresh) + spare);
      entries_.push_back(std::move(entry));
    }
    ++device;
  }
  first_.push_back(static_cast<ChannelIndex>(entries_.size()));
  entries_.shrink_to_fit();
}

void ChannelTable::inherit(const Sample& sample) {
  if (sample.channel >= entries_.size() || sample.sequence == 0) return;
  Sample& last = entries_[sample.channel].last;
  if (sample.value.index() != last.value.index()) {
    last.sequence = sample.sequence;
  } else {
    last = sample;
  }
}

std::optional<Duration> ChannelTable::refresh(ChannelIndex channel) const {
  return entries_[channel].freshness.refresh();
}

void ChannelTable::set_refresh(ChannelIndex channel, std::optional<Duration> refresh, Instant now) {
  Entry& entry = entries_[channel];
  entry.freshness.promise(refresh, gap_of(*entry.spec, refresh), now, misses_);
  entry.read = refresh ? now : kLongAgo;
  queue(channel);
}

ChannelReport ChannelTable::report(ChannelIndex channel, Instant now) const {
  const Entry& entry = entries_[channel];
  return {entry.readings, entry.freshness.missed(now), entry.worst_gap,
          entry.freshness.last_miss()};
}

CauseCounters ChannelTable::misses(Instant now) const {
  CauseCounters all = misses_;
  for (const Entry& entry : entries_) entry.freshness.add_passed(now, all);
  return all;
}

// Does nothing if an earlier entry is queued; expire() queues that entry again.
void ChannelTable::queue(ChannelIndex channel) {
  Entry& entry = entries_[channel];
  const Instant due = entry.freshness.due();
  if (due >= entry.queued) return;
  expiries_.push({due, channel});
  entry.queued = due;
}

bool ChannelTable::held_back(const Entry& entry, const Value& value, Instant acquired) const {
  if (!entry.spec->deadband || entry.last.quality != Quality::kGood) return false;
  if (entry.spec->on_interest) return false;  // its promise is the refresh of the interest
  if (moved(value, entry.last.value, *entry.spec->deadband)) return false;
  if (crosses_limit(value, entry.last.value, entry.spec->limits)) return false;
  const Duration heartbeat = entry.spec->heartbeat.value_or(entry.spec->refresh);
  // The next acquisition may be a whole refresh later, so the heartbeat must allow for it.
  return acquired + entry.spec->refresh <= entry.published + heartbeat;
}

void ChannelTable::publish(Entry& entry, std::vector<Sample>& out, Instant when) {
  entry.last.sequence = std::max(entry.last.sequence, above_) + 1;
  entry.published = when;
  out.push_back(entry.last);
}

void ChannelTable::response(ChannelIndex channel, Instant acquired, Cause cause) {
  Entry& entry = entries_[channel];
  entry.freshness.acquired(acquired, misses_);
  queue(channel);
  ++entry.readings;
  if (entry.read != kLongAgo) entry.worst_gap = std::max(entry.worst_gap, acquired - entry.read);
  entry.read = acquired;
  entry.freshness.explain(cause);
}

void ChannelTable::no_value(ChannelIndex channel, Cause cause, Instant acquired,
                            std::vector<Sample>& out) {
  Entry& entry = entries_[channel];
  response(channel, acquired, cause);
  entry.last.quality = quality_of(cause);
  entry.last.device_code = cause == Cause::kNotAvailable ? kNotAvailableCode : 0;
  publish(entry, out, acquired);
}

void ChannelTable::acquired(ChannelIndex channel, unsigned item_bits, ByteView items,
                            Instant acquired, std::vector<Sample>& out) {
  Entry& entry = entries_[channel];
  auto value = decode_value(entry.spec->encoding, item_bits, items, codec_);
  if (!value) return no_value(channel, value.error(), acquired, out);
  response(channel, acquired, Cause::kNone);
  if (held_back(entry, *value, acquired)) return;
  entry.last.value = std::move(*value);
  // Without an interest no further sample shows that a value read by command is old.
  const bool is_promised = !entry.spec->on_interest || entry.freshness.refresh();
  entry.last.quality = is_promised ? Quality::kGood : Quality::kUncertain;
  entry.last.device_code = 0;
  entry.last.acquired = std::max(acquired, entry.last.acquired + Duration{1});
  publish(entry, out, acquired);
}

void ChannelTable::calculated(ChannelIndex channel, const Calculated& result, Instant now,
                              std::vector<Sample>& out) {
  Entry& entry = entries_[channel];
  if (result.quality != Quality::kGood) {
    const bool never = entry.last.acquired == kLongAgo;
    if (result.quality == Quality::kNotYetRead && never) return;
    return refused(channel, cause_of(result), result.device_code, now, out);
  }
  response(channel, now, Cause::kNone);
  if (held_back(entry, result.value, now)) return;
  entry.last.value = result.value;
  entry.last.quality = Quality::kGood;
  entry.last.device_code = 0;
  entry.last.acquired = result.acquired;
  publish(entry, out, now);
}

void ChannelTable::unsolicited(DeviceIndex device, const Range& range, ByteView items,
                               std::span<const Range> absent, Instant acquired,
                               std::vector<Sample>& out) {
  constexpr unsigned kItemBits = 16;  // of a record
  for (ChannelIndex channel = first_of(device); channel < end_of(device); ++channel) {
    const ChannelSpec& spec = *entries_[channel].spec;
    if (spec.calculation || spec.range.area != range.area || spec.range.end() > range.end())
      continue;
    const bool has_none = std::ranges::any_of(absent, [&](const Range& part) {
      return part.first < spec.range.end() && spec.range.first < part.end();
    });
    if (has_none) {
      no_value(channel, Cause::kNotAvailable, acquired, out);
      continue;
    }
    this->acquired(channel, kItemBits,
                   items.subspan(image_bytes(kItemBits, spec.range.first),
                                 image_bytes(kItemBits, spec.range.count)),
                   acquired, out);
  }
}

void ChannelTable::refused(ChannelIndex channel, Cause cause, std::uint16_t device_code,
                           Instant now, std::vector<Sample>& out) {
  Entry& entry = entries_[channel];
  const Quality quality = quality_of(cause);
  const bool told = entry.freshness.late() && entry.last.quality == quality &&
                    entry.last.device_code == device_code;
  if (told) return entry.freshness.explain(cause);
  entry.freshness.refused(cause, now, misses_);
  entry.last.quality = quality;
  entry.last.device_code = device_code;
  publish(entry, out, now);
}

void ChannelTable::failing(ChannelIndex channel, Cause cause, Instant now,
                           std::uint16_t device_code) {
  Entry& entry = entries_[channel];
  if (entry.spec->calculation) return;  // it depends on its inputs, not on this wire
  entry.failing_code = device_code;
  const bool uncertain =
      entry.last.quality == Quality::kUncertain || entry.last.quality == Quality::kNotYetRead;
  if (entry.freshness.failing(cause, uncertain, now)) queue(channel);
}

void ChannelTable::start(Instant now) {
  for (ChannelIndex channel = 0; channel < entries_.size(); ++channel) {
    Entry& entry = entries_[channel];
    if (entry.freshness.refresh() && entry.read == kLongAgo) entry.read = now;
    entry.freshness.start(now);
    queue(channel);
  }
}

void ChannelTable::expire(Instant now, std::vector<Sample>& out) {
  while (!expiries_.empty()) {
    const auto [at, channel] = expiries_.top();
    Entry& entry = entries_[channel];
    // An entry of a channel that was read since then would wake the bus for nothing.
    if (at > now && at == entry.queued && at == entry.freshness.due()) return;
    expiries_.pop();
    if (at != entry.queued) continue;
    entry.queued = kNever;
    if (entry.freshness.due() > now) {
      queue(channel);
      continue;
    }
    if (entry.spec->unsolicited && entry.freshness.cause() == Cause::kNone)
      entry.freshness.explain(Cause::kNoResponse);
    if (!entry.freshness.expire(now, misses_)) continue;
    const Quality before = entry.last.quality;
    entry.last.quality = quality_of(entry.freshness.cause());
    if (entry.last.quality != before) entry.last.device_code = 0;
    if (entry.freshness.cause() == Cause::kDeviceBusy) entry.last.device_code = entry.failing_code;
    if (entry.last.quality == Quality::kGood) entry.last.quality = Quality::kUncertain;
    // A value that was never read stays kNotYetRead; kUncertain is for old values.
    if (entry.last.quality == Quality::kUncertain && entry.last.acquired == kLongAgo)
      entry.last.quality = Quality::kNotYetRead;
    publish(entry, out, now);
  }
}

void ChannelTable::interest_ended(ChannelIndex channel, std::vector<Sample>& out) {
  Entry& entry = entries_[channel];
  if (entry.last.quality != Quality::kGood) return;
  entry.last.quality = Quality::kUncertain;
  publish(entry, out, entry.published);
}

void ChannelTable::all_uncertain(Instant now, std::vector<Sample>& out) {
  for (Entry& entry : entries_) {
    if (entry.spec->calculation) continue;  // follows its inputs
    const bool good = entry.last.quality == Quality::kGood;
    entry.freshness.leased(good, now, misses_);
    if (!good) continue;
    entry.last.quality = Quality::kUncertain;
    publish(entry, out, entry.published);
  }
}

// Good values are not repeated, as another bridge may have read later ones: the next reading is
// published regardless of the deadband.
void ChannelTable::again(std::vector<Sample>& out) {
  for (Entry& entry : entries_) {
    entry.published = kLongAgo;
    const bool bad = entry.last.sequence != 0 && entry.last.quality != Quality::kGood;
    const bool known = entry.freshness.refresh() || entry.last.acquired != kLongAgo;
    if (bad && known) publish(entry, out, kLongAgo);
  }
}

void ChannelTable::not_yet_read(std::vector<Sample>& out) {
  for (Entry& entry : entries_) {
    if (!entry.freshness.refresh() && entry.last.sequence == 0) publish(entry, out, kLongAgo);
  }
}

}  // namespace fieldcast
