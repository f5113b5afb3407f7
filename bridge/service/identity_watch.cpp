#include "bridge/service/identity_watch.hpp"

#include <fmt/format.h>

#include "bridge/log/log.hpp"
#include "bridge/security/authority.hpp"

namespace fieldcast {

bool is_look_due(std::optional<UtcTime> not_after, UtcTime last, UtcTime now) {
  if (now < last || now.nanoseconds - last.nanoseconds >= security::kDay.count()) return true;
  return not_after && last < *not_after && *not_after <= now;
}

void IdentityWatch::joined(const DdsSpec& spec, UtcTime now) {
  folder_ = spec.security;
  not_after_ = folder_ ? security::end_of_member(*folder_) : std::nullopt;
  last_ = now;
}

void IdentityWatch::look(UtcTime now) {
  if (!folder_ || !is_look_due(not_after_, last_, now)) return;
  last_ = now;
  const security::MemberCheck check = security::check_program(*folder_, is_bridge_, now);
  for (const std::string& line : check.faults) log_error("security", line);
  for (const std::string& line : check.warnings) log_warning("security", line);
  if (!not_after_ || now < *not_after_) return;
  log_error("security",
            fmt::format("the certificate with which this program joined ended on {}: nobody who "
                        "joins from then on finds it; {} {}",
                        security::date_text(*not_after_),
                        check.faults.empty() ? "it is renewed, and" : "once it is renewed",
                        is_bridge_ ? "a reload (SIGHUP) takes it up" : "start this program again"));
}

}  // namespace fieldcast
