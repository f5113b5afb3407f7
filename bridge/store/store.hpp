// The store of a bridge. Any thread queues samples, audit, alarms and device states without a wait;
// one thread of low priority writes them in batches, one transaction each. At a full queue, samples
// are dropped, counted and logged: acquisition never waits. Not a Worker with a BoundedQueue:
// samples and events have separate limits, a bus puts a response under one lock, and flush() waits
// until it is written.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <variant>
#include <vector>

#include "bridge/store/records/records.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "core/base/time.hpp"
#include "core/model/bus_spec.hpp"
#include "core/model/channel_pattern.hpp"
#include "core/model/sample.hpp"
#include "core/model/store_spec.hpp"

namespace fieldcast {

class BackOff;

struct StoreCounters {
  // Samples in committed transactions; a crash of the process does not lose them.
  std::uint64_t stored = 0;
  std::uint64_t dropped = 0;  // samples that met a full queue, or whose batch was given up
  std::size_t waiting = 0;
  std::uint64_t quarantined = 0;  // samples and events that the database refused
};

class Store final : public Audit, public AlarmSink {
 public:
  static constexpr std::size_t kMaxWaiting = 200'000;  // samples; 10 s of 20 000 a second
  // Audit, alarms and devices together; more are written to the log.
  static constexpr std::size_t kMaxWaitingEvents = 4096;
  static constexpr Duration kGather = std::chrono::milliseconds{250};  // how long a batch collects

  // The writer opens the database, with retries, then calls `opened` once with the previous alarms.
  using Opened = std::function<void(Store& store, const KeptAlarms& kept)>;
  explicit Store(const StoreSpec& spec, Opened opened = {});
  ~Store() override;  // writes the waiting records if the database is available
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  // Puts the samples of one bus into the store, which must outlive it.
  class Intake {
   public:
    // Never blocks for longer than a copy. `at`: time of publication.
    void put(std::span<const Sample> samples, const UtcMapping& mapping, UtcTime at);

   private:
    friend class Store;
    explicit Intake(Store& store) : store_(store) {}
    Store& store_;
    // Index in Store::channels_ by the bus's channel index; `std::nullopt`: not stored.
    std::vector<std::optional<std::size_t>> channels_;
  };
  [[nodiscard]] std::unique_ptr<Intake> intake(const BusSpec& bus);

  // For names that are not of a bus of this process. Returns the channel's number for put(), valid
  // as long as this object; empty if no pattern matches, or there are kMaxChannels already. Ignores
  // `id`.
  static constexpr std::size_t kMaxChannels = 500'000;
  [[nodiscard]] std::optional<std::int64_t> number_of(const StoredChannel& channel);
  // Puts rows with such numbers. Any thread; never blocks for longer than a copy.
  void put(std::span<const SampleRow> rows);

  void append(AuditEntry entry) override;
  void put(AlarmRecord alarm) override { put_event(std::move(alarm)); }
  void put(KeptAlarm alarm) override { put_event(std::move(alarm)); }
  void put(KeptMaintenance maintenance) override { put_event(std::move(maintenance)); }
  void put(AlarmEvent event) override { put_event(std::move(event)); }
  void put(DeviceRecord device) { put_event(std::move(device)); }
  void put(BusEpoch epoch) { put_event(std::move(epoch)); }

  [[nodiscard]] StoreCounters counters() const;
  // Waits until all earlier records are written. Returns false after the limit.
  [[nodiscard]] bool flush(Duration limit);

 private:
  using Event = std::variant<AuditEntry, AlarmRecord, KeptAlarm, KeptMaintenance, AlarmEvent,
                             DeviceRecord, BusEpoch>;
  struct Batch {
    // `channel` is the index in channels_ until the row is written. A deque does not move its
    // elements when it grows, so a bus never waits for that.
    std::deque<SampleRow> samples;
    std::deque<Event> events;
    std::set<std::size_t> changed;  // as changed_
    [[nodiscard]] bool empty() const { return samples.empty() && events.empty(); }
  };
  // Rows of a committed batch that the database refused; they are in the quarantine.
  struct RefusedRows {
    std::uint64_t samples = 0, events = 0;
  };
  class Writer;
  class DropReport;

  void put_event(Event event);
  // Both REQUIRE: mutex_ held.
  [[nodiscard]] std::optional<std::size_t> index_of(const StoredChannel& channel);
  void put_row(SampleRow row);
  void run();
  [[nodiscard]] bool store(Writer& writer, const Batch& batch, BackOff& back_off,
                           DropReport& drops);
  [[nodiscard]] bool gather(Batch& batch, Duration longest);
  void written(const Batch& batch, const RefusedRows* refused);

  const StoreSpec spec_;
  const std::vector<Pattern> patterns_;
  const Opened opened_;
  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable done_;
  // Channels of all buses since the start, each once. A deque does not move its elements.
  std::deque<StoredChannel> channels_;
  std::set<std::size_t> changed_;  // indexes in channels_ whose unit or type has changed
  std::map<std::string, std::size_t> indexes_;  // index in channels_ by channel path
  Batch waiting_;
  StoreCounters counters_;
  std::uint64_t put_ = 0;   // queued samples and events
  std::uint64_t seen_ = 0;  // samples and events that were written or given up
  bool ending_ = false;
  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast
