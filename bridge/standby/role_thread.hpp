// Thread on which a bridge changes its role in a standby group. The other threads notify it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

#include "core/base/time.hpp"

namespace fieldcast {

class RoleThread {
 public:
  ~RoleThread() { end(); }

  // Calls `look` after each notify(), and again while it returns true. No effect if it runs.
  void start(std::function<bool()> look);
  void notify();
  // Calls `reached` now and after each notify(), until it returns true or `limit` passes; returns
  // its last value. No lock is held during the call.
  [[nodiscard]] bool wait_until(Instant limit, const std::function<bool()>& reached);
  void end();  // may be called twice

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t notified_ = 0;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace fieldcast
