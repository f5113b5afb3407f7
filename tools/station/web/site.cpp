#include "tools/station/web/site.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "bridge/http/http_message.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast::web {

namespace {

constexpr std::string_view kLive = "/live";
constexpr std::string_view kSubprotocol = "fieldcast.1";

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string_view next_part(std::string_view& text, char separator) {
  const std::string_view part = text.substr(0, text.find(separator));
  text.remove_prefix(std::min(text.size(), part.size() + 1));
  return trimmed(part);
}

bool is_json(std::string_view content_type) {
  std::string type(next_part(content_type, ';'));
  for (char& c : type) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return type == "application/json";
}

}  // namespace

bool accepts_gzip(std::string_view accept_encoding) {
  while (!accept_encoding.empty()) {
    std::string_view coding = next_part(accept_encoding, ',');
    if (next_part(coding, ';') != "gzip") continue;
    const std::string_view weight = trimmed(coding);
    return !weight.starts_with("q=0") || weight.find_first_of("123456789") != weight.npos;
  }
  return false;
}

std::string_view cookie_named(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::string_view one = next_part(cookies, ';');
    const std::size_t equals = one.find('=');
    if (equals != one.npos && one.substr(0, equals) == name) return one.substr(equals + 1);
  }
  return {};
}

Site::Site(SiteSpec spec, SiteClock clock, LoginCheck logins)
    : spec_(std::move(spec)),
      clock_(std::move(clock)),
      logins_(std::move(logins)),
      hosts_(spec_.listen, spec_.hosts, spec_.tls),
      headers_(spec_.tls, spec_.embed),
      book_([this](std::uint64_t id) {
        if (ended_) ended_(id);
      }) {
  add_own_routes();
}

namespace {

// Only the station's own files; only lit-html may create markup from text.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
    "connect-src 'self'; font-src 'self'; manifest-src 'self'; base-uri 'none'; "
    "form-action 'none'; require-trusted-types-for 'script'; trusted-types lit-html; "
    "frame-ancestors ";

}  // namespace

SecurityHeaders::SecurityHeaders(bool tls, const std::vector<std::string>& embed)
    : tls_(tls), policy_(std::string(kPolicy) + "'none'"), embed_policy_(kPolicy) {
  embed_policy_ += embed.empty() ? "'none'" : "'self'";
  for (const std::string& site : embed) embed_policy_ += ' ' + site;
}

void SecurityHeaders::add_to(HttpResponse& response, const std::string& path) const {
  const auto add = [&](const char* name, const std::string& value) {
    const auto known = std::ranges::find(response.headers, name, &TextPairs::value_type::first);
    if (known == response.headers.end()) response.headers.emplace_back(name, value);
  };
  const bool embedded = path == "/embed" || path.starts_with("/embed/");
  add("content-security-policy", embedded ? embed_policy_ : policy_);
  add("x-content-type-options", "nosniff");
  add("referrer-policy", "no-referrer");
  add("cross-origin-opener-policy", "same-origin");
  add("cross-origin-resource-policy", "same-origin");
  add("permissions-policy", "camera=(), geolocation=(), microphone=()");
  add("cache-control", "no-store");
  if (tls_) add("strict-transport-security", "max-age=31536000");
}

void Site::set_local_role(std::optional<Role> role) {
  if (role == local_role_) return;
  local_role_ = role;
  if (ended_) ended_(0);
}

HttpResponse Site::refusal(unsigned status, std::string_view error, std::string_view hint) const {
  HttpResponse response = error_response(status, error, hint);
  headers_.add_to(response, {});
  return response;
}

std::optional<HttpResponse> Site::fault_of(const RawRequest& request, bool changes) const {
  if (request.hosts.size() != 1)
    return error_response(400, "one Host header is needed", "send one");
  const std::string& host = request.hosts.front();
  if (!hosts_.serves(host)) {
    return error_response(421, "this station is not known by that name",
                          "use its address, or add the name to 'hosts' of its configuration");
  }
  if (!changes) return std::nullopt;
  if (!request.origin || !same_origin(*request.origin, host, spec_.tls)) {
    return error_response(
        403, "the request comes from another site",
        fmt::format("send the header Origin: {}{}", spec_.tls ? "https://" : "http://", host));
  }
  return std::nullopt;
}

