#include "bridge/store/store.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "bridge/bus/back_off.hpp"
#include "bridge/bus/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/store/alarm_life_table.hpp"
#include "bridge/store/event_table.hpp"
#include "bridge/store/retention.hpp"
#include "bridge/store/tiers/tier_writer.hpp"
#include "core/base/number_text.hpp"
#include "core/model/pattern.hpp"

namespace fieldcast {
namespace {

constexpr int kNiceness = 10;           // below the threads that serve buses
constexpr unsigned kAttempts = 4;       // of one batch at an open database, before it is given up
constexpr std::ptrdiff_t kRows = 4096;  // copied at a time
constexpr Duration kIdle = std::chrono::seconds{10};
// Between two steps of tidying: others may write into the same database.
constexpr Duration kTidyPause = std::chrono::milliseconds{50};
constexpr Duration kDropLine = std::chrono::seconds{10};  // between two lines about dropped samples

std::string spelled(const AuditEntry& entry) {
  return fmt::format("{} {} {}: {} ({} bytes to the device, {} from it)", entry.who, entry.what,
                     entry.target, entry.result, entry.bytes_to_device, entry.bytes_from_device);
}
std::string spelled(const AlarmRecord& alarm) {
  return fmt::format("alarm {}/{}/{} {} {} at {}", alarm.bus, alarm.device, alarm.channel,
                     alarm.limit, alarm.state, number_text(alarm.value));
}
std::string spelled(const KeptAlarm& alarm) {
  return fmt::format("alarm {} {}", to_text(alarm.alarm), to_text(alarm.status.stage));
}
std::string spelled(const KeptMaintenance& maintenance) {
  return fmt::format("maintenance of {}/{}", maintenance.device.first, maintenance.device.second);
}
std::string spelled(const AlarmEvent& event) {
  return fmt::format("alarm {} {} by {}", to_text(event.alarm), to_text(event.kind), event.by);
}
std::string spelled(const DeviceRecord& device) {
  return fmt::format("device {}/{} {}", device.bus, device.device, device.state);
}

std::vector<Pattern> parsed(const std::vector<std::string>& texts) {
  std::vector<Pattern> patterns;
  for (const std::string& text : texts) {
    if (auto pattern = Pattern::parse(text)) patterns.push_back(*std::move(pattern));
  }
  return patterns;
}

template <class Event>
void log_unstored(const Event& event) {
  log_counted(
      LogLevel::kWarning, "store", "records not stored",
      "not stored: " + std::visit([](const auto& record) { return spelled(record); }, event));
}

}  // namespace

// Says from time to time how many samples were dropped.
class Store::DropReport {
 public:
  void tell(std::uint64_t dropped, Instant now) {
    if (dropped == told_ || now < next_) return;
    log_warning("store",
                fmt::format("{} samples were not stored: the database is too slow, away or full",
                            dropped - told_));
    told_ = dropped;
    next_ = now + kDropLine;
  }

 private:
  std::uint64_t told_ = 0;
  Instant next_ = kLongAgo;
};

// The database's side, on the writer's thread alone.
class Store::Writer {
 public:
  using Opened = std::function<void(const KeptAlarms& kept)>;
  Writer(const StoreSpec& spec, Opened opened, std::deque<StoredChannel>& channels,
         std::mutex& mutex)
      : address_(spec.address),
        opened_(std::move(opened)),
        channels_(channels),
        mutex_(mutex),
        retention_(spec) {}

  // One try: all of the batch is written, or nothing of it. Away: it cannot be opened, or it takes
  // nothing now, as its disk is full.
  enum class Try : unsigned char { kWritten, kRefused, kAway };
  [[nodiscard]] Try write(const Batch& batch) {
    try {
      open();
      write_all(batch);
      if (!told_.empty()) log_info("store", "samples are stored again: " + address_.masked());
      told_.clear();
      return Try::kWritten;
    } catch (const StoreAway& error) {
      close(error);
      return Try::kAway;
    } catch (const StoreError& error) {
      const Try failed = connection_ ? Try::kRefused : Try::kAway;
      close(error);
      return failed;
    }
  }
  // One step of the tiers and one of the retention. True: there is more to tidy.
  [[nodiscard]] bool tidy() {
    try {
      if (opened_) open();  // its caller waits for the alarms
      if (!connection_) return false;
      const UtcTime utc = read_clocks().utc;
      const bool tiering = tiers_.step(*connection_, utc);
      return retention_.step(*connection_, steady_now(), utc) || tiering;
    } catch (const StoreError& error) {
      close(error);
      return false;
    }
  }

