// Handles requests without a socket. Runs on the io thread; owns routes and logins.
//
//     request -> Host -> Origin (all but GET) -> content type -> login -> route -> handler
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/model/program_spec.hpp"
#include "tools/station/settings/origin_check.hpp"
#include "tools/station/web/embedded_file.hpp"
#include "tools/station/web/logins.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {

struct SiteSpec {
  ListenSpec listen;  // with the bound port
  bool tls = false;
  std::vector<std::string> hosts;  // further names
  std::vector<std::string> embed;  // sites that may show /embed in a frame
  std::string version;
  bool store = false;  // the station has a store
};

struct SiteClock {
  std::function<Instant()> now;
  std::function<UtcTime()> utc;
};

// Security headers of every response: a browser accepts only files of the station. Pure.
class SecurityHeaders {
 public:
  // `embed`: the sites that may show /embed in a frame ("https://wiki.plant").
  SecurityHeaders(bool tls, const std::vector<std::string>& embed);

  // Keeps headers that the response already has.
  void add_to(HttpResponse& response, const std::string& path) const;

 private:
  const bool tls_;
  std::string policy_, embed_policy_;
};

class Site {
 public:
  // Objects that `logins` uses must outlive the site.
  Site(SiteSpec spec, SiteClock clock, LoginCheck logins);
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  [[nodiscard]] RouteTable& routes() { return routes_; }

  // Role of clients without a login; may be empty. A change calls `ended(0)` to close their
  // sockets.
  void set_local_role(std::optional<Role> role);
  // Calls `ended(id)` for each login that ends; id 0: clients without a login. Set it before the
  // first request. The callback must not call this object.
  void on_ended(std::function<void(std::uint64_t id)> ended) { ended_ = std::move(ended); }
  [[nodiscard]] SessionStore& book() { return book_; }
  [[nodiscard]] bool has_login(const RawRequest& request) { return known(request).login != 0; }

  // Only an engineer sends whole configurations.
  [[nodiscard]] bool takes_long_body(const RawRequest& request);

  // `reply` is called once, immediately or later.
  void handle(RawRequest request, Reply reply);
  [[nodiscard]] HttpResponse refusal(unsigned status, std::string_view error,
                                     std::string_view hint) const;

  // Client of an allowed WebSocket and the id of its login (0: without one).
  struct Upgrade {
    Caller caller;
    std::uint64_t login = 0;
  };
  [[nodiscard]] tl::expected<Upgrade, HttpResponse> upgrade(const RawRequest& request);

 private:
  struct Known {  // identified client
    std::optional<Caller> caller;
    std::uint64_t login = 0;
    std::string cookie;  // secret of the cookie, if sent
  };
  [[nodiscard]] std::optional<HttpResponse> fault_of(const RawRequest& request, bool changes) const;
  [[nodiscard]] Known known(const RawRequest& request);
  [[nodiscard]] std::string_view cookie_name() const;
  [[nodiscard]] std::string cookie_header(const std::string& secret, Duration age) const;
  void add_own_routes();
  void log_in(const HttpRequest& request, const Caller& caller, const Reply& reply);
  void log_out(const HttpRequest& request, const Reply& reply);
  void finish_login(const std::string& old_cookie, const Reply& reply, LoginVerdict verdict);
  [[nodiscard]] HttpResponse me(const HttpRequest& request);

  const SiteSpec spec_;
  const SiteClock clock_;
  const LoginCheck logins_;
  const HostList hosts_;
  const SecurityHeaders headers_;
  std::function<void(std::uint64_t)> ended_;
  std::optional<Role> local_role_;
  SessionStore book_;
  RouteTable routes_;
};

[[nodiscard]] bool accepts_gzip(std::string_view accept_encoding);
[[nodiscard]] std::string_view cookie_named(std::string_view cookies, std::string_view name);

// Adds a public route for each file; /embed is also the index. Files are stored compressed.
void add_page_routes(RouteTable& routes, std::span<const EmbeddedFile> files);

}  // namespace fieldcast::web
