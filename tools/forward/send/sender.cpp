#include "tools/forward/send/sender.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <algorithm>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast::forward {

Sender::Sender(const SendSpec& spec, Queue& queue, MessageMaker maker)
    : spec_(spec),
      queue_(queue),
      maker_(std::move(maker)),
      window_(spec.in_flight),
      rate_(spec.max_rate) {}

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
    take_results();
  } catch (const StoreError&) {}  // these records are sent again after the next start
}

void Sender::turn(Instant now) {
  take_results();
  const bool is_ready = outlet_->is_ready(now);
  {
    const std::lock_guard lock(mutex_);
    counters_.is_ready = is_ready;
  }
  if (!is_ready) return;
  load();
  send(now);
}

void Sender::load() {
  while (loaded_.size() < kMostRecords && loaded_bytes_ < kMostBytes) {
    const auto records = queue_.read(read_to_, kMostRecords / 4, kMostBytes / 4);
    if (records.empty()) return;
    for (const Record& record : records) {
      read_to_ = record.id;
      auto message = maker_.make(record);
      if (!message) {
        log_counted(LogLevel::kError, "queue", "records that cannot be decoded",
                    fmt::format("record {} of {}/{} cannot be decoded; it is removed", record.id,
                                record.bus, record.device));
        finished_.push_back(record.id);
        const std::lock_guard lock(mutex_);
        ++counters_.refused;
        continue;
      }
      window_.add(record.id, message->subject);
      loaded_bytes_ += message->payload.size();
      loaded_.emplace(record.id, Loaded{*std::move(message), record.samples});
    }
  }
}

void Sender::take_results() {
  Counters added;
  for (const OutletResult& result : outlet_->take_results()) {
    if (result.outcome == Outcome::kFailed) {
      window_.fail(result.record);
      ++added.repeated;
      continue;
    }
    if (!window_.finish(result.record)) continue;
    const auto loaded = loaded_.find(result.record);
    if (result.outcome == Outcome::kAcknowledged) {
      ++added.messages;
      added.samples += loaded->second.samples;
      added.bytes += loaded->second.message.payload.size();
    } else {
      ++added.refused;
    }
    loaded_bytes_ -= loaded->second.message.payload.size();
    loaded_.erase(loaded);
    finished_.push_back(result.record);
  }
  {
    const std::lock_guard lock(mutex_);
    counters_.messages += added.messages;
    counters_.samples += added.samples;
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
    const auto id = window_.next();
    if (!id) return;
    const OutletMessage& message = loaded_.at(*id).message;
    if (!outlet_->send(message)) {
      window_.fail(*id);
      return;
    }
    rate_.sent(message.payload.size() + message.subject.size() + message.id.size(), now);
  }
}

void Sender::wait(Instant now) {
  Duration longest = kTurn;
  if (!rate_.allows(now)) longest = std::min(longest, rate_.next() - now);
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, longest, [this] { return woken_ || stopping_; });
}

}  // namespace fieldcast::forward
