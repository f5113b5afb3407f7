#include "tools/station/web/site.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace fieldcast::web {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

const EmbeddedFile kFiles[] = {
    // gzip of "<p>"
    {"/", "text/html; charset=utf-8",
     std::string_view("\x1f\x8b\x08\0\0\0\0\0\x02\x03\xb3\x29\xb0\x03\0\xbb\xa1\x6e\x3c\x03\0\0\0",
                      23),
     "\"index\""},
};

class SiteTest : public testing::Test {
 protected:
  SiteTest() { make({}); }
  void make(SiteSpec spec) {
    spec.listen = {"127.0.0.1", 8090};
    spec.version = "1.2.3";
    LoginCheck check;
    check.by_password = [this](LoginAttempt attempt, std::function<void(LoginVerdict)> done) {
      attempts_.push_back(attempt.user + "/" + std::string(attempt.password.text()) + " from " +
                          attempt.peer);
      if (refused_) return done(tl::make_unexpected(*refused_));
      done(LoginGrant{.user = attempt.user, .role = role_, .credential_created_at = {7}});
    };
    check.by_token = [](const std::string& token, const std::string&,
                        const std::function<void(LoginVerdict)>& done) {
      if (token != "good")
        return done(tl::make_unexpected(LoginRefused{LoginRefused::Why::kWrong}));
      done(LoginGrant{"wall", Role::kViewer, 240h, true, {7}});
    };
    check.random = [this] {
      SessionStore::Secret secret{};
      secret[0] = ++secrets_;
      return secret;
    };
    site_ = std::make_unique<Site>(
        spec, SiteClock{[this] { return now_; }, [] { return UtcTime{1'700'000'000'000'000'000}; }},
        check);
    site_->on_ended([this](std::uint64_t id) { ended_.push_back(id); });
    add_page_routes(site_->routes(), kFiles);
    const auto add = [this](Method method, const char* path, Access access) {
      site_->routes().add(
          {method, path, access,
           [this](const HttpRequest& request, const Caller& who, const Reply& reply) {
             asked_ = request;
             if (request.parameter("throw")) throw std::runtime_error("oh");
             HttpResponse response;
             response.body = who.user + "@" + who.peer;
             reply(std::move(response));
           }});
    };
    add(Method::kGet, "/api/alarms", Access::kViewer);
    add(Method::kPost, "/api/commands", Access::kOperator);
  }
  RawRequest get(const std::string& target) {
    RawRequest request;
    request.method = "GET";
    request.target = target;
    request.hosts = {"127.0.0.1:8090"};
    request.cookie = cookie_.empty() ? "" : "a=b; fieldcast=" + cookie_;
    request.peer = "127.0.0.1";
    return request;
  }
  RawRequest post(const std::string& target, const std::string& body) {
    RawRequest request = get(target);
    request.method = "POST";
    request.origin = "http://127.0.0.1:8090";
    request.content_type = "application/json; charset=utf-8";
    request.body = body;
    return request;
  }
  HttpResponse ask(RawRequest request) {
    std::optional<HttpResponse> response;
    site_->handle(std::move(request), [&](HttpResponse given) { response = std::move(given); });
    EXPECT_TRUE(response);
    return response.value_or(HttpResponse{});
  }
  unsigned status(RawRequest request) { return ask(std::move(request)).status; }
  static std::string header(const HttpResponse& response, std::string_view name) {
    for (const auto& [key, value] : response.headers) {
      if (key == name) return value;
    }
    return "-";
  }
  HttpResponse log_in(const std::string& body = R"({"user":"anna","password":"secret-1"})") {
    HttpResponse response = ask(post("/api/login", body));
    const std::string set = header(response, "set-cookie");
    if (const auto at = set.find('='); at != std::string::npos)
      cookie_ = set.substr(at + 1, set.find(';') - at - 1);
    return response;
  }

  Instant now_{1h};
  Role role_ = Role::kOperator;
  std::optional<LoginRefused> refused_;
  unsigned char secrets_ = 0;
  std::vector<std::string> attempts_;
  std::vector<std::uint64_t> ended_;
  std::string cookie_;
  HttpRequest asked_;
  std::unique_ptr<Site> site_;
};

