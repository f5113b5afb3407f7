#include "tools/station/routes.hpp"

#include "tools/station/api/audit.hpp"
#include "tools/station/api/channels.hpp"
#include "tools/station/api/commands.hpp"
#include "tools/station/api/export.hpp"
#include "tools/station/api/history.hpp"
#include "tools/station/api/plan.hpp"

namespace fieldcast::web {

void add_api_routes(RouteTable& routes, const RouteNeeds& needs) {
  add_audit_routes(routes, needs.database, needs.now);
  add_channel_routes(routes, needs.domain.model());
  add_command_routes(routes, needs.domain.model(), needs.domain.commands());
  add_export_routes(routes, needs.database, needs.now);
  add_history_routes(routes, needs.database, needs.now);
  add_plan_routes(routes, needs.domain.model());
  add_user_routes(routes, needs.database);
}

}  // namespace fieldcast::web
