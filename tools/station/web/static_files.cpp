#include "tools/station/web/static_files.hpp"

#include "tools/station/http/gzip.hpp"

namespace fieldcast::web {
namespace {

struct KeptFile {
  EmbeddedFile file;
  std::shared_ptr<const std::string> packed, plain;
};

HttpResponse response_of(KeptFile& kept, const HttpRequest& request) {
  HttpResponse response;
  response.content_type = kept.file.content_type;
  // The browser caches the file and revalidates it each time, which costs a 304.
  response.headers = {{"cache-control", "no-cache"},
                      {"etag", std::string(kept.file.etag)},
                      {"vary", "accept-encoding"}};
  if (request.if_none_match == kept.file.etag) {
    response.status = 304;
    return response;
  }
  if (request.accepts_gzip) {
    if (!kept.packed) kept.packed = std::make_shared<const std::string>(kept.file.gzip);
    response.shared_body = kept.packed;
    response.headers.emplace_back("content-encoding", "gzip");
  } else {
    if (!kept.plain) kept.plain = std::make_shared<const std::string>(unpacked(kept.file.gzip));
    response.shared_body = kept.plain;
  }
  return response;
}

}  // namespace

void add_page_routes(RouteTable& routes, std::span<const EmbeddedFile> files) {
  for (const EmbeddedFile& file : files) {
    const auto kept = std::make_shared<KeptFile>(KeptFile{file, nullptr, nullptr});
    const Handler handler = [kept](const HttpRequest& request, const Caller&, const Reply& reply) {
      reply(response_of(*kept, request));
    };
    routes.add({Method::kGet, std::string(file.path), Access::kPublic, handler});
    if (file.path == "/") routes.add({Method::kGet, "/embed", Access::kPublic, handler});
  }
}

}  // namespace fieldcast::web
