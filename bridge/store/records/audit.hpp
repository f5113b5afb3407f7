// Records every transmission, command and login.
#pragma once

#include "bridge/store/records/records.hpp"

namespace fieldcast {

class Audit {
 public:
  virtual ~Audit() = default;
  // Any thread; never blocks, never fails. If the queue is full, the complete entry is written to
  // the log instead. An entry without a time (at == 0) gets the present one.
  virtual void append(AuditEntry entry) = 0;
};

}  // namespace fieldcast
