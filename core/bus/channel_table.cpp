#include "core/bus/channel_table.hpp"

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
  const auto x = as_number(a);
  const auto y = as_number(b);
  return x && y ? std::abs(*x - *y) > deadband : a != b;
}

}  // namespace

ChannelTable::ChannelTable(const BusSpec& bus, TextCodec& codec)
    : codec_(codec), names_(bus.devices.size()) {
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
      if (read_by_itself(channel)) entry.refresh = channel.refresh;
      entries_.push_back(std::move(entry));
      names_[device].emplace(channel.name, index);
    }
    ++device;
  }
  first_.push_back(static_cast<ChannelIndex>(entries_.size()));
}

std::optional<ChannelIndex> ChannelTable::find(DeviceIndex device, std::string_view name) const {
  const auto found = names_[device].find(name);
  if (found == names_[device].end()) return std::nullopt;
  return found->second;
}

std::optional<Duration> ChannelTable::refresh(ChannelIndex channel) const {
  return entries_[channel].refresh;
}

void ChannelTable::set_refresh(ChannelIndex channel, std::optional<Duration> refresh, Instant now) {
  Entry& entry = entries_[channel];
  settle(entry, now);
  entry.refresh = refresh;
  entry.late = false;
  entry.read = refresh ? now : kLongAgo;
  rearm(channel, now);
}

// Whole refreshes since the last that was told. What holds a deadband back is promised at its
// heartbeat.
std::uint64_t ChannelTable::passed(const Entry& entry, Instant now) {
  if (!entry.late || !entry.refresh || now <= entry.told) return 0;
  const Duration each =
      entry.spec->on_interest ? *entry.refresh : promised_gap(*entry.spec).value_or(*entry.refresh);
  return static_cast<std::uint64_t>((now - entry.told) / each);
}

void ChannelTable::count(Entry& entry, std::uint64_t misses) {
  if (misses == 0) return;
  entry.report.last_miss = entry.cause == Cause::kNone ? Cause::kLate : entry.cause;
  entry.report.missed += misses;
  misses_.add(entry.report.last_miss, misses);
}

// Everything that was missed until `now` is counted.
void ChannelTable::settle(Entry& entry, Instant now) {
  if (entry.late) {
    count(entry, passed(entry, now));
    entry.told = now;
  } else if (now > entry.promised) {
    count(entry, 1);
  }
}

ChannelReport ChannelTable::report(ChannelIndex channel, Instant now) const {
  const Entry& entry = entries_[channel];
  ChannelReport report = entry.report;
  report.missed += passed(entry, now);
  return report;
}

CauseCounters ChannelTable::misses(Instant now) const {
  CauseCounters all = misses_;
  for (const Entry& entry : entries_) {
    if (entry.late)
      all.add(entry.cause == Cause::kNone ? Cause::kLate : entry.cause, passed(entry, now));
  }
  return all;
}

void ChannelTable::rearm(ChannelIndex channel, Instant from) {
  Entry& entry = entries_[channel];
  entry.promised = entry.refresh ? from + *entry.refresh : kNever;
  entry.due = entry.refresh ? entry.promised + std::min(kTellAfter, *entry.refresh / 10) : kNever;
  if (entry.due >= entry.queued)
    return;  // the entry already queued comes first and is put back then
  expiries_.push({entry.due, channel});
  entry.queued = entry.due;
}

bool ChannelTable::held_back(const Entry& entry, const Value& value, Instant acquired) const {
  if (!entry.spec->deadband || entry.last.quality != Quality::kGood) return false;
  if (moved(value, entry.last.value, *entry.spec->deadband)) return false;
  const Duration heartbeat = entry.spec->heartbeat.value_or(entry.spec->refresh);
  // The next acquisition may come a whole refresh later: is there still time for it?
  return acquired + entry.spec->refresh <= entry.published + heartbeat;
}

void ChannelTable::publish(Entry& entry, std::vector<Sample>& out, Instant when) {
  ++entry.last.sequence;
  entry.published = when;
  out.push_back(entry.last);
}

