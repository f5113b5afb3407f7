// Takes the alarms that began or ended.
#pragma once

#include "bridge/store/records.hpp"

namespace fieldcast {

class AlarmSink {
 public:
  virtual ~AlarmSink() = default;
  // Any thread; never blocks, never fails.
  virtual void put(AlarmRecord alarm) = 0;
};

}  // namespace fieldcast
