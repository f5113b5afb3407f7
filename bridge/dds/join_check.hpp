// What is wrong, or will be soon, with the configuration by which a program joins its domain, as
// far as it is seen before it joins: its identity, and what the library does not stand. For
// --check, the start and a reload. Any thread.
#pragma once

#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/spec.hpp"

namespace fieldcast {

struct JoinRemark {
  std::string of;    // "security" or "dds"
  std::string text;  // human-readable, with the remedy
  std::string key;   // of `dds:` in the configuration, to which it belongs
};
[[nodiscard]] std::string to_text(const JoinRemark& remark);  // "security: .."

struct JoinCheck {
  std::vector<JoinRemark> faults;    // it cannot join, or will not be let in
  std::vector<JoinRemark> warnings;  // it will soon not be let in
};
// `bridge`: the name of the bridge; empty for other programs. A bridge needs the identity of a
// bridge of its name, since others ignore its claims on buses without it (bridge_presence.hpp). All
// other programs need another identity.
[[nodiscard]] JoinCheck check_joining(const DdsSpec& spec, const std::string& bridge, UtcTime now);

}  // namespace fieldcast
