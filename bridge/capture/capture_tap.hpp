// Bounded queue of records from a bus's thread to the thread that writes captures. When it is full,
// new records are dropped and counted, so that the bus never waits.
//
// One thread puts. A second thread takes, and switches recording on and off. The lock is held only
// for a move or a swap. The second thread is not woken; it polls.
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
    std::uint64_t lost = 0;  // records dropped after the last one
  };
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
  std::size_t bytes_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace fieldcast
