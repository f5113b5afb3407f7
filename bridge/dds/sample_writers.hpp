// The Sample writers of one bus: one for each distinct promise, none with more than 256 channels,
// because DEADLINE makes the library scan a writer's instances at nearly every write (100 000
// writes over 100 instances 0.26 s, over 10 000 instances 25 s).
//
// Owns the writers and, for each channel, the topic object that is written again and again. One
// caller at a time (dds_link.hpp); counters from any thread.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridge/dds/dds_link.hpp"
#include "bridge/dds/domain.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/sample_type.hpp"

namespace fieldcast {

class SampleWriters {
 public:
  // Makes the writers of every channel that is read. Throws DdsError.
  SampleWriters(Domain& domain, const std::string& bridge, const BusSpec& bus);
  ~SampleWriters();  // dispose() unless done
  SampleWriters(const SampleWriters&) = delete;
  SampleWriters& operator=(const SampleWriters&) = delete;

  // Samples of one channel leave in order. False if the library did not take one of them (limits,
  // or readers that do not acknowledge); the others are written.
  bool write(std::span<const Sample> samples, const UtcMapping& mapping);

  // False if nothing changes. The last sample is written again at the new writer, so that late
  // joiners find it, before the old writer lets go of the instance. Throws DdsError if a writer is
  // needed and cannot be made.
  bool move(ChannelIndex channel, std::optional<Duration> refresh);
  [[nodiscard]] std::optional<Duration> refresh_of(ChannelIndex channel) const;

  // Removes writers whose last channel has moved away a while ago; now and then, whether samples
  // come or not: readers go on counting the deadlines that such a writer misses.
  void tidy(Instant now);

  // Tells readers that every instance is gone, waits for all of them at most `linger`, and
  // deletes the writers. Instances that are left after `limit` end with their writers.
  void dispose(Duration linger, Duration limit = kInfinite);

  [[nodiscard]] DdsLink::BusCounters counters() const;

 private:
  struct Writer;
  struct Slot {
    SampleKey key;
    LastValue value;           // written last; sequence 0: none
    Writer* writer = nullptr;  // null: never sampled (write-only)
    std::uint64_t order = 0;   // of its last write among all of the bus
    [[nodiscard]] bool written() const { return value.sequence != 0; }
    [[nodiscard]] OutgoingSample outgoing() const { return {&key, &value}; }
  };
  struct Write {
    Slot* slot;
    const Sample* sample;
  };
  // A writer whose last channel has moved away stays this long, so that its readers have the
  // channel from the new writer first.
  static constexpr Duration kIdle = std::chrono::seconds{1};

  // A channel that has moved is unregistered at its old writer after the same time: notes of two
  // writers may overtake each other.
  struct Leaving {
    ChannelIndex channel;
    Writer* old;
    std::optional<Instant> since;  // known from the next tidy() on
  };
  // In the order in which they are written; see the definition.
  [[nodiscard]] std::vector<Write>& in_order(std::span<const Sample> samples);
  void let_go(Instant now);
  Writer& writer_for(std::optional<Duration> refresh);
  void remove_idle_writers(Instant now);
  void attach(Slot& slot, std::optional<Duration> refresh);

  Domain& domain_;
  std::string label_;
  std::vector<Slot> slots_;
  std::vector<std::unique_ptr<Writer>> writers_;
  std::vector<Leaving> leaving_;
  std::vector<Write> order_;  // of one write(), kept for its memory
  std::uint64_t writes_ = 0;
  bool any_idle_ = false;
  std::uint64_t retired_misses_ = 0;  // of writers that are gone
  mutable std::mutex writers_mutex_;  // the list, against counters()
};

}  // namespace fieldcast
