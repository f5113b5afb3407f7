// The store of a bridge: samples, audit, alarms and device states go in from any thread without
// ever waiting; one thread of low priority writes them in batches, each a transaction. When the
// database is too slow or away, the queue becomes full. Then samples are dropped and counted, and
// the log says so: acquisition never waits for the store.
//
// Not a Worker with a BoundedQueue: samples and events have a limit each, a bus puts all samples of
// an answer under one lock, a batch gathers for a while before it is taken, and flush() waits until
// it is written.
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

#include "bridge/dds/topics/utc_mapping.hpp"
#include "bridge/store/alarm_sink.hpp"
#include "bridge/store/audit.hpp"
#include "bridge/store/records.hpp"
#include "bridge/store/sample_table.hpp"
#include "core/model/pattern.hpp"
#include "core/model/sample.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class BackOff;

struct StoreCounters {
  // Samples in committed transactions: a crash of the process does not take them back.
  std::uint64_t stored = 0;
  std::uint64_t dropped = 0;      // samples that came to a full queue, or whose batch was given up
  std::size_t waiting = 0;        // samples
  std::uint64_t quarantined = 0;  // samples and events that the database refused
};

class Store final : public Audit, public AlarmSink {
 public:
  static constexpr std::size_t kMaxWaiting = 200'000;  // samples; 10 s of 20 000 a second
  // Of audit, alarms and devices together; one more is written to the log.
  static constexpr std::size_t kMaxWaitingEvents = 4096;
  static constexpr Duration kGather = std::chrono::milliseconds{250};  // how long a batch gathers

  // The database is opened by the writer, again and again until it opens. `opened` is then called
  // once, on the writer's thread, with the alarms as the last bridge left them.
  using Opened = std::function<void(Store& store, const KeptAlarms& kept)>;
  explicit Store(const StoreSpec& spec, Opened opened = {});
  ~Store() override;  // writes what waits, if the database takes it at once
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  // The way of one bus's samples into the store: knows which of its channels are stored. The store
  // must outlive it.
  class Intake {
   public:
    // Never blocks for longer than a copy. `at`: when they were published.
    void put(std::span<const Sample> samples, const UtcMapping& mapping, UtcTime at);

   private:
    friend class Store;
    explicit Intake(Store& store) : store_(store) {}
    Store& store_;
    // By the bus's channel index: the index in Store::channels_; nothing: it is not stored.
    std::vector<std::optional<std::size_t>> channels_;
  };
  [[nodiscard]] std::unique_ptr<Intake> intake(const BusSpec& bus);

  // For samples that come with names and not from a bus of this process. The number of a channel
  // for put(), for the life of this object; its `id` is ignored, its unit and type are stored from
  // now on. Nothing: no pattern of the configuration names it, or there are kMaxChannels others.
  static constexpr std::size_t kMaxChannels = 500'000;
  [[nodiscard]] std::optional<std::int64_t> number_of(const StoredChannel& channel);
  // Rows with such numbers. Any thread; never blocks for longer than a copy.
  void put(std::span<const SampleRow> rows);

  void append(AuditEntry entry) override;
  void put(AlarmRecord alarm) override { put_event(std::move(alarm)); }
  void put(KeptAlarm alarm) override { put_event(std::move(alarm)); }
  void put(KeptMaintenance maintenance) override { put_event(std::move(maintenance)); }
  void put(AlarmEvent event) override { put_event(std::move(event)); }
  void put(DeviceRecord device) { put_event(std::move(device)); }

  [[nodiscard]] StoreCounters counters() const;
  // Waits until everything that was put before is written; false after the limit.
  [[nodiscard]] bool flush(Duration limit);

 private:
  using Event =
      std::variant<AuditEntry, AlarmRecord, KeptAlarm, KeptMaintenance, AlarmEvent, DeviceRecord>;
  struct Batch {
    // `channel` is the index in channels_ until it is written. A deque: a queue that grows never
    // moves what it holds, which a bus would have to wait for.
    std::deque<SampleRow> samples;
    std::deque<Event> events;
    std::set<std::size_t> changed;  // as changed_
    [[nodiscard]] bool empty() const { return samples.empty() && events.empty(); }
  };
  // Rows of a committed batch that the database refused: they are in the quarantine.
  struct RefusedRows {
    std::uint64_t samples = 0, events = 0;
  };
  class Writer;
  class DropReport;

  void put_event(Event event);
  // Both with mutex_ held.
  [[nodiscard]] std::optional<std::size_t> index_of(const StoredChannel& channel);
  void put_row(SampleRow row);
  void run();  // the thread
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
  // Of all buses there ever were, each once. A deque never moves what it holds.
  std::deque<StoredChannel> channels_;
  std::set<std::size_t> changed_;               // in channels_: their unit or type is not as it was
  std::map<std::string, std::size_t> indexes_;  // in channels_, by the path of the channel
  Batch waiting_;
  StoreCounters counters_;
  std::uint64_t put_ = 0;   // samples and events that were taken into the queue
  std::uint64_t seen_ = 0;  // samples and events that were written or given up
  bool ending_ = false;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace fieldcast
