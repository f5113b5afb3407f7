#include "tools/forward/send/sender.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast::forward {

Sender::Sender(const SendSpec& spec, Queue& queue)
    : spec_(spec),
      queue_(queue),
      window_(spec.in_flight),
      rate_(spec.max_rate),
      unread_after_(queue.last()) {}

void Sender::start(std::unique_ptr<Outlet> outlet) {
  outlet_ = std::move(outlet);
  thread_ = std::thread([this] {
    pthread_setname_np(pthread_self(), "sender");
    run();
  });
}

void Sender::wake() {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(woken_, true)) return;
  }
  changed_.notify_one();
}

void Sender::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
  outlet_.reset();
}

void Sender::report(SiteStatus status) {
  const std::lock_guard lock(mutex_);
  report_ = std::move(status);
}

Sender::Counters Sender::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

void Sender::run() {
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (stopping_) break;
      woken_ = false;
    }
    const Instant now = steady_now();
    try {
      turn(now);
    } catch (const StoreError& error) {
      log_counted(LogLevel::kError, "queue", "faults of the queue", error.what());
    }
    wait(now);
  }
  try {
    take_results(steady_now());
  } catch (const StoreError&) {}  // these records are sent again after the next start
}

void Sender::turn(Instant now) {
  take_results(now);
  const bool is_ready = outlet_->is_ready(now);
  bool was_ready = false;
  std::optional<SiteStatus> report;
  {
    const std::lock_guard lock(mutex_);
    counters_.turned = now;
    was_ready = std::exchange(counters_.is_ready, is_ready);
    report.swap(report_);
  }
  if (is_ready != was_ready) queue_.set_sending(is_ready);
  if (!is_ready) {
    if (was_ready) unload();
    return;
  }
  if (report) outlet_->report(*report);
  if (has_outdated(now)) unload();
  load(now);
  send(now);
  outlet_->flush();
  take_results(steady_now());
}

bool Sender::has_outdated(Instant now) const {
  if (window_.in_flight() != 0) return false;
  const auto first = std::find_if(loaded_.begin(), loaded_.end(), [](const auto& each) {
    return each.second.record.kind == RecordKind::kSamples && !each.second.record.is_late;
  });
  return first != loaded_.end() && now - first->second.loaded > spec_.late_after;
}

void Sender::unload() {
  window_.clear();
  loaded_.clear();
  memory_ = late_memory_ = {};
  late_window_ = {};
  read_to_ = 0;
  late_.clear();
  next_shift_ = {};
}

void Sender::load(Instant now) {
  shift_late(now);
  for (bool has_more = true; has_more && memory_.has_space();) {
    const Queue::Range range{read_to_, queue_.last(), unread_after_};
    has_more = range.to > range.after;
    if (has_more) read_to_ = read(range, false, now);
  }
  while (!late_.empty() && late_memory_.has_space()) {
    Queue::Range& range = late_.front();
    range.after = read(range, true, now);
    if (range.after >= range.to) late_.pop_front();
  }
}

// Returns the id of the last record that was read.
std::uint64_t Sender::read(const Queue::Range& range, bool late, Instant now) {
  Queue::Batch batch = queue_.read(range);
  unread_after_ = std::max(unread_after_, batch.read_to);
  for (Record& record : batch.records) {
    record.is_late = record.is_late || (late && record.kind == RecordKind::kSamples);
    add(std::move(record), now);
  }
  return batch.read_to;
}

// New records that became too old before they were read are left to the reader of late ones.
void Sender::shift_late(Instant now) {
  constexpr Duration kPause = std::chrono::seconds{1};
  if (now < next_shift_) return;
  next_shift_ = now + kPause;
  const UtcTime before{
      saturated_difference(read_clocks().utc.nanoseconds, spec_.late_after.count())};
  const std::uint64_t last = queue_.last_before(before, read_to_);
  if (last <= read_to_) return;
  late_.push_back({read_to_, last, unread_after_});
  read_to_ = last;
}

void Sender::add(Record record, Instant now) {
  Memory& memory = memory_of(record);
  ++memory.records;
  memory.bytes += record.body.size();
  window_.add(record.id, lane_of(record));
  const std::uint64_t id = record.id;
  loaded_.emplace(id, Loaded{std::move(record), 0, {}, now});
}

void Sender::take_results(Instant now) {
  Counters added;
  for (const OutletResult& result : outlet_->take_results()) {
    const auto loaded = loaded_.find(result.record);
    const bool is_failed = result.outcome == Outcome::kFailed;
    // Records of an earlier connection are not in flight: they are sent again.
    if (!(is_failed ? window_.fail(result.record) : window_.finish(result.record))) continue;
    const Record& record = loaded->second.record;
    const std::size_t bytes = loaded->second.bytes;
    if (record.is_late && result.outcome == Outcome::kAcknowledged) {
      late_window_.acknowledged(bytes, now - loaded->second.sent, now);
      added.late += record.samples;
    } else if (record.is_late) {
      late_window_.failed(bytes);
    }
    if (is_failed) {
      ++added.repeated;
      continue;
    }
    if (result.outcome == Outcome::kAcknowledged) {
      ++added.messages;
      added.samples += record.samples;
      added.bytes += bytes;
    } else {
      ++added.refused;
    }
    Memory& memory = memory_of(record);
    --memory.records;
    memory.bytes -= record.body.size();
    finished_.push_back(result.record);
    loaded_.erase(loaded);
  }
  {
    const std::lock_guard lock(mutex_);
    counters_.messages += added.messages;
    counters_.samples += added.samples;
    counters_.late += added.late;
    counters_.bytes += added.bytes;
    counters_.repeated += added.repeated;
    counters_.refused += added.refused;
  }
  if (finished_.empty()) return;
  queue_.remove(finished_);
  finished_.clear();
}

void Sender::send(Instant now) {
  while (rate_.allows(now)) {
    const auto id = window_.next(late_window_.allows(Queue::kMergedBytes));
    if (!id) return;
    Loaded& loaded = loaded_.at(*id);
    const auto bytes = outlet_->send(loaded.record);
    if (!bytes) {
      window_.fail(*id);
      return;
    }
    loaded.bytes = *bytes;
    loaded.sent = now;
    if (loaded.record.is_late) late_window_.sent(*bytes);
    rate_.sent(*bytes, now);
  }
}

void Sender::wait(Instant now) {
  Duration longest = kTurn;
  if (!rate_.allows(now)) longest = std::min(longest, rate_.next() - now);
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, longest, [this] { return woken_ || stopping_; });
}

}  // namespace fieldcast::forward