void ChannelTable::acquired(ChannelIndex channel, unsigned item_bits, ByteView items,
                            Instant acquired, std::vector<Sample>& out) {
  Entry& entry = entries_[channel];
  settle(entry, acquired);
  entry.late = false;
  ++entry.report.readings;
  if (entry.read != kLongAgo)
    entry.report.worst_gap = std::max(entry.report.worst_gap, acquired - entry.read);
  entry.read = acquired;
  auto value = decode_value(entry.spec->encoding, item_bits, items, codec_);
  rearm(channel, acquired);
  if (!value) {
    entry.cause = value.error();
    entry.last.quality = quality_of(value.error());
    entry.last.device_code = 0;
    publish(entry, out, acquired);
    return;
  }
  entry.cause = Cause::kNone;
  if (held_back(entry, *value, acquired)) return;
  entry.last.value = std::move(*value);
  entry.last.quality = Quality::kGood;
  entry.last.device_code = 0;
  entry.last.acquired = acquired;
  publish(entry, out, acquired);
}

void ChannelTable::refused(ChannelIndex channel, Cause cause, std::uint16_t device_code,
                           Instant now, std::vector<Sample>& out) {
  Entry& entry = entries_[channel];
  const Quality quality = quality_of(cause);
  entry.cause = cause;
  if (entry.late && entry.last.quality == quality && entry.last.device_code == device_code) return;
  settle(entry, now);
  entry.told = now;
  entry.late = true;  // told: the missed refresh that follows is no news
  entry.last.quality = quality;
  entry.last.device_code = device_code;
  publish(entry, out, now);
}

void ChannelTable::failing(ChannelIndex channel, Cause cause, Instant now) {
  Entry& entry = entries_[channel];
  entry.cause = cause;
  const bool unexplained =
      entry.last.quality == Quality::kUncertain || entry.last.quality == Quality::kNotYetRead;
  if (!entry.late || !unexplained || quality_of(cause) == Quality::kGood) return;
  entry.unexplained = true;
  entry.due = now;
  if (entry.due >= entry.queued) return;
  expiries_.push({entry.due, channel});
  entry.queued = entry.due;
}

void ChannelTable::start(Instant now) {
  for (ChannelIndex channel = 0; channel < entries_.size(); ++channel) {
    Entry& entry = entries_[channel];
    if (entry.refresh && entry.read == kLongAgo) entry.read = now;
    if (!entry.late) rearm(channel, now);
  }
}

void ChannelTable::expire(Instant now, std::vector<Sample>& out) {
  while (!expiries_.empty() && expiries_.top().at <= now) {
    const auto [at, channel] = expiries_.top();
    expiries_.pop();
    Entry& entry = entries_[channel];
    if (at != entry.queued) continue;
    entry.queued = kNever;
    if (entry.due == kNever) continue;
    if (entry.due > now) {
      expiries_.push({entry.due, channel});
      entry.queued = entry.due;
      continue;
    }
    entry.due = kNever;  // armed again by the next acquisition
    if (entry.late && !entry.unexplained) continue;
    if (!entry.late) {
      entry.unblamed = entry.cause == Cause::kNone;
      count(entry, 1);
    } else {
      if (entry.unblamed) misses_.move(Cause::kLate, entry.cause);
      if (entry.unblamed) entry.report.last_miss = entry.cause;
      entry.unblamed = false;
      count(entry, passed(entry, now));
    }
    entry.told = now;
    entry.late = true;
    entry.unexplained = false;
    entry.last.quality = quality_of(entry.cause);
    if (entry.last.quality == Quality::kGood) entry.last.quality = Quality::kUncertain;
    // Uncertain is what is old; what was never read is not there yet, whatever delays it.
    if (entry.last.quality == Quality::kUncertain && entry.last.acquired == kLongAgo)
      entry.last.quality = Quality::kNotYetRead;
    publish(entry, out, now);
  }
}

void ChannelTable::unwanted(ChannelIndex channel, std::vector<Sample>& out) {
  Entry& entry = entries_[channel];
  if (entry.last.quality != Quality::kGood) return;
  entry.last.quality = Quality::kUncertain;
  publish(entry, out, entry.published);
}

void ChannelTable::all_uncertain(Instant now, std::vector<Sample>& out) {
  for (Entry& entry : entries_) {
    settle(entry, now);
    entry.cause = Cause::kLeased;
    if (entry.last.quality != Quality::kGood) continue;
    entry.last.quality = Quality::kUncertain;
    entry.late = true;
    entry.unblamed = false;
    entry.told = now;
    publish(entry, out, entry.published);
  }
}

void ChannelTable::not_yet_read(std::vector<Sample>& out) {
  for (Entry& entry : entries_) {
    if (!entry.refresh && entry.last.sequence == 0) publish(entry, out, kLongAgo);
  }
}

}  // namespace fieldcast