 private:
  // Throws StoreError. Reads the alarms before anything of this run is written.
  void open() {
    if (connection_) return;
    auto connection = open_store(address_, IfMissing::kCreate);
    KeptAlarms kept;
    if (opened_) kept = AlarmLifeTable(*connection).kept(read_clocks().utc);
    connection_ = std::move(connection);
    if (told_.empty()) log_info("store", "open: " + address_.masked());
    if (const Opened opened = std::exchange(opened_, {})) opened(kept);
  }
  // Throws StoreError.
  void write_all(const Batch& batch) {
    SqlTransaction transaction(*connection_);
    for (const std::size_t channel : batch.changed)
      known_.erase(static_cast<std::int64_t>(channel));
    insert(batch.samples);
    for (const Event& event : batch.events)
      std::visit([&](const auto& record) { insert(record); }, event);
    transaction.commit();
  }
  void close(const StoreError& error) {
    if (told_ != error.what()) log_error("store", told_ = error.what());
    connection_.reset();
    tiers_.reset();
    known_.clear();  // another file may lie there now
  }
  template <class Record>
  void insert(const Record& record) {
    if constexpr (std::is_same_v<Record, AuditEntry> || std::is_same_v<Record, AlarmRecord> ||
                  std::is_same_v<Record, DeviceRecord>) {
      EventTable(*connection_).insert(record);
    } else {
      AlarmLifeTable(*connection_).insert(record);
    }
  }
  // Each sample with the database's number of its channel instead of ours.
  void insert(const std::deque<SampleRow>& samples) {
    for (auto at = samples.begin(); at != samples.end();) {
      const auto end = at + std::min<std::ptrdiff_t>(kRows, samples.end() - at);
      rows_.assign(at, end);
      at = end;
      std::erase_if(rows_, [this](SampleRow& row) {
        Known& known = known_[row.channel];
        if (known.id == 0) known = ask(static_cast<std::size_t>(row.channel));
        row.channel = known.id;
        row.is_text = known.is_text;
        return row.perhaps_stored && is_stored(row);
      });
      SampleTable(*connection_).insert(rows_);
      tiers_.note(*connection_, rows_);
    }
  }
  struct Known {
    std::int64_t id = 0;
    bool is_text = false;
  };
  Known ask(std::size_t index) {
    StoredChannel channel;
    {
      const std::lock_guard lock(mutex_);
      channel = channels_[index];
    }
    return {
        SampleTable(*connection_)
            .channel_id(channel.bus, channel.device, channel.channel, channel.unit, channel.type),
        channel.type.starts_with(to_text(ValueType::kString))};
  }
  [[nodiscard]] bool is_stored(const SampleRow& row) {
    const auto newest = SampleTable(*connection_).newest(row.channel);
    return newest && newest->is_same(row);
  }

  const StoreAddress address_;
  Opened opened_;
  std::deque<StoredChannel>& channels_;
  std::mutex& mutex_;
  std::unique_ptr<SqlConnection> connection_;
  std::map<std::int64_t, Known> known_;  // by index in channels_
  std::vector<SampleRow> rows_;
  TierWriter tiers_;
  Retention retention_;
  std::string told_;  // the last failure: it is logged once
};

Store::Store(const StoreSpec& spec, Opened opened)
    : spec_(spec),
      patterns_(parsed(spec.samples)),
      opened_(std::move(opened)),
      thread_([this] { run(); }) {}

Store::~Store() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  work_.notify_one();
  thread_.join();
}

std::optional<std::size_t> Store::index_of(const StoredChannel& channel) {
  const bool stored = std::any_of(patterns_.begin(), patterns_.end(), [&](const Pattern& pattern) {
    return pattern.matches(channel.bus, channel.device, channel.channel);
  });
  if (!stored) return std::nullopt;
  std::string path = channel.bus + '/' + channel.device + '/' + channel.channel;
  const auto known = indexes_.find(path);
  if (known == indexes_.end()) {
    if (channels_.size() >= kMaxChannels) return std::nullopt;
    indexes_.emplace(std::move(path), channels_.size());
    channels_.push_back(channel);
    return channels_.size() - 1;
  }
  StoredChannel& before = channels_[known->second];
  if (before.unit != channel.unit || before.type != channel.type) {
    before = channel;
    changed_.insert(known->second);
  }
  return known->second;
}

std::unique_ptr<Store::Intake> Store::intake(const BusSpec& bus) {
  auto made = std::unique_ptr<Intake>(new Intake(*this));
  const std::lock_guard lock(mutex_);
  for (const DeviceSpec& device : bus.devices) {
    for (const ChannelSpec& channel : device.channels) {
      made->channels_.push_back(index_of({.bus = bus.name,
                                          .device = device.name,
                                          .channel = channel.name,
                                          .unit = channel.unit,
                                          .type = std::string(to_text(channel.encoding.type))}));
    }
  }
  return made;
}

