// Chooses how the thread of a bus waits for its next event: at the port if the event is close, with
// few system calls, otherwise by the io_context. Runs on the bus's io thread. Only for
// bus_runner.cpp, as it includes Asio.
#pragma once

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>

#include "bridge/base/clock.hpp"
#include "bridge/bus/runner_timing.hpp"
#include "bridge/port/port.hpp"

namespace fieldcast {

// REQUIRES: Owner has shared_from_this(), and
// - awaits_close(now): its next event is so close that the thread may wait for it at the port
// - on_timer(): handles the timer, whose time has come.
template <typename Owner>
class PortWait {
 public:
  // Distance of an event that is close.
  static constexpr Duration kClose = std::chrono::milliseconds{20};
  // After this time the io_context has its turn: its timers are late by at most twice this time.
  static constexpr Duration kLongestTurn = std::chrono::milliseconds{50};

  PortWait(boost::asio::io_context& io, Gate& gate, EngineTimer<Owner>& timer, Port& port,
           Owner& owner)
      : io_(io), gate_(gate), timer_(timer), port_(port), owner_(owner) {}

  // Call after each event.
  void next(Instant now) {
    if (active_) return;
    if (!owner_.awaits_close(now)) return leave();
    active_ = true;
    boost::asio::post(io_, [this, keep = owner_.shared_from_this()] { run(); });
  }
  // The alarm of the timer.
  void on_alarm() {
    if (!active_) timer_.at() <= steady_now() ? owner_.on_timer() : timer_.arm();
  }

 private:
  void run() {
    const Instant begun = steady_now();
    bool possible = true;
    for (Instant now = begun;
         possible && now - begun < kLongestTurn && owner_.awaits_close(now) && !gate_.any_pending();
         now = steady_now()) {
      possible = gate_.wait(
          [&](int wake) { return port_.wait(std::min(timer_.at(), now + kLongestTurn), wake); });
      if (timer_.at() <= steady_now()) owner_.on_timer();
    }
    active_ = false;
    possible ? next(steady_now()) : leave();
  }
  // From now on the io_context waits for the line and for the timer.
  void leave() {
    port_.watch();
    timer_.arm();
  }

  boost::asio::io_context& io_;
  Gate& gate_;
  EngineTimer<Owner>& timer_;
  Port& port_;
  Owner& owner_;
  bool active_ = false;
};

}  // namespace fieldcast