TEST_F(SiteTest, WithoutALoginThereIsThePageAndNothingElse) {
  EXPECT_EQ(status(get("/")), 200u);
  EXPECT_EQ(status(get("/healthz")), 200u);
  EXPECT_EQ(status(get("/api/me")), 200u);
  EXPECT_EQ(status(get("/api/alarms")), 401u);
  EXPECT_EQ(status(post("/api/commands", "{}")), 401u);
  EXPECT_EQ(status(post("/api/logout", "")), 401u);
  EXPECT_EQ(status(get("/api/nothing")), 404u);
  const json me = json::parse(ask(get("/api/me")).body);
  EXPECT_EQ(me, json::parse(R"({"user":null,"role":null,"login":"required","expires_ms":null,
                                "version":"1.2.3","store":false,"now_ms":1700000000000.0})"));
}

TEST_F(SiteTest, ALoginGivesACookieAndTheRole) {
  const HttpResponse response = log_in();
  EXPECT_EQ(response.status, 200u);
  EXPECT_EQ(json::parse(response.body),
            json::parse(R"({"user":"anna","role":"operator","expires_ms":1700043200000.0})"));
  EXPECT_EQ(
      header(response, "set-cookie"),
      "fieldcast=01" + std::string(62, '0') + "; Path=/; Max-Age=43200; HttpOnly; SameSite=Strict");
  EXPECT_THAT(attempts_, ElementsAre("anna/secret-1 from 127.0.0.1"));
  EXPECT_EQ(ask(get("/api/alarms")).body, "anna@127.0.0.1");
  EXPECT_EQ(status(post("/api/commands", "{}")), 200u);
  EXPECT_EQ(json::parse(ask(get("/api/me")).body)["login"], "session");
}

TEST_F(SiteTest, AViewerMayNotCommand) {
  role_ = Role::kViewer;
  log_in();
  EXPECT_EQ(status(get("/api/alarms")), 200u);
  EXPECT_EQ(status(post("/api/commands", "{}")), 403u);
}

TEST_F(SiteTest, ALogoutEndsTheLogin) {
  log_in();
  const HttpResponse response = ask(post("/api/logout", ""));
  EXPECT_EQ(response.status, 204u);
  EXPECT_THAT(header(response, "set-cookie"), HasSubstr("fieldcast=; Path=/; Max-Age=0;"));
  EXPECT_EQ(status(get("/api/alarms")), 401u);
  EXPECT_THAT(ended_, ElementsAre(1));
}

TEST_F(SiteTest, ANewLoginEndsTheOneOfTheOldCookie) {
  log_in();
  const std::string old = cookie_;
  log_in();
  EXPECT_NE(cookie_, old);
  EXPECT_THAT(ended_, ElementsAre(1));
  cookie_ = old;
  EXPECT_EQ(status(get("/api/alarms")), 401u);
}

TEST_F(SiteTest, ATokenIsAViewerUntilItsEnd) {
  EXPECT_EQ(log_in(R"({"token":"bad"})").status, 401u);
  EXPECT_EQ(log_in(R"({"token":"good"})").status, 200u);
  const json me = json::parse(ask(get("/api/me")).body);
  EXPECT_EQ(me["login"], "token");
  EXPECT_EQ(me["user"], "wall");
  EXPECT_EQ(status(post("/api/commands", "{}")), 403u);
  now_ += 239h;
  EXPECT_EQ(status(get("/api/alarms")), 200u);
  now_ += 1h;
  EXPECT_EQ(status(get("/api/alarms")), 401u);
}

TEST_F(SiteTest, ALoginGoesOnWhileTheStoreHasItsPasswordOrToken) {
  log_in();
  site_->book().users_are(std::vector<User>{{"anna", role_, {7}}});
  EXPECT_EQ(status(get("/api/alarms")), 200u);
  log_in(R"({"token":"good"})");
  site_->book().tokens_are(std::vector<Token>{{"wall", {7}, {8}}});
  EXPECT_EQ(status(get("/api/alarms")), 200u);
  EXPECT_THAT(ended_, ElementsAre(1)) << "by the second login";
}

TEST_F(SiteTest, ARefusedLoginSaysWhyAndWhen) {
  refused_ = LoginRefused{LoginRefused::Why::kWrong};
  EXPECT_EQ(log_in().status, 401u);
  refused_ = LoginRefused{LoginRefused::Why::kTooSoon, 1500ms};
  const HttpResponse soon = log_in();
  EXPECT_EQ(soon.status, 429u);
  EXPECT_EQ(header(soon, "retry-after"), "2");
  refused_ = LoginRefused{LoginRefused::Why::kUnavailable};
  EXPECT_EQ(log_in().status, 503u);
  refused_ = LoginRefused{LoginRefused::Why::kBusy};
  EXPECT_EQ(log_in().status, 503u);
  EXPECT_EQ(status(get("/api/alarms")), 401u);
}

