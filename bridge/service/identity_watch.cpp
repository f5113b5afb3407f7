#include "bridge/service/identity_watch.hpp"

#include "bridge/log/log.hpp"
#include "bridge/security/authority.hpp"

namespace fieldcast {

bool IdentityWatch::look(const DdsSpec& spec, const UtcMapping& now) {
  if (!spec.security || now.instant < next_) return true;
  next_ = now.instant + security::kDay;
  const security::MemberCheck check = security::check_program(*spec.security, is_bridge_, now.utc);
  for (const std::string& line : check.faults) log_error("security", line);
  for (const std::string& line : check.warnings) log_warning("security", line);
  return check.faults.empty();
}

}  // namespace fieldcast
