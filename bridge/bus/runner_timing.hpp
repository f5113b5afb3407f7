// Timer of a bus, fast for timeouts that are replaced before they expire: an early expiry arms the
// timer again. Runs on the bus's io thread. Only for bus_runner.cpp, as it includes Asio.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "core/base/time.hpp"

namespace fieldcast {

// REQUIRES: Owner has on_timer() and shared_from_this(), and calls cancel() before it ends.
template <typename Owner>
class EngineTimer {
 public:
  EngineTimer(boost::asio::io_context& io, Owner& owner) : owner_(owner), timer_(io) {}

  // Calls on_timer() once at `at`; kNever: not at all. Replaces the previous time.
  void set(Instant at) {
    wanted_ = at;
    if (wanted_ < armed_) arm();
  }
  void cancel() {
    wanted_ = kNever;
    timer_.cancel();
  }

 private:
  void arm() {
    armed_ = wanted_;
    timer_.expires_at(std::chrono::steady_clock::time_point{armed_.time_since_epoch()});
    timer_.async_wait(
        [this, keep = owner_.shared_from_this()](boost::system::error_code cancelled) {
          if (!cancelled) fire();
        });
  }
  void fire() {
    const Instant came = std::exchange(armed_, kNever);
    if (wanted_ == kNever) return;
    if (wanted_ > came) return arm();
    wanted_ = kNever;
    owner_.on_timer();
  }

  Owner& owner_;
  boost::asio::steady_timer timer_;
  Instant wanted_ = kNever;
  Instant armed_ = kNever;  // armed in the kernel
};

// Posts handlers to the io thread of a bus, and refuses them after the bus has stopped and its
// io_context no longer exists. Any thread. Includes Asio.
class Gate {
 public:
  explicit Gate(boost::asio::io_context& io) : io_(&io) {}
  // Returns false if closed; nothing was posted then.
  template <typename Handler>
  bool post(Handler&& handler) {
    const std::lock_guard lock(mutex_);
    if (io_) boost::asio::post(*io_, std::forward<Handler>(handler));
    return io_ != nullptr;
  }
  void close() {
    const std::lock_guard lock(mutex_);
    io_ = nullptr;
  }

 private:
  std::mutex mutex_;
  boost::asio::io_context* io_;
};

// Quiet time of each port after a bus has closed it: a device may still respond to the last
// request. A bus that opens the port waits for this time, so that no late response is matched to a
// new request. Any thread.
class PortQuietTime {
 public:
  // A bus closed `port` at `now`; responses may arrive until `until`. kLongAgo: none is pending.
  void left(const std::string& port, Instant until, Instant now) {
    const std::lock_guard lock(mutex_);
    std::erase_if(until_, [now](const auto& row) { return row.second < now; });
    if (until != kLongAgo) until_[port] = until;
  }
  [[nodiscard]] Instant until(const std::string& port) const {
    const std::lock_guard lock(mutex_);
    const auto found = until_.find(port);
    return found == until_.end() ? kLongAgo : found->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Instant> until_;
};

}  // namespace fieldcast
