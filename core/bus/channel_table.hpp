// The channels of one bus at run time: their last samples, what is to be published, and when a
// promise breaks (Freshness).
//
// Owns the last sample of each channel and the queue of promises. Owned by the bus engine, on the
// bus's thread. Samples to be published are appended to the caller's list. Nothing can fail: items
// that are no value of the channel's type become a sample of bad quality.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <queue>
#include <span>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/bus/freshness.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"
#include "core/model/status.hpp"
#include "core/plan/point.hpp"

namespace fieldcast {

class ChannelTable {
 public:
  // bus and codec outlive the table.
  explicit ChannelTable(const BusSpec& bus, TextCodec& codec = plain_text_codec());

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] const ChannelSpec& spec(ChannelIndex channel) const {
    return *entries_[channel].spec;
  }
  [[nodiscard]] DeviceIndex device(ChannelIndex channel) const { return entries_[channel].device; }
  [[nodiscard]] ChannelIndex first_of(DeviceIndex device) const { return first_[device]; }
  [[nodiscard]] ChannelIndex end_of(DeviceIndex device) const { return first_[device + 1u]; }
  [[nodiscard]] std::optional<ChannelIndex> find(DeviceIndex device, std::string_view name) const;

  // The last sample, as another bridge has published it. One of another type is not taken, but its
  // sequence.
  void inherit(const Sample& sample);
  // Samples count on from above this number.
  void count_above(std::uint64_t number) { above_ = std::max(above_, number); }
  // Stations may show what another bridge has published: what is not good here is told once more.
  void again(std::vector<Sample>& out);

  // Whether it has ever had a value, from here or inherited.
  [[nodiscard]] bool was_read(ChannelIndex channel) const {
    return entries_[channel].last.acquired != kLongAgo;
  }

  // The refresh in force; nothing while nobody is promised anything (on demand, no interest).
  [[nodiscard]] std::optional<Duration> refresh(ChannelIndex channel) const;
  void set_refresh(ChannelIndex channel, std::optional<Duration> refresh, Instant now);

  // New items arrived at `acquired`: appends a sample unless the deadband holds it back.
  void acquired(ChannelIndex channel, unsigned item_bits, ByteView items, Instant acquired,
                std::vector<Sample>& out);
  // The device refused the channel's address: published at once, but not again until it changes.
  void refused(ChannelIndex channel, Cause cause, std::uint16_t device_code, Instant now,
               std::vector<Sample>& out);
  // The cause that a missed refresh will show. A refresh that was missed before the cause was known
  // is told once more, with it.
  void failing(ChannelIndex channel, Cause cause, Instant now, std::uint16_t device_code = 0);

  // Starts the clock of every promise: a channel that is not read within its refresh from `now` is
  // late.
  void start(Instant now);
  // Publishes the last value of each channel whose refresh ran out by `now`, once, with a bad
  // quality. This happens a moment after the refresh ran out: a DDS deadline of the same length
  // begins when the sample is written, and is missed by then as well.
  void expire(Instant now, std::vector<Sample>& out);
  [[nodiscard]] ChannelReport report(ChannelIndex channel, Instant now) const;
  [[nodiscard]] CauseCounters misses(Instant now) const;  // of all channels, by cause
  [[nodiscard]] Instant next_expiry() const {
    return expiries_.empty() ? kNever : expiries_.top().at;
  }

  // The last interest in the channel ended: a last good value once more, as UNCERTAIN, since it
  // will not be renewed.
  void interest_ended(ChannelIndex channel, std::vector<Sample>& out);
  // Every channel's last value once more as UNCERTAIN (the bus was leased).
  void all_uncertain(Instant now, std::vector<Sample>& out);
  // First samples of channels that are only read when somebody asks, so that stations see that they
  // exist.
  void not_yet_read(std::vector<Sample>& out);

 private:
  struct Entry {
    const ChannelSpec* spec = nullptr;
    DeviceIndex device = 0;
    Sample last;
    Freshness freshness;
    Instant published = kLongAgo;
    Instant queued = kNever;  // of the one valid entry in expiries_
    Instant read = kLongAgo;  // the last time, or the start of the promise
    std::uint64_t readings = 0;
    Duration worst_gap{};  // between two readings
    std::uint16_t failing_code =
        0;  // with Cause::kDeviceBusy: of the device, since the last sample
  };
  struct Expiry {
    Instant at;
    ChannelIndex channel;
    friend bool operator>(const Expiry& a, const Expiry& b) { return a.at > b.at; }
  };

  void queue(ChannelIndex channel);
  void publish(Entry& entry, std::vector<Sample>& out, Instant when);
  [[nodiscard]] bool held_back(const Entry& entry, const Value& value, Instant acquired) const;

  std::uint64_t above_ = 0;
  CauseCounters misses_;
  TextCodec& codec_;
  std::vector<Entry> entries_;
  std::vector<ChannelIndex> first_;  // of each device, and the end
  std::vector<std::unordered_map<std::string_view, ChannelIndex>> names_;
  // Lazy: an entry may be older than its channel's promise; it is put back then. An entry whose
  // instant is not the channel's `queued` is ignored.
  std::priority_queue<Expiry, std::vector<Expiry>, std::greater<>> expiries_;
};

}  // namespace fieldcast
