#include "bridge/store/store.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "bridge/base/back_off.hpp"
#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/store/quarantine.hpp"
#include "bridge/store/store_writer.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast {
namespace {

constexpr int kNiceness = 10;      // lower priority than the threads of buses
constexpr unsigned kAttempts = 4;  // for one batch at an open database
constexpr Duration kIdle = std::chrono::seconds{10};
// Pause between two cleanup steps: others may write to the same database.
constexpr Duration kTidyPause = std::chrono::milliseconds{50};
constexpr Duration kDropLine = std::chrono::seconds{10};

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
      "not stored: " + std::visit([](const auto& record) { return log_text(record); }, event));
}

}  // namespace

// Logs periodically how many samples were dropped.
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

// Waits for records, then collects for kGather. The batch may be empty. Returns false at the end.
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

// `refused` is null if the batch was given up.
void Store::written(const Batch& batch, const RefusedRows* refused) {
  {
    const std::lock_guard lock(mutex_);
    if (refused == nullptr) {
      counters_.dropped += batch.samples.size();
    } else {
      counters_.stored += batch.samples.size() - refused->samples;
      counters_.quarantined += refused->samples + refused->events;
    }
    seen_ += batch.samples.size() + batch.events.size();
  }
  done_.notify_all();
  if (refused == nullptr)
    std::for_each(batch.events.begin(), batch.events.end(), log_unstored<Event>);
}

// Returns false if the batch was given up.
bool Store::store(Writer& writer, const Batch& batch, BackOff& back_off, DropReport& drops) {
  for (unsigned refused = 0; refused < kAttempts;) {
    const Writer::Try tried = writer.write(batch);
    if (tried == Writer::Try::kWritten) {
      back_off.opened(steady_now());
      return true;
    }
    // Without a limit while the database is not available.
    if (tried == Writer::Try::kRefused) ++refused;
    drops.tell(counters().dropped, steady_now());
    std::unique_lock lock(mutex_);
    if (ending_) return false;
    work_.wait_for(lock, back_off.closed(steady_now()), [this] { return ending_; });
  }
  return false;
}

void Store::run() {
  pthread_setname_np(pthread_self(), "store");
  // On Linux, this applies only to this thread.
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);
  Writer::Opened opened;
  if (opened_) opened = [this](const auto& kept) { opened_(*this, kept); };
  Writer writer(spec_, std::move(opened), channels_, mutex_);
  BackOff back_off;
  DropReport drops;
  Batch batch;
  bool tidying = writer.tidy();
  while (gather(batch, tidying ? kTidyPause : kIdle)) {
    if (!batch.empty()) {
      const bool stored = store(writer, batch, back_off, drops);
      written(batch, stored ? &writer.refused() : nullptr);
    }
    batch = {};
    tidying = writer.tidy();
    drops.tell(counters().dropped, steady_now());
  }
}

}  // namespace fieldcast
