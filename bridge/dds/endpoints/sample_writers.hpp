// The Sample writers of one bus: one for each distinct promise, each with at most 256 channels,
// because DEADLINE makes the library scan a writer's instances at nearly every write (100 000
// writes over 100 instances 0.26 s, over 10 000 instances 25 s). The writers rest while no reader
// is matched, because a write costs some 10 us even then. The first reader wakes them, and gets the
// last value of every channel. Owns the writers and the last written value of each channel. Any
// thread; samples of one channel are in order if one thread at a time writes them.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridge/dds/endpoints/block_writer.hpp"
#include "bridge/dds/endpoints/dds_link.hpp"
#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/topics/sample_type.hpp"
#include "bridge/dds/transport/domain.hpp"

namespace fieldcast {

class SampleWriters {
 public:
  // Throws DdsError. `most_bytes` bounds a datagram. `snapshots` is notified of each matched
  // reader; for one that matches while the writers rest, it must call wake() soon, on another
  // thread.
  SampleWriters(Domain& domain, const std::string& bridge, const BusSpec& bus,
                std::size_t most_bytes, const BlockWriter& blocks, SnapshotSender& snapshots);
  ~SampleWriters();  // calls dispose() unless done
  SampleWriters(const SampleWriters&) = delete;
  SampleWriters& operator=(const SampleWriters&) = delete;

  // If false, the writers rest and write() has no effect.
  [[nodiscard]] bool awake() const { return awake_; }
  struct Woken {
    std::size_t written = 0;
    bool all = true;  // false: call again
  };
  // Ends the rest if a reader is matched: writes the last values, at most `most` with each call.
  Woken wake(std::size_t most);

  // Writes samples of one channel in order; skips those not newer than the last written value.
  // Returns false if the library rejected a sample (limits, slow readers); the others are written.
  bool write(std::span<const Sample> samples, const UtcMapping& mapping);

  // Returns false if nothing changes, also if the library cannot create a writer. Writes the last
  // sample at the new writer before the old one unregisters the instance.
  bool move(ChannelIndex channel, std::optional<Duration> refresh);
  [[nodiscard]] std::optional<Duration> refresh_of(ChannelIndex channel) const;
  [[nodiscard]] Duration shortest_refresh() const;  // that is promised; kInfinite: none

  // Removes writers whose last channel moved away, and lets the writers rest some time after the
  // last reader has left. Call it regularly, also without samples: readers count the deadlines that
  // such a writer misses. Does not throw; old writers stay if new ones cannot be created.
  void tidy(Instant now);

  // Disposes every instance, waits at most `linger` for all readers, and deletes the writers.
  // Instances that remain after `limit` end with their writers.
  void dispose(Duration linger, Duration limit = kInfinite);

  [[nodiscard]] DdsLink::BusCounters counters() const;

 private:
  struct Writer;
  struct Slot {
    SampleKey key;
    LastValue value;           // last written at its writer; sequence 0: none
    Writer* writer = nullptr;  // null: write-only, and not acquired so far
    std::uint64_t order = 0;   // of its last write among all of the bus
    [[nodiscard]] bool written() const { return value.sequence != 0; }
    [[nodiscard]] OutgoingSample outgoing() const { return {&key, &value}; }
  };
  struct Write {
    Slot* slot;
    const Sample* sample;
  };
  // An empty writer stays this long: its readers first receive the channel from the new writer.
  static constexpr Duration kIdle = std::chrono::seconds{1};
  // Time without readers before the writers rest; a reader that returns earlier finds them awake.
  static constexpr Duration kRestAfter = std::chrono::seconds{10};
  // Samples that wake() writes before it releases the lock: some 100 us.
  static constexpr std::size_t kWakeChunk = 8;

  // A moved channel is unregistered after kIdle, as messages of two writers may overtake.
  struct Leaving {
    ChannelIndex channel;
    Writer* old;
    std::optional<Instant> since;  // set by the next tidy()
  };
  // REQUIRES for all: mutex_ held.
  // Returns the samples that have a writer, in writing order; see the definition.
  [[nodiscard]] std::vector<Write>& in_order(std::span<const Sample> samples);
  bool write(Slot& slot);
  void let_go(Instant now);
  Writer& writer_for(std::optional<Duration> refresh);
  dds::DataWriter* entity_for(Writer& writer);
  void tidy_up(Instant now);
  void remove_idle_writers(Instant now);
  void rest_if_unread(Instant now);
  bool make_anew();  // false: the library cannot create writers; nothing changed
  void renew(Instant now);
  // Both throw DdsError. The second one writes the last sample at the new writer.
  void attach(Slot& slot, std::optional<Duration> refresh);
  void attach_anew(ChannelIndex channel, std::optional<Duration> refresh);
  // Assigns a writer without refresh to an acquired write-only channel. False: none can be created.
  bool has_writer(Slot& slot);
  [[nodiscard]] bool has_readers() const;

  Domain& domain_;
  const std::string label_;
  const std::size_t most_bytes_;
  const std::string bus_;
  const BlockWriter& blocks_;
  SnapshotSender& snapshots_;
  std::atomic<bool> awake_{false};
  mutable std::mutex mutex_;  // protects the members below
  std::vector<Slot> slots_;
  std::vector<std::unique_ptr<Writer>> writers_;
  std::vector<Leaving> leaving_;
  std::vector<Write> order_;  // of one write(), kept for its memory
  std::uint64_t writes_ = 0;
  std::size_t unwoken_ = 0;  // first slot that wake() has not processed
  bool any_idle_ = false;
  std::uint64_t retired_misses_ = 0;     // of removed writers
  std::optional<Instant> unread_since_;  // awake without readers since; set by the next tidy()
};

}  // namespace fieldcast