TEST_F(SiteTest, ALoginNeedsItsFields) {
  const std::string long_name(65, 'x'), long_password(1025, 'x');
  for (const std::string& body :
       {std::string("{}"), std::string("[]"), std::string(R"({"user":"anna"})"),
        std::string(R"({"user":1,"password":"x"})"), std::string(R"({"user":"","password":"x"})"),
        R"({"user":")" + long_name + R"(","password":"x"})",
        R"({"user":"anna","password":")" + long_password + R"("})"})
    EXPECT_EQ(log_in(body).status, 400u) << body.substr(0, 40);
  EXPECT_TRUE(attempts_.empty());
}

TEST_F(SiteTest, AnotherHostIsRefused) {
  for (const std::vector<std::string>& hosts :
       {std::vector<std::string>{"evil.example:8090"}, {"127.0.0.1"}, {"evil.example"}, {""}}) {
    RawRequest request = get("/");
    request.hosts = hosts;
    EXPECT_EQ(status(request), 421u);
  }
  for (const std::vector<std::string>& hosts :
       {std::vector<std::string>{}, {"127.0.0.1:8090", "127.0.0.1:8090"}}) {
    RawRequest request = get("/");
    request.hosts = hosts;
    EXPECT_EQ(status(request), 400u);
  }
}

TEST_F(SiteTest, AChangeFromAnotherOriginIsRefused) {
  log_in();
  for (const auto& origin : {std::optional<std::string>{}, std::optional<std::string>("null"),
                             std::optional<std::string>("http://evil.example"),
                             std::optional<std::string>("https://127.0.0.1:8090"),
                             std::optional<std::string>("http://localhost:8090")}) {
    RawRequest request = post("/api/commands", "{}");
    request.origin = origin;
    EXPECT_EQ(status(request), 403u) << origin.value_or("none");
  }
  RawRequest request = post("/api/commands", "{}");
  request.hosts = {"localhost:8090"};
  request.origin = "http://localhost:8090";
  EXPECT_EQ(status(request), 200u);
}

TEST_F(SiteTest, ABodyIsJson) {
  log_in();
  for (const char* type : {"", "text/plain", "application/x-www-form-urlencoded",
                           "multipart/form-data", "application/jsonx"}) {
    RawRequest request = post("/api/commands", "{}");
    request.content_type = type;
    EXPECT_EQ(status(request), 415u) << type;
  }
}

TEST_F(SiteTest, OtherMethodsAreRefused) {
  for (const char* method : {"PUT", "TRACE", "CONNECT", "get", ""}) {
    RawRequest request = get("/healthz");
    request.method = method;
    EXPECT_EQ(status(request), 405u) << method;
  }
  EXPECT_EQ(status(get("no path")), 400u);
  EXPECT_EQ(status(get("/%00")), 400u);
}

TEST_F(SiteTest, EveryResponseHasTheSecurityHeaders) {
  RawRequest strange = get("/");
  strange.hosts = {"evil.example"};
  for (const HttpResponse& response :
       {ask(get("/")), ask(get("/api/none")), ask(strange), ask(get("x")), ask(get("/api/alarms")),
        log_in(), site_->refusal(400, "", "")}) {
    const std::string policy = header(response, "content-security-policy");
    EXPECT_THAT(policy, HasSubstr("default-src 'none'; script-src 'self';"));
    EXPECT_THAT(policy, HasSubstr("require-trusted-types-for 'script'"));
    EXPECT_THAT(policy, HasSubstr("frame-ancestors 'none'"));
    EXPECT_EQ(header(response, "x-content-type-options"), "nosniff");
    EXPECT_EQ(header(response, "referrer-policy"), "no-referrer");
    EXPECT_EQ(header(response, "cross-origin-opener-policy"), "same-origin");
    EXPECT_EQ(header(response, "strict-transport-security"), "-");
  }
  EXPECT_EQ(header(ask(get("/api/me")), "cache-control"), "no-store");
}

TEST_F(SiteTest, OnlyTheNamedSitesMayEmbedAndOnlyOnePage) {
  make({.embed = {"https://wiki.plant", "http://board"}});
  EXPECT_THAT(header(ask(get("/embed?channel=a")), "content-security-policy"),
              HasSubstr("frame-ancestors 'self' https://wiki.plant http://board"));
  EXPECT_THAT(header(ask(get("/")), "content-security-policy"),
              HasSubstr("frame-ancestors 'none'"));
}

