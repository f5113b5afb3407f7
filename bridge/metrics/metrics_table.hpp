// Last report of every bus and device, for the metrics, as immutable copies that a snapshot shares:
// the lock is held only to copy pointers. Any thread. Limited by the number of buses and devices.
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
