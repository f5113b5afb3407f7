#include "tools/station/api/audit_note.hpp"

#include <fmt/format.h>

#include "core/base/message_text.hpp"

namespace fieldcast::web {

Reply noting(const Api& api, const Caller& caller, const char* what, const std::string& target,
             const Reply& reply) {
  if (api.audit == nullptr) return reply;
  const AuditEntry entry{.who = fmt::format("{} from {}", printable(caller.user), caller.peer),
                         .what = what,
                         .target = target,
                         .result = "done"};
  return [audit = api.audit, entry, reply](HttpResponse response) {
    if (response.status < 300) audit->append(entry);
    reply(std::move(response));
  };
}

}  // namespace fieldcast::web