TEST_F(SiteTest, WithTlsTheCookieIsSecureAndTheBrowserMustStay) {
  make({.tls = true});
  RawRequest request = post("/api/login", R"({"user":"anna","password":"secret-1"})");
  request.origin = "https://127.0.0.1:8090";
  const HttpResponse response = ask(request);
  EXPECT_EQ(header(response, "set-cookie"),
            "__Host-fieldcast=01" + std::string(62, '0') +
                "; Path=/; Max-Age=43200; HttpOnly; SameSite=Strict; Secure");
  EXPECT_EQ(header(response, "strict-transport-security"), "max-age=31536000");
  RawRequest next = get("/api/alarms");
  next.cookie = "fieldcast=01" + std::string(62, '0');
  EXPECT_EQ(status(next), 401u);
  next.cookie = "__Host-fieldcast=01" + std::string(62, '0');
  EXPECT_EQ(status(next), 200u);
}

TEST_F(SiteTest, TheLocalRoleNeedsNoLogin) {
  site_->set_local_role(Role::kViewer);
  EXPECT_EQ(ask(get("/api/alarms")).body, "local@127.0.0.1");
  EXPECT_EQ(status(post("/api/commands", "{}")), 403u);
  EXPECT_EQ(json::parse(ask(get("/api/me")).body)["login"], "none");
  log_in();
  EXPECT_EQ(ask(post("/api/commands", "{}")).body, "anna@127.0.0.1");
  ended_.clear();
  site_->set_local_role(std::nullopt);
  EXPECT_THAT(ended_, ElementsAre(0));
  cookie_.clear();
  EXPECT_EQ(status(get("/api/alarms")), 401u);
}

TEST_F(SiteTest, AFaultOfAHandlerIsNotADetailForTheClient) {
  log_in();
  const HttpResponse response = ask(get("/api/alarms?throw"));
  EXPECT_EQ(response.status, 500u);
  EXPECT_EQ(response.body.find("oh"), std::string::npos);
}

TEST_F(SiteTest, AFileIsSentPackedUnpackedOrNotAtAll) {
  RawRequest request = get("/");
  const HttpResponse plain = ask(request);
  EXPECT_EQ(*plain.shared_body, "<p>");
  EXPECT_EQ(plain.content_type, "text/html; charset=utf-8");
  EXPECT_EQ(header(plain, "cache-control"), "no-cache");
  request.accept_encoding = "deflate, gzip;q=0.5, br";
  const HttpResponse packed = ask(request);
  EXPECT_EQ(header(packed, "content-encoding"), "gzip");
  EXPECT_EQ(packed.shared_body->size(), 23u);
  request.if_none_match = header(packed, "etag");
  EXPECT_EQ(status(request), 304u);
}

TEST_F(SiteTest, AWebSocketNeedsALoginAndTheOrigin) {
  RawRequest request = get("/live");
  request.origin = "http://127.0.0.1:8090";
  request.subprotocols = "other, fieldcast.1";
  EXPECT_EQ(site_->upgrade(request).error().status, 401u);
  log_in();
  request.cookie = "fieldcast=" + cookie_;
  const auto upgrade = site_->upgrade(request);
  ASSERT_TRUE(upgrade);
  EXPECT_EQ(upgrade->caller.user, "anna");
  EXPECT_EQ(upgrade->login, 1u);
  RawRequest strange = request;
  strange.origin = "http://evil.example";
  EXPECT_EQ(site_->upgrade(strange).error().status, 403u);
  strange.origin.reset();
  EXPECT_EQ(site_->upgrade(strange).error().status, 403u);
  strange = request;
  strange.hosts = {"evil.example:8090"};
  EXPECT_EQ(site_->upgrade(strange).error().status, 421u);
  strange = request;
  strange.target = "/api/alarms";
  EXPECT_EQ(site_->upgrade(strange).error().status, 404u);
}

TEST(AcceptEncoding, GzipMayBeForbidden) {
  EXPECT_TRUE(accepts_gzip("gzip"));
  EXPECT_TRUE(accepts_gzip("br ,  gzip ; q=0.1"));
  EXPECT_FALSE(accepts_gzip(""));
  EXPECT_FALSE(accepts_gzip("br, xgzip"));
  EXPECT_FALSE(accepts_gzip("gzip;q=0"));
  EXPECT_FALSE(accepts_gzip("gzip; q=0.000"));
}

TEST(Cookies, TheFirstOfTheNameCounts) {
  EXPECT_EQ(cookie_named("a=1; fieldcast=x; fieldcast=y", "fieldcast"), "x");
  EXPECT_EQ(cookie_named("xfieldcast=1;fieldcast", "fieldcast"), "");
  EXPECT_EQ(cookie_named("", "fieldcast"), "");
}

}  // namespace
}  // namespace fieldcast::web
