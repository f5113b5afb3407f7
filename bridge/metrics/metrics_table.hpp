// The last report of every bus and device, for the metrics. Owns immutable copies, which a snapshot
// shares: its lock is held for the copy of a pointer each, so neither side waits for the other.
// Any thread. Bounded by the buses and devices of the configuration.
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
  // Take the place of the last ones.
  void note(BusFigures figures);
  void note(DeviceFigures figures);
  // A bus that has stopped, with its devices. REQUIRES: nobody notes figures of it any more.
  void remove(std::string_view bus);

  // Puts the buses and the devices into the snapshot, in the order of their names.
  void copy_to(MetricsSnapshot& snapshot) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<const BusFigures>, std::less<>> buses_;
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const DeviceFigures>> devices_;
};

}  // namespace fieldcast
