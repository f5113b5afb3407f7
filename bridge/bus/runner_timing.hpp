// Timer of a bus, fast for timeouts that are replaced before they expire: an early expiry arms the
// timer again. Runs on the bus's io thread. Only for bus_runner.cpp, as it includes Asio.
#pragma once

#include <sys/eventfd.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "bridge/base/file_descriptor.hpp"
#include "core/base/time.hpp"

namespace fieldcast {

// REQUIRES: Owner has on_alarm() and shared_from_this(), and calls cancel() before it ends.
template <typename Owner>
class EngineTimer {
 public:
  EngineTimer(boost::asio::io_context& io, Owner& owner) : owner_(owner), timer_(io) {}

  // Replaces the previous time; kNever: none. The io_context does not wait for it before arm().
  void set(Instant at) { wanted_ = at; }
  [[nodiscard]] Instant at() const { return wanted_; }
  // Returns true once if the time has come.
  [[nodiscard]] bool take(Instant now) {
    if (now < wanted_) return false;
    wanted_ = kNever;
    return true;
  }
  // Calls on_alarm() at the time, or earlier.
  void arm() {
    if (wanted_ >= armed_) return;
    armed_ = wanted_;
    timer_.expires_at(std::chrono::steady_clock::time_point{armed_.time_since_epoch()});
    timer_.async_wait(
        [this, keep = owner_.shared_from_this()](boost::system::error_code cancelled) {
          if (cancelled) return;
          armed_ = kNever;
          owner_.on_alarm();
        });
  }
  void cancel() {
    wanted_ = kNever;
    timer_.cancel();
  }

 private:
  Owner& owner_;
  boost::asio::steady_timer timer_;
  Instant wanted_ = kNever;
  Instant armed_ = kNever;  // armed in the kernel
};

// Posts handlers to the io thread of a bus, and refuses them after the bus has stopped and its
// io_context no longer exists. Wakes that thread if it waits outside of its io_context. Any thread,
// except where noted. Includes Asio.
class Gate : public std::enable_shared_from_this<Gate> {
 public:
  explicit Gate(boost::asio::io_context& io) : io_(&io) {}
  // Returns false if closed; nothing was posted then.
  template <typename Handler>
  bool post(Handler&& handler) {
    const std::lock_guard lock(mutex_);
    if (!io_) return false;
    ++pending_;
    boost::asio::post(
        *io_, [self = shared_from_this(), handler = std::forward<Handler>(handler)]() mutable {
          --self->pending_;
          handler();
        });
    if (waits_.exchange(false)) (void)::eventfd_write(wake_.get(), 1);
    return true;
  }

  // Calls `wait(descriptor)`, which returns when the descriptor is readable, unless a handler is
  // pending. Only on the io thread.
  template <typename Wait>
  bool wait(Wait&& wait) {
    waits_ = true;
    const bool may_wait = pending_ == 0;
    const bool waited = !may_wait || wait(wake_.get());
    if (!waits_.exchange(false)) {  // post() woke the thread, or does it now
      const std::lock_guard lock(mutex_);
      eventfd_t ignored = 0;
      (void)::eventfd_read(wake_.get(), &ignored);
    }
    return waited;
  }
  [[nodiscard]] bool any_pending() const { return pending_ > 0; }
  void close() {
    const std::lock_guard lock(mutex_);
    io_ = nullptr;
  }

 private:
  std::mutex mutex_;
  boost::asio::io_context* io_;
  const FileDescriptor wake_{::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)};
  std::atomic<unsigned> pending_ = 0;  // posted handlers that have not begun
  std::atomic<bool> waits_ = false;
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
