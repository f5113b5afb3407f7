// Publishes the records of the queue by an outlet, on its own thread. A record leaves the queue
// only after its acknowledgement; without one it is sent again, also after a restart.
#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "tools/forward/outlet/outlet.hpp"
#include "tools/forward/queue/queue.hpp"
#include "tools/forward/send/message_maker.hpp"
#include "tools/forward/send/rate_limit.hpp"
#include "tools/forward/send/send_window.hpp"

namespace fieldcast::forward {

struct SendSpec {
  std::uint32_t in_flight = 256;  // messages
  std::uint64_t max_rate = 0;     // bytes of payload a second; 0: no limit
  friend bool operator==(const SendSpec&, const SendSpec&) = default;
};

class Sender {
 public:
  // Borrows the queue. Begins with start().
  Sender(const SendSpec& spec, Queue& queue, MessageMaker maker);
  ~Sender() { stop(); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  // `outlet` may call wake() from its threads.
  void start(std::unique_ptr<Outlet> outlet);
  // Records were appended, or the outlet has results. Any thread.
  void wake();
  // Ends the thread and closes the outlet.
  void stop();

  struct Counters {
    bool is_ready = false;                               // the outlet is connected
    std::uint64_t messages = 0, samples = 0, bytes = 0;  // acknowledged; bytes of payload
    std::uint64_t repeated = 0;                          // messages that were sent again
    // Records that were removed: they cannot be decoded, or the engine refuses them.
    std::uint64_t refused = 0;
  };
  [[nodiscard]] Counters counters() const;  // any thread

 private:
  // Records in memory.
  static constexpr std::size_t kMostRecords = 2048;
  static constexpr std::size_t kMostBytes = 16u << 20;
  // Longest wait of the thread, and the pause after a fault of the outlet or the queue.
  static constexpr Duration kTurn = std::chrono::milliseconds{500};

  struct Loaded {
    OutletMessage message;
    std::uint32_t samples = 0;
  };

  void run();
  void turn(Instant now);
  void load();
  void take_results();
  void send(Instant now);
  void wait(Instant now);

  const SendSpec spec_;
  Queue& queue_;
  MessageMaker maker_;
  std::unique_ptr<Outlet> outlet_;
  SendWindow window_;
  RateLimit rate_;
  std::map<std::uint64_t, Loaded> loaded_;
  std::size_t loaded_bytes_ = 0;
  std::uint64_t read_to_ = 0;            // records up to this id were loaded
  std::vector<std::uint64_t> finished_;  // acknowledged or refused, still in the queue

  mutable std::mutex mutex_;  // protects the members below
  std::condition_variable changed_;
  bool woken_ = false, stopping_ = false;
  Counters counters_;

  std::thread thread_;  // last: it uses the members above
};

}  // namespace fieldcast::forward
