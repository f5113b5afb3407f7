#include "tools/station/api/base/response.hpp"

#include "tools/station/http/gzip.hpp"

namespace fieldcast::web {

HttpResponse json_response(std::string json, bool compress) {
  HttpResponse response;
  if (compress && json.size() >= kWorthCompressing) {
    response.body = packed(json);
    response.headers.emplace_back("content-encoding", "gzip");
  } else {
    response.body = std::move(json);
  }
  return response;
}

HttpResponse no_store() {
  return error_response(404, "this station stores nothing",
                        "give it a store: 'store: { path: FILE }' in its configuration");
}

}  // namespace fieldcast::web
