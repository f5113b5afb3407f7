// Where every transmission, command and login is noted.
#pragma once

#include "bridge/store/records.hpp"

namespace fieldcast {

class Audit {
 public:
  virtual ~Audit() = default;
  // Any thread; never blocks, never fails. An entry that finds no room is written to the log
  // instead, whole. An entry without a time (at == 0) gets the present one.
  virtual void append(AuditEntry entry) = 0;
};

}  // namespace fieldcast
