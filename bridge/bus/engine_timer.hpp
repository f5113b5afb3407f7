// Timer of a bus, optimized for timeouts, most of which are replaced before they expire. Setting a
// later time than the one armed in the kernel is free: the early expiry arms the timer again. Runs
// on the bus's io thread. Includes Asio; only for bus_runner.cpp.
#pragma once

#include <boost/asio/steady_timer.hpp>

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

}  // namespace fieldcast
