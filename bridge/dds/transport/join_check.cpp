#include "bridge/dds/transport/join_check.hpp"

#include <fmt/format.h>

#include "bridge/dds/transport/discovery_server.hpp"
#include "bridge/security/authority.hpp"
#include "bridge/security/member_folder.hpp"

namespace fieldcast {

std::string to_text(const JoinRemark& remark) { return remark.of + ": " + remark.text; }

JoinCheck check_joining(const DdsSpec& spec, const std::string& bridge, UtcTime now) {
  JoinCheck check;
  if (const auto fault = server_fault(spec)) check.faults.push_back({"dds", *fault, "interfaces"});
  if (!spec.security) return check;
  if (spec.domain > security::kHighestDomain) {
    check.faults.push_back({"dds",
                            fmt::format("security in domain {}: it is for 0 to {}", spec.domain,
                                        security::kHighestDomain),
                            "domain"});
  }
  if (!spec.discovery_servers.empty()) {
    check.faults.push_back({"dds",
                            "security with a discovery server: Fast DDS 2.9 ends the program with "
                            "it; members find each other by multicast",
                            "security"});
  }
  const security::MemberCheck identity =
      security::check_program(*spec.security, !bridge.empty(), now);
  for (const std::string& line : identity.faults)
    check.faults.push_back({"security", line, "security"});
  for (const std::string& line : identity.warnings)
    check.warnings.push_back({"security", line, "security"});
  const auto member = security::read_member(*spec.security);
  if (member && member->role == security::MemberRole::kBridge && !bridge.empty() &&
      member->name != bridge) {
    check.faults.push_back(
        {"security",
         fmt::format("{} is the identity of bridge {}, and this bridge is named {}: others would "
                     "ignore its claims on buses; name it {}, or fieldcast secure add bridge NAME",
                     *spec.security, member->name, bridge, member->name),
         "security"});
  }
  return check;
}

}  // namespace fieldcast
