// Says in the log what is wrong with the identity of this program in DDS Security, or will be soon,
// while it runs: once a day, and when its certificate ends. Main thread.
#pragma once

#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

// Whether it is time to look again: a day went by, the clock was set back, or a certificate with
// this end has ended since. Pure.
[[nodiscard]] bool is_look_due(std::optional<UtcTime> not_after, UtcTime last, UtcTime now);

class IdentityWatch {
 public:
  explicit IdentityWatch(bool is_bridge) : is_bridge_(is_bridge) {}

  // The program has joined, or joined anew, with what its folder holds now.
  void joined(const DdsSpec& spec, UtcTime now);
  // No effect without security, or before it is time.
  void look(UtcTime now);

 private:
  const bool is_bridge_;
  std::optional<std::string> folder_;
  std::optional<UtcTime> not_after_;  // of the certificate that is in use
  UtcTime last_;
};

}  // namespace fieldcast
