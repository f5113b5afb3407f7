// What a bus's thread hands to the thread that writes captures: records, in a queue with a limit.
// When it is full, what comes is dropped and counted, so that the bus never waits.
//
// One thread puts, one takes and says whether records are wanted at all. No call holds the lock for
// longer than a move or a swap, and nobody is woken: who takes looks from time to time.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "core/capture/capture_record.hpp"

namespace fieldcast {

class CaptureTap {
 public:
  static constexpr std::size_t kMaxRecords = 16384;
  static constexpr std::size_t kMaxBytes = 4 << 20;

  [[nodiscard]] bool wanted() const { return wanted_.load(std::memory_order_relaxed); }
  void want(bool on) { wanted_.store(on, std::memory_order_relaxed); }

  void put(CaptureRecord record) {
    const std::size_t size = record.bytes.size() + record.text.size();
    const std::lock_guard lock(mutex_);
    if (records_.size() >= kMaxRecords || bytes_ + size > kMaxBytes) {
      ++lost_;
      return;
    }
    bytes_ += size;
    records_.push_back(std::move(record));
  }

  struct Taken {
    std::vector<CaptureRecord> records;
    std::uint64_t lost = 0;  // that should stand behind them
  };
  // Everything since the last call.
  [[nodiscard]] Taken take() {
    Taken taken;
    const std::lock_guard lock(mutex_);
    taken.records.swap(records_);
    taken.lost = std::exchange(lost_, 0);
    bytes_ = 0;
    return taken;
  }

 private:
  std::atomic<bool> wanted_ = false;
  std::mutex mutex_;
  std::vector<CaptureRecord> records_;
  std::size_t bytes_ = 0;  // of records_
  std::uint64_t lost_ = 0;
};

}  // namespace fieldcast
