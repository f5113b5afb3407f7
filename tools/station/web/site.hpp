// What the station answers to a request, without a socket: Host, Origin and content type, who asks,
// the route, the headers of the response; and logging in and out. Lives on the io thread; owns
// routes and logins.
//
//     request -> Host served? -> Origin (all but GET) -> content type -> login -> route -> handler
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "core/model/spec.hpp"
#include "tools/station/web/login_check.hpp"
#include "tools/station/web/origin_check.hpp"
#include "tools/station/web/route_table.hpp"
#include "tools/station/web/security_headers.hpp"
#include "tools/station/web/session_book.hpp"

namespace fieldcast::web {

// A request as it came, before anything of it is believed.
struct RawRequest {
  std::string method, target;
  std::vector<std::string> hosts;  // of every Host header
  std::optional<std::string> origin;
  std::string content_type, cookie, accept_encoding, if_none_match;
  std::string body;
  std::string peer;  // the address without the port
};

struct SiteSpec {
  ListenSpec listen;  // with the port that it got
  bool tls = false;
  std::vector<std::string> hosts;  // further names
  std::vector<std::string> embed;  // sites that may show /embed
  std::string version;
  bool store = false;  // there is one
};

// What the site needs of the world.
struct SiteClock {
  std::function<Instant()> now;
  std::function<UtcTime()> utc;
};

class Site {
 public:
  // `logins` may be null: there are no users. It must outlive the site.
  Site(SiteSpec spec, SiteClock clock, LoginCheck logins);
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  [[nodiscard]] RouteTable& routes() { return routes_; }

  // What everybody may do who has no login; nothing: nobody may do anything. Sockets of those whose
  // role this changes are told to end, as logins are (id 0).
  void set_local_role(std::optional<Role> role);
  // Told the id of each login that has ended; 0: those without a login. Set before the first
  // request. Must not call back.
  void on_ended(std::function<void(std::uint64_t id)> ended) { ended_ = std::move(ended); }
  [[nodiscard]] SessionBook& book() { return book_; }
  // Whether the cookie of the request is that of a login; counts as a use of it.
  [[nodiscard]] bool has_login(const RawRequest& request) { return known(request).login != 0; }

  // `reply` is called once, now or later.
  void handle(RawRequest request, Reply reply);
  // A response for bytes that are no request: with the headers of all.
  [[nodiscard]] HttpResponse refusal(unsigned status, std::string_view error,
                                     std::string_view hint) const;

  // Whether this request may become a WebSocket: for whom, and by which login (0: without one).
  struct Upgrade {
    Caller caller;
    std::uint64_t login = 0;
  };
  [[nodiscard]] tl::expected<Upgrade, HttpResponse> upgrade(const RawRequest& request);

 private:
  struct Known {  // who asks
    std::optional<Caller> caller;
    std::uint64_t login = 0;
    std::string cookie;  // the secret, when one came
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
  SessionBook book_;
  RouteTable routes_;
};

// Of the header Accept-Encoding.
[[nodiscard]] bool accepts_gzip(std::string_view accept_encoding);
// Of the header Cookie; empty: there is none of that name.
[[nodiscard]] std::string_view cookie_named(std::string_view cookies, std::string_view name);

}  // namespace fieldcast::web
