// Receives standby messages in all domains of the connection, with its own participants.
// Thread-safe.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "bridge/station/standby_monitor.hpp"
#include "tools/cli/domain/connection.hpp"
#include "tools/cli/view/status/standby_view.hpp"

namespace fieldcast::cli {

class StandbyWatch {
 public:
  // Throws DdsError.
  explicit StandbyWatch(const Connection& connection);

  [[nodiscard]] StandbyModel model();
  // Returns false after `end`, or when `give_up` returns true.
  [[nodiscard]] bool until(const std::function<bool(const StandbyModel&)>& condition, Instant end,
                           const std::function<bool()>& give_up);
  // Returns false if no bridge received the request within the limit.
  [[nodiscard]] bool request(const StandbyRequest& wanted, Duration limit);

 private:
  void learn(const StandbyMessage& message);

  std::mutex mutex_;
  std::condition_variable changed_;
  StandbyModel model_;
  std::vector<std::unique_ptr<StandbyMonitor>> sites_;  // last member: its callbacks call learn()
};

}  // namespace fieldcast::cli
