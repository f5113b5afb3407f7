// Receives the begin and end of alarms, and actions of users on alarms.
#pragma once

#include "bridge/store/records/records.hpp"

namespace fieldcast {

class AlarmSink {
 public:
  virtual ~AlarmSink() = default;
  // Any thread; never blocks, never fails.
  virtual void put(AlarmRecord alarm) = 0;
  virtual void put(KeptAlarm alarm) = 0;
  virtual void put(KeptMaintenance maintenance) = 0;
  virtual void put(AlarmEvent event) = 0;
};

}  // namespace fieldcast
