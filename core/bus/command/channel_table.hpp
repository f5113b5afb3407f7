// The channels of one bus: last samples, publication, and broken promises (Freshness). Owned by the
// bus engine, on the bus's thread. Items that do not decode produce a sample of bad quality.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <queue>
#include <span>
#include <vector>

#include "core/bus/command/freshness.hpp"
#include "core/calculate/evaluation.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/sample.hpp"
#include "core/model/status.hpp"
#include "core/plan/layout/cost.hpp"

namespace fieldcast {

class ChannelTable {
 public:
  explicit ChannelTable(const BusSpec& bus, TextCodec& codec = plain_text_codec());

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] const ChannelSpec& spec(ChannelIndex channel) const {
    return *entries_[channel].spec;
  }
  [[nodiscard]] DeviceIndex device(ChannelIndex channel) const { return entries_[channel].device; }
  [[nodiscard]] ChannelIndex first_of(DeviceIndex device) const { return first_[device]; }
  [[nodiscard]] ChannelIndex end_of(DeviceIndex device) const { return first_[device + 1u]; }

  // Restores a sample of another bridge; only its sequence if the type differs.
  void inherit(const Sample& sample);
  void count_above(std::uint64_t number) { above_ = std::max(above_, number); }
  // Publishes samples that are not good again, as stations may show samples of another bridge.
  void again(std::vector<Sample>& out);

  // Read here or inherited.
  [[nodiscard]] bool was_read(ChannelIndex channel) const {
    return entries_[channel].last.acquired != kLongAgo;
  }

  // Empty if there is no promise (on demand, without interest).
  [[nodiscard]] std::optional<Duration> refresh(ChannelIndex channel) const;
  void set_refresh(ChannelIndex channel, std::optional<Duration> refresh, Instant now);

  // Appends a sample unless the deadband holds it back. Its time is later than that of the last
  // value, at least by a nanosecond: responses that arrived together have the same time.
  void acquired(ChannelIndex channel, unsigned item_bits, ByteView items, Instant acquired,
                std::vector<Sample>& out);
  // Appends a sample of the last value: the response has none of this channel, by `cause`.
  void no_value(ChannelIndex channel, Cause cause, Instant acquired, std::vector<Sample>& out);
  // As `acquired` for the channels of a frame that the device sent by itself; `range` is a record.
  // `absent`: parts of it that the frame does not have.
  void unsolicited(DeviceIndex device, const Range& range, ByteView items,
                   std::span<const Range> absent, Instant acquired, std::vector<Sample>& out);
  // As `acquired` for a calculated channel; a result that is not good is as `refused`.
  void calculated(ChannelIndex channel, const Calculated& result, Instant now,
                  std::vector<Sample>& out);
  // Publishes immediately, and again only after a change.
  void refused(ChannelIndex channel, Cause cause, std::uint16_t device_code, Instant now,
               std::vector<Sample>& out);
  // Sets the cause of a missed refresh; reports a miss again that had no cause.
  void failing(ChannelIndex channel, Cause cause, Instant now, std::uint16_t device_code = 0);

  void start(Instant now);
  // Publishes each channel whose refresh expired by `now`, once, with a bad quality. This happens
  // shortly after the expiry, so that a DDS deadline of the same length is missed by then as well.
  void expire(Instant now, std::vector<Sample>& out);
  [[nodiscard]] ChannelReport report(ChannelIndex channel, Instant now) const;
  [[nodiscard]] CauseCounters misses(Instant now) const;  // of all channels, by cause
  [[nodiscard]] Instant next_expiry() const {
    return expiries_.empty() ? kNever : expiries_.top().at;
  }

  // Publishes a good last value again as UNCERTAIN, since it will not be refreshed.
  void interest_ended(ChannelIndex channel, std::vector<Sample>& out);
  void all_uncertain(Instant now, std::vector<Sample>& out);
  // First samples of on-demand channels, so that stations see that they exist.
  void not_yet_read(std::vector<Sample>& out);

 private:
  struct Entry {
    const ChannelSpec* spec = nullptr;
    DeviceIndex device = 0;
    Sample last;
    Freshness freshness;
    Instant published = kLongAgo;
    Instant queued = kNever;
    Instant read = kLongAgo;  // last reading, or start of the promise
    std::uint64_t readings = 0;
    Duration worst_gap{};
    std::uint16_t failing_code = 0;  // device code of Cause::kDeviceBusy since the last sample
  };
  struct Expiry {
    Instant at;
    ChannelIndex channel;
    friend bool operator>(const Expiry& a, const Expiry& b) { return a.at > b.at; }
  };

  void queue(ChannelIndex channel);
  void response(ChannelIndex channel, Instant acquired, Cause cause);
  void publish(Entry& entry, std::vector<Sample>& out, Instant when);
  [[nodiscard]] bool held_back(const Entry& entry, const Value& value, Instant acquired) const;

  std::uint64_t above_ = 0;
  CauseCounters misses_;
  TextCodec& codec_;
  std::vector<Entry> entries_;
  std::vector<ChannelIndex> first_;
  // Lazy: an old entry is queued again when it expires; one that differs from `queued` is ignored.
  std::priority_queue<Expiry, std::vector<Expiry>, std::greater<>> expiries_;
};

}  // namespace fieldcast
