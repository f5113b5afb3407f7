// The last report of every bus and device, for the metrics. Stores immutable copies that a snapshot
// shares, so the lock is held only to copy pointers. Any thread. Its size is limited by the number
// of configured buses and devices.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "bridge/metrics/metrics_snapshot.hpp"

namespace fieldcast {

class MetricsTable {
 public:
  void note(BusFigures figures);
  void note(DeviceFigures figures);
  // Removes a stopped bus and its devices. REQUIRES: no note() of this bus follows.
  void remove(std::string_view bus);

  // Adds the buses and devices to the snapshot, sorted by name.
  void copy_to(MetricsSnapshot& snapshot) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const BusFigures>, std::less<>> buses_;
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const DeviceFigures>> devices_;
};

}  // namespace fieldcast
