// Bounded queue of records from a bus's thread to the thread that writes captures, which polls it
// and switches recording. When full, new records are dropped and counted: the bus never waits. The
// lock is held only for a move or a swap.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "core/capture/capture_record.hpp"
#include "core/model/bus_spec.hpp"

namespace fieldcast {

class CaptureTap {
 public:
  static constexpr std::size_t kMaxRecords = 16384;
  static constexpr std::size_t kMaxBytes = 4 << 20;

  enum class Wanted : std::uint8_t { kNothing, kSessions, kEverything };
  void want(Wanted what) { wanted_.store(what, std::memory_order_relaxed); }
  // The bytes of programming sessions are also wanted without the rest.
  [[nodiscard]] bool wanted() const { return load() == Wanted::kEverything; }
  [[nodiscard]] bool sessions_wanted() const { return load() != Wanted::kNothing; }

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
  [[nodiscard]] Wanted load() const { return wanted_.load(std::memory_order_relaxed); }

  std::atomic<Wanted> wanted_ = Wanted::kNothing;
  std::mutex mutex_;
  std::vector<CaptureRecord> records_;
  std::size_t bytes_ = 0;
  std::uint64_t lost_ = 0;
};

// Capture of one bus: joins the records of its tap to frames and passes each as a pcapng block to
// every sink. Owned by the capture service, on its thread. A sink must live until it is removed.

// Receives the blocks of one capture on the service's thread; must not block.
class CaptureSink {
 public:
  virtual ~CaptureSink() = default;
  // `session`: of a programming session.
  virtual void packet(ByteView block, UtcTime at, bool session) = 0;
  virtual void lost(std::uint64_t records) = 0;
  // Whether it drops other packets.
  [[nodiscard]] virtual bool only_sessions() const { return false; }
};

class BusCapture {
 public:
  // `by`: the program that polls the bus, for the head of each file: "bridge press-shop".
  BusCapture(const BusSpec& bus, const std::string& by, std::shared_ptr<CaptureTap> tap);

  void add(CaptureSink& sink);
  void remove(CaptureSink& sink);
  [[nodiscard]] bool busy() const { return !sinks_.empty(); }

  // First blocks of every file and every stream.
  [[nodiscard]] Bytes head(const std::string& remark = {}) const;
  void drain(UtcTime now);
  // As drain(), and also passes on incomplete frames.
  void finish(UtcTime now);

 private:
  struct Dissector {
    std::string name, column;
  };
  void give(std::vector<CapturedFrame>& frames);
  void tell_tap();

  const std::string bus_, about_;
  std::vector<Dissector> dissectors_;
  const std::shared_ptr<CaptureTap> tap_;
  FrameGatherer gatherer_;
  std::vector<CaptureSink*> sinks_;
};

// Counts in the last block of a capture: frames, and records that the bus dropped.
struct CaptureCounts {
  UtcTime begun, ended;
  std::uint64_t frames = 0, dropped = 0;
};
[[nodiscard]] Bytes capture_tail(const CaptureCounts& counts, const std::string& why = {});

}  // namespace fieldcast
