// Sends the records of the queue by an outlet, on its own thread. A record leaves the queue only
// after its acknowledgement; without one it is sent again, also after a restart.
//
// Two readers follow the queue. One reads new records. The second one reads the records that were
// already too old when the outlet became ready, or that the outlet was too slow for: they are sent
// as late, merged into larger messages, and only while no new record can be sent.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "tools/forward/outlet/outlet.hpp"
#include "tools/forward/queue/queue.hpp"
#include "tools/forward/send/late_window.hpp"
#include "tools/forward/send/rate_limit.hpp"
#include "tools/forward/send/send_window.hpp"

namespace fieldcast::forward {

struct SendSpec {
  std::uint32_t in_flight = 256;                   // messages
  std::uint64_t max_rate = 0;                      // bytes of messages a second; 0: no limit
  Duration late_after = std::chrono::seconds{10};  // older samples are late
  friend bool operator==(const SendSpec&, const SendSpec&) = default;
};

class Sender {
 public:
  // Borrows the queue. Begins with start().
  Sender(const SendSpec& spec, Queue& queue);
  ~Sender() { stop(); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  // `outlet` may call wake() from its threads.
  void start(std::unique_ptr<Outlet> outlet);
  // Records were appended, or the outlet has results. Any thread.
  void wake();
  // Passes the state of the site to the outlet in the next turn. Any thread.
  void report(SiteStatus status);
  // Ends the thread and closes the outlet.
  void stop();

  struct Counters {
    bool is_ready = false;                               // the outlet is connected
    Instant turned{};                                    // last turn of the thread
    std::uint64_t messages = 0, samples = 0, bytes = 0;  // acknowledged; bytes of messages
    std::uint64_t late = 0;                              // acknowledged samples that were late
    std::uint64_t repeated = 0;                          // messages that were sent again
    // Records that were removed: they cannot be decoded, or the engine refuses them.
    std::uint64_t refused = 0;
  };
  [[nodiscard]] Counters counters() const;  // any thread

 private:
  // Records in memory, of each reader.
  static constexpr std::size_t kMostRecords = 1024;
  static constexpr std::size_t kMostBytes = 8u << 20;
  // Longest wait of the thread, and the pause after a fault of the outlet or the queue.
  static constexpr Duration kTurn = std::chrono::milliseconds{500};

  struct Loaded {
    Record record;
    std::size_t bytes = 0;  // of its message, while it is in flight
    Instant sent{}, loaded{};
  };
  struct Memory {
    std::size_t records = 0, bytes = 0;
    [[nodiscard]] bool has_space() const { return records < kMostRecords && bytes < kMostBytes; }
  };

  void run();
  void turn(Instant now);
  // Forgets what was read: the queue is read again when the outlet is ready.
  void unload();
  void load(Instant now);
  std::uint64_t read(const Queue::Range& range, bool late, Instant now);
  void shift_late(Instant now);
  void add(Record record, Instant now);
  // New records in memory that became too old, because the outlet accepted none for a time.
  [[nodiscard]] bool has_outdated(Instant now) const;
  void take_results(Instant now);
  void send(Instant now);
  void wait(Instant now);
  Memory& memory_of(const Record& record) { return record.is_late ? late_memory_ : memory_; }

  const SendSpec spec_;
  Queue& queue_;
  std::unique_ptr<Outlet> outlet_;
  SendWindow window_;
  LateWindow late_window_;
  RateLimit rate_;
  std::map<std::uint64_t, Loaded> loaded_;
  Memory memory_, late_memory_;
  std::uint64_t read_to_ = 0;      // new records up to this id were read, or are late
  std::uint64_t unread_after_;     // no record after this id was read
  std::deque<Queue::Range> late_;  // not read yet
  Instant next_shift_{};
  std::vector<std::uint64_t> finished_;  // acknowledged or refused, still in the queue

  mutable std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  bool woken_ = false, stopping_ = false;
  std::optional<SiteStatus> report_;
  Counters counters_;

  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast::forward
