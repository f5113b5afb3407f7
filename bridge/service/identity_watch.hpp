// Says in the log what is wrong with the identity of this program in DDS Security, or will be soon:
// at its start, and once a day. Main thread.
#pragma once

#include "bridge/bus/clock.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

class IdentityWatch {
 public:
  explicit IdentityWatch(bool is_bridge) : is_bridge_(is_bridge) {}

  // False: the others would not let it in. No effect without security, or within a day.
  bool look(const DdsSpec& spec, const UtcMapping& now);

 private:
  const bool is_bridge_;
  Instant next_ = kLongAgo;
};

}  // namespace fieldcast
