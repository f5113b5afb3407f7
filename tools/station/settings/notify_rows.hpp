// The keys of the section `notify`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "config/document/map_reader.hpp"
#include "tools/station/notify/notify_spec.hpp"

namespace fieldcast::web {

inline constexpr std::size_t kMaxAddress = 254;  // bytes of a mailbox, RFC 5321

[[nodiscard]] const config::Rows<NotifySpec>& notify_rows();
[[nodiscard]] const config::Rows<MailSpec>& mail_rows();
[[nodiscard]] const config::Rows<NotifyTarget>& target_rows();
[[nodiscard]] const config::Rows<NotifyRule>& rule_rows();
[[nodiscard]] const config::Rows<Escalation>& escalation_rows();
[[nodiscard]] const config::Rows<HeartbeatSpec>& heartbeat_rows();

// Each with the prefix of its keys in the document: "notify.rules.".
[[nodiscard]] std::vector<std::pair<std::string, const config::RowTable*>> notify_tables();

}  // namespace fieldcast::web
