#include "tools/station/api/plan.hpp"

#include "core/base/json.hpp"
#include "tools/station/api/base/parameters.hpp"
#include "tools/station/api/base/response.hpp"
#include "tools/station/model/live_json.hpp"

namespace fieldcast::web {

void add_plan_routes(RouteTable& table, const LiveModel& model) {
  const auto handler = [&model](const HttpRequest& request, const Caller&, const Reply& reply) {
    if (auto fault = Parameters(request, {"bus"}).fault()) return reply(*std::move(fault));
    const auto bus = request.parameter("bus");
    if (!bus) {
      const auto append = [](std::string& out, const StationReadPlan* plan) {
        out += read_plan_json(*plan);
      };
      return reply(json_response(json_array(model.objects().all<StationReadPlan>(), append),
                                 request.accepts_gzip));
    }
    if (const StationReadPlan* plan = model.objects().read_plan(*bus))
      return reply(json_response(read_plan_json(*plan), request.accepts_gzip));
    reply(error_response(
        404, "no bridge publishes a plan of this bus",
        "GET /api/buses lists the buses; a bridge of an older version publishes none"));
  };
  table.add({Method::kGet, "/api/plan", Access::kViewer, handler});
}

}  // namespace fieldcast::web
