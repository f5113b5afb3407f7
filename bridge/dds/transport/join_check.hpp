// Checks the DDS configuration of a program before it joins its domain: its identity and settings
// that Fast DDS cannot handle. Used by --check, the start and a reload. Any thread.
#pragma once

#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/dds_spec.hpp"

namespace fieldcast {

struct JoinRemark {
  std::string of;    // "security" or "dds"
  std::string text;  // human-readable, with the remedy
  std::string key;   // of `dds:` in the configuration, to which the remark belongs
};
[[nodiscard]] std::string to_text(const JoinRemark& remark);

struct JoinCheck {
  std::vector<JoinRemark> faults;    // the program cannot join, or other members will refuse it
  std::vector<JoinRemark> warnings;  // other members will soon refuse it
};
// `bridge` is the name of the bridge; empty for other programs. A bridge needs the identity of a
// bridge of its name, because other bridges ignore its claims on buses otherwise
// (bridge_announcement.hpp). All other programs need an identity of another role.
[[nodiscard]] JoinCheck check_joining(const DdsSpec& spec, const std::string& bridge, UtcTime now);

}  // namespace fieldcast
