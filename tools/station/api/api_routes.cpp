#include "tools/station/api/api_routes.hpp"

#include "tools/station/api/alarms.hpp"
#include "tools/station/api/audit.hpp"
#include "tools/station/api/base/openapi.hpp"
#include "tools/station/api/channels.hpp"
#include "tools/station/api/commands.hpp"
#include "tools/station/api/export.hpp"
#include "tools/station/api/history.hpp"
#include "tools/station/api/plan.hpp"

namespace fieldcast::web {

void add_routes(RouteTable& routes, const ApiNeeds& needs) {
  add_alarm_routes(routes, needs.model, needs.database, needs.now);
  add_audit_routes(routes, needs.database, needs.now);
  add_channel_routes(routes, needs.model);
  add_command_routes(routes, needs.model, needs.commands);
  add_export_routes(routes, needs.database, needs.now);
  add_history_routes(routes, needs.database, needs.now);
  add_metrics_routes(routes, needs.database, needs.store, needs.recorder, needs.metrics);
  add_openapi_routes(routes);
  add_plan_routes(routes, needs.model);
  add_user_routes(routes, needs.database);
}

}  // namespace fieldcast::web