std::optional<std::int64_t> Store::number_of(const StoredChannel& channel) {
  const std::lock_guard lock(mutex_);
  const auto index = index_of(channel);
  return index ? std::optional(static_cast<std::int64_t>(*index)) : std::nullopt;
}

void Store::put_row(SampleRow row) {
  if (waiting_.samples.size() >= kMaxWaiting) {
    ++counters_.dropped;
    return;
  }
  waiting_.samples.push_back(std::move(row));
  ++put_;
}

void Store::Intake::put(std::span<const Sample> samples, const UtcMapping& mapping, UtcTime at) {
  bool wake = false;
  {
    const std::lock_guard lock(store_.mutex_);
    const bool idle = store_.waiting_.empty();
    for (const Sample& sample : samples) {
      if (const auto index = channels_.at(sample.channel))
        store_.put_row({static_cast<std::int64_t>(*index), at, mapping.to_utc(sample.acquired),
                        sample.sequence, sample.quality, sample.device_code, sample.value});
    }
    wake = idle && !store_.waiting_.empty();
  }
  if (wake) store_.work_.notify_one();
}

void Store::put(std::span<const SampleRow> rows) {
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    const bool idle = waiting_.empty();
    for (const SampleRow& row : rows) put_row(row);
    wake = idle && !waiting_.empty();
  }
  if (wake) work_.notify_one();
}

void Store::append(AuditEntry entry) {
  if (entry.at.nanoseconds == 0) entry.at = read_clocks().utc;
  put_event(std::move(entry));
}

void Store::put_event(Event event) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.events.size() < kMaxWaitingEvents) {
      waiting_.events.push_back(std::move(event));
      ++put_;
      work_.notify_one();
      return;
    }
  }
  log_unstored(event);
}

StoreCounters Store::counters() const {
  const std::lock_guard lock(mutex_);
  StoreCounters counters = counters_;
  counters.waiting = waiting_.samples.size();
  return counters;
}

bool Store::flush(Duration limit) {
  std::unique_lock lock(mutex_);
  const std::uint64_t wanted = put_;
  return done_.wait_for(lock, limit, [&] { return seen_ >= wanted; });
}

// False: the end. Else what came, after it had time to gather; possibly nothing.
bool Store::gather(Batch& batch, Duration longest) {
  std::unique_lock lock(mutex_);
  work_.wait_for(lock, longest, [this] { return ending_ || !waiting_.empty(); });
  if (!waiting_.empty() && !ending_) {
    work_.wait_for(lock, kGather, [this] { return ending_; });
  }
  std::swap(batch, waiting_);
  if (!batch.samples.empty()) batch.changed = std::exchange(changed_, {});
  return !ending_ || !batch.empty();
}

void Store::written(const Batch& batch, bool stored) {
  {
    const std::lock_guard lock(mutex_);
    (stored ? counters_.stored : counters_.dropped) += batch.samples.size();
    seen_ += batch.samples.size() + batch.events.size();
  }
  done_.notify_all();
  if (!stored) std::for_each(batch.events.begin(), batch.events.end(), log_unstored<Event>);
}

// False: the batch is given up.
bool Store::store(Writer& writer, const Batch& batch, BackOff& back_off, DropReport& drops) {
  for (unsigned refused = 0; refused < kAttempts;) {
    const Writer::Try tried = writer.write(batch);
    if (tried == Writer::Try::kWritten) {
      back_off.opened(steady_now());
      return true;
    }
    if (tried == Writer::Try::kRefused) ++refused;  // a database that is away is waited for
    drops.tell(counters().dropped, steady_now());
    std::unique_lock lock(mutex_);
    if (ending_) return false;
    work_.wait_for(lock, back_off.closed(steady_now()), [this] { return ending_; });
  }
  return false;
}

void Store::run() {
  pthread_setname_np(pthread_self(), "store");
  // Of this thread alone, on Linux.
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);
  Writer::Opened opened;
  if (opened_) opened = [this](const auto& kept) { opened_(*this, kept); };
  Writer writer(spec_, std::move(opened), channels_, mutex_);
  BackOff back_off;
  DropReport drops;
  Batch batch;
  bool tidying = writer.tidy();
  while (gather(batch, tidying ? kTidyPause : kIdle)) {
    written(batch, batch.empty() || store(writer, batch, back_off, drops));
    batch = {};
    tidying = writer.tidy();
    drops.tell(counters().dropped, steady_now());
  }
}

}  // namespace fieldcast
