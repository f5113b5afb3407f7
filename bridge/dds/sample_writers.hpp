// The Sample writers of one bus: one for each distinct promise, none with more than 256 channels,
// because DEADLINE makes the library scan a writer's instances at nearly every write (100 000
// writes over 100 instances 0.26 s, over 10 000 instances 25 s).
//
// They rest while no reader is matched: a write costs some 10 us, whether anybody reads or not. The
// first reader wakes them, and gets the last value of every channel, which the bus keeps anyway.
// They rest again once the last reader has been gone for a while.
//
// Owns the writers and, for each channel, the value that was written last. Any thread; samples of
// one channel come in order if one thread at a time writes them (dds_link.hpp).
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
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
  struct Hooks {
    // Called on a DDS thread for a reader that is matched while the writers rest: whoever owns them
    // is to call wake() soon, on another thread.
    std::function<void()> on_reader;
    // Called on a DDS thread for each reader that is matched, before that one.
    std::function<void()> on_match;
    // The last value of a channel, false if it has none. Any thread.
    std::function<bool(ChannelIndex, LastValue&)> last_value;
  };
  // Makes the writers of every channel that is read. Throws DdsError.
  // `most_bytes`: of a datagram.
  SampleWriters(Domain& domain, const std::string& bridge, const BusSpec& bus,
                std::size_t most_bytes, Hooks hooks);
  ~SampleWriters();  // dispose() unless done
  SampleWriters(const SampleWriters&) = delete;
  SampleWriters& operator=(const SampleWriters&) = delete;

  // False: they rest, and write() has no effect.
  [[nodiscard]] bool awake() const { return awake_; }
  struct Woken {
    std::size_t written = 0;
    bool all = true;  // false: call again
  };
  // Ends the rest if a reader is matched: the last value of every channel is written, at most so
  // many with each call. Others may write meanwhile.
  Woken wake(std::size_t most);

  // Samples of one channel leave in order; one that is no newer than what was written is left out.
  // False if the library did not take one of them (limits, or readers that do not acknowledge); the
  // others are written.
  bool write(std::span<const Sample> samples, const UtcMapping& mapping);

  // False if nothing changes. The last sample is written again at the new writer, so that late
  // joiners find it, before the old writer lets go of the instance. Throws DdsError if a writer is
  // needed and cannot be made.
  bool move(ChannelIndex channel, std::optional<Duration> refresh);
  [[nodiscard]] std::optional<Duration> refresh_of(ChannelIndex channel) const;

  // Removes writers whose last channel has moved away a while ago, and lets all rest whose last
  // reader has; now and then, whether samples come or not: readers go on counting the deadlines
  // that such a writer misses. Throws nothing: writers that cannot be made anew stay as they are.
  void tidy(Instant now);

  // Tells readers that every instance is gone, waits for all of them at most `linger`, and
  // deletes the writers. Instances that are left after `limit` end with their writers.
  void dispose(Duration linger, Duration limit = kInfinite);

  [[nodiscard]] DdsLink::BusCounters counters() const;

 private:
  struct Writer;
  struct Slot {
    SampleKey key;
    LastValue value;           // written last at its writer; sequence 0: none
    Writer* writer = nullptr;  // null: write-only, and not acquired so far
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
  // After the last reader has gone: one that comes and goes finds them awake.
  static constexpr Duration kRestAfter = std::chrono::seconds{10};
  // Samples that wake() writes before it lets others in: some 100 us.
  static constexpr std::size_t kWakeChunk = 8;

  // A channel that has moved is unregistered at its old writer after the same time: notes of two
  // writers may overtake each other.
  struct Leaving {
    ChannelIndex channel;
    Writer* old;
    std::optional<Instant> since;  // known from the next tidy() on
  };
  // REQUIRES, all of them: mutex_ held.
  // Those that have a writer, in the order in which they are written; see the definition.
  [[nodiscard]] std::vector<Write>& in_order(std::span<const Sample> samples);
  bool write(Slot& slot);
  void let_go(Instant now);
  Writer& writer_for(std::optional<Duration> refresh);
  dds::DataWriter* entity_for(Writer& writer);
  void tidy_up(Instant now);
  void remove_idle_writers(Instant now);
  void rest_if_unread(Instant now);
  bool make_anew();  // false: the library makes no more writers; nothing changed
  void attach(Slot& slot, std::optional<Duration> refresh);  // throws DdsError
  // Gives one without a refresh to a write-only channel that somebody acquired. False: the library
  // makes no more writers.
  bool has_writer(Slot& slot);
  [[nodiscard]] bool has_readers() const;

  Domain& domain_;
  const std::string label_;
  const std::size_t most_bytes_;
  const Hooks hooks_;
  std::atomic<bool> awake_{false};
  mutable std::mutex mutex_;  // what follows
  std::vector<Slot> slots_;
  std::vector<std::unique_ptr<Writer>> writers_;
  std::vector<Leaving> leaving_;
  std::vector<Write> order_;  // of one write(), kept for its memory
  std::uint64_t writes_ = 0;
  std::size_t unwoken_ = 0;  // the first slot that wake() has yet to look at
  bool any_idle_ = false;
  std::uint64_t retired_misses_ = 0;     // of writers that are gone
  std::optional<Instant> unread_since_;  // awake without readers; known from the next tidy() on
};

}  // namespace fieldcast
