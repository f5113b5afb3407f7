#include "tools/station/api/base/openapi.hpp"

namespace fieldcast::web {

void add_openapi_routes(RouteTable& table) {
  const auto text = std::make_shared<const std::string>(openapi_text());
  table.add({Method::kGet, "/api/openapi.yaml", Access::kViewer,
             [text](const HttpRequest&, const Caller&, const Reply& reply) {
               HttpResponse response;
               response.content_type = "application/yaml";
               response.shared_body = text;
               reply(std::move(response));
             }});
}

}  // namespace fieldcast::web