std::string_view Site::cookie_name() const { return spec_.tls ? "__Host-fieldcast" : "fieldcast"; }

std::string Site::cookie_header(const std::string& secret, Duration age) const {
  return fmt::format("{}={}; Path=/; Max-Age={}; HttpOnly; SameSite=Strict{}", cookie_name(),
                     secret, std::chrono::duration_cast<std::chrono::seconds>(age).count(),
                     spec_.tls ? "; Secure" : "");
}

Site::Known Site::known(const RawRequest& request) {
  Known known;
  known.cookie = cookie_named(request.cookie, cookie_name());
  if (const Login* login = book_.find(known.cookie, clock_.now())) {
    known.caller = Caller{login->user, login->role, request.peer};
    known.login = login->id;
  } else if (local_role_) {
    known.caller = Caller{"local", *local_role_, request.peer};
  }
  return known;
}

bool Site::takes_long_body(const RawRequest& request) {
  if (!request.target.starts_with("/api/configuration/")) return false;
  const Known client = known(request);
  return client.caller && may_use(Access::kEngineer, client.caller->role);
}

void Site::handle(RawRequest raw, Reply reply) {
  auto target = parse_target(raw.target);
  const Reply finish = [this, path = target ? target->path : std::string(),
                        reply = std::move(reply)](HttpResponse response) {
    headers_.add_to(response, path);
    reply(std::move(response));
  };
  if (!target) return finish(error_response(400, "the address is no path with a query", ""));
  const bool options = raw.method == "OPTIONS";
  const auto method = raw.method == "HEAD" ? Method::kGet : method_from(raw.method);
  const bool changes = method && *method != Method::kGet;
  if (auto fault = fault_of(raw, changes)) return finish(std::move(*fault));
  if (!method) {
    const Known who = known(raw);
    const auto allowed =
        routes_.allowed(target->path, who.caller ? std::optional(who.caller->role) : std::nullopt);
    if (!allowed) return finish(allowed.error());
    if (!options) return finish(method_refusal(*allowed));
    HttpResponse response;
    response.status = 204;
    response.headers.emplace_back("allow", *allowed);
    return finish(std::move(response));
  }
  if (!raw.body.empty() && !is_json(raw.content_type)) {
    return finish(error_response(415, "the body is not JSON",
                                 "send the header Content-Type: application/json"));
  }
  Known who = known(raw);
  const auto role = who.caller ? std::optional(who.caller->role) : std::nullopt;
  const auto route = routes_.find(*method, target->path, role);
  if (!route) return finish(route.error());
  HttpRequest request{*method,
                      std::move(target->path),
                      std::move(target->query),
                      std::move(raw.body),
                      accepts_gzip(raw.accept_encoding),
                      std::move(raw.if_none_match),
                      std::move(who.cookie)};
  try {
    (*route)->handler(request, who.caller.value_or(Caller{{}, Role::kViewer, raw.peer}), finish);
  } catch (const std::exception& error) {
    log_counted(LogLevel::kError, "web", "faults of handlers",
                fmt::format("{}: {}", request.path, error.what()));
    finish(error_response(500, "a fault of the station", "its log says more"));
  }
}

tl::expected<Site::Upgrade, HttpResponse> Site::upgrade(const RawRequest& raw) {
  const auto refuse = [this](HttpResponse response) {
    headers_.add_to(response, {});
    return tl::make_unexpected(std::move(response));
  };
  const auto target = parse_target(raw.target);
  if (raw.method != "GET" || !target || target->path != kLive)
    return refuse(error_response(404, "no WebSocket here", "there is GET /live"));
  if (auto fault = fault_of(raw, true)) return refuse(std::move(*fault));
  const Known who = known(raw);
  if (!who.caller)
    return refuse(error_response(401, "login required", "log in with POST /api/login"));
  bool speaks = false;
  for (std::string_view left = raw.subprotocols; !left.empty() && !speaks;)
    speaks = next_part(left, ',') == kSubprotocol;
  if (!speaks)
    return refuse(
        error_response(400, "no such subprotocol", fmt::format("ask for {}", kSubprotocol)));
  return Upgrade{*who.caller, who.login};
}

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
