// The members of standby groups as one command hears them. Joins the domain, or those of several
// sites, with participants of its own. Any thread.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "bridge/station/standby_monitor.hpp"
#include "tools/cli/connection.hpp"
#include "tools/cli/view/standby_view.hpp"

namespace fieldcast::cli {

class StandbyWatch {
 public:
  // Throws DdsError.
  explicit StandbyWatch(const Connection& connection);

  [[nodiscard]] StandbyModel model();
  // Until the condition holds, which is looked at again and again. False: not before `end`, or not
  // before `give_up` said so.
  [[nodiscard]] bool until(const std::function<bool(const StandbyModel&)>& condition, Instant end,
                           const std::function<bool()>& give_up);
  // In each site. False: no bridge heard it within the limit.
  [[nodiscard]] bool request(const StandbyRequest& wanted, Duration limit);

 private:
  void learn(const StandbyMessage& message);

  std::mutex mutex_;
  std::condition_variable changed_;
  StandbyModel model_;
  std::vector<std::unique_ptr<StandbyMonitor>> sites_;  // last: they call learn()
};

}  // namespace fieldcast::cli
