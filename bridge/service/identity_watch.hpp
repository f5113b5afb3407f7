// Logs present and coming faults of this program's DDS Security identity while it runs: once a day,
// and when its certificate expires. Main thread.
#pragma once

#include <optional>
#include <string>

#include "core/base/time.hpp"
#include "core/model/dds_spec.hpp"

namespace fieldcast {

// Returns true if a day has passed, the clock was set back, or a certificate with this end has
// expired since `last`. Pure.
[[nodiscard]] bool is_look_due(std::optional<UtcTime> not_after, UtcTime last, UtcTime now);

class IdentityWatch {
 public:
  explicit IdentityWatch(bool is_bridge) : is_bridge_(is_bridge) {}

  // The program has joined or rejoined with the present contents of its folder.
  void joined(const DdsSpec& spec, UtcTime now);
  // No effect without security, or before is_look_due().
  void look(UtcTime now);

 private:
  const bool is_bridge_;
  std::optional<std::string> folder_;
  std::optional<UtcTime> not_after_;  // of the certificate in use
  UtcTime last_;
};

}  // namespace fieldcast
