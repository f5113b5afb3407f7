#include "tools/station/station.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <future>
#include <iterator>
#include <optional>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/base/io_thread.hpp"
#include "bridge/dds/transport/network_check.hpp"
#include "bridge/log/log.hpp"
#include "bridge/store/store.hpp"
#include "bridge/store/users/authenticator.hpp"
#include "tools/station/api/administration.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/database.hpp"
#include "tools/station/live/live_domain.hpp"
#include "tools/station/notify/notifier.hpp"
#include "tools/station/record/recorder.hpp"
#include "tools/station/report/reporter.hpp"
#include "tools/station/stream/stream_reader.hpp"
#include "tools/station/web/site.hpp"
#include "tools/station/web/station_server.hpp"
#include "tools/station/wiring.hpp"

namespace fieldcast::web {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::milliseconds kTurn{500};  // heartbeat of the io thread for the watchdog
// a missing server is reported only after this time
constexpr std::chrono::seconds kServersReply{3};
constexpr std::chrono::milliseconds kStopLimit{2500};  // for the farewell to pages
// the io thread is expected to turn again within this time
constexpr std::chrono::seconds kAliveLimit{10};
constexpr Duration kFlushLimit = std::chrono::seconds{2};

SessionStore::Secret random_secret() {
  SessionStore::Secret secret;
  randombytes_buf(secret.data(), secret.size());
  return secret;
}

// Creates a missing store, so that its users can be read; an unavailable one may return later.
void make_store(const StoreAddress& address) {
  try {
    (void)fieldcast::open_store(address, IfMissing::kCreate);
  } catch (const StoreError& error) { log_error("store", error.what()); }
}

UtcTime utc_now() { return read_clocks().to_utc(steady_now()); }

}  // namespace

struct WebStation::State {
  State(StationSpec given, std::string text) : spec(std::move(given)), version(std::move(text)) {}

  void post(std::function<void()> task) { asio::post(io.context(), std::move(task)); }

  void open_store();
  [[nodiscard]] std::optional<BackfillSpec> backfill() const;
  void open_notifier(const StoreAddress& address);
  void join_domain();
  void open_site(std::unique_ptr<TlsServer> tls);
  [[nodiscard]] LoginCheck login_check();
  [[nodiscard]] UserWatch::Ask ask_users();
  [[nodiscard]] tl::expected<std::unique_ptr<TlsServer>, std::string> tls_server() const;
  void turn();
  void tell_servers();  // reports changes of the missing servers

  const StationSpec spec;
  const std::string version;
  std::atomic<std::chrono::nanoseconds::rep> turned{0};
  std::atomic<const char*> busy = "starting";
  bool started = false;
  std::vector<std::string> missing_servers;
  Instant servers_from{};  // servers are checked from then on

  // In the order of start; each member uses the ones above.
  std::unique_ptr<Store> store;
  std::unique_ptr<Recorder> recorder;
  std::unique_ptr<Notifier> notifier;
  std::unique_ptr<Reporter> reporter;
  IoThread io{"web"};
  std::unique_ptr<asio::steady_timer> turning;
  std::unique_ptr<Database> database;
  std::unique_ptr<Authenticator> logins;
  std::unique_ptr<Tokens> tokens;
  std::unique_ptr<LiveDomain> domain;
  std::unique_ptr<StreamReader> stream;
  std::unique_ptr<Site> site;
  std::unique_ptr<UserWatch> users;
  std::unique_ptr<StationServer> server;
  std::unique_ptr<Listener> listener;
};

void WebStation::State::open_store() {
  if (!spec.store) return;
  const StoreAddress address(spec.store->address);
  make_store(address);
  store = std::make_unique<Store>(*spec.store);
  if (!spec.store->samples.empty()) recorder = std::make_unique<Recorder>(*store);
  if (spec.notify) open_notifier(address);
  if (!spec.reports.empty())
    reporter = std::make_unique<Reporter>(std::make_unique<ReportMaker>(
        spec.reports, spec.notify ? spec.notify->targets : std::vector<NotifyTarget>{}, spec.name,
        address));
  database = std::make_unique<Database>(
      address, [this](std::function<void()> task) { post(std::move(task)); });
  logins = std::make_unique<Authenticator>(address, *store);
  tokens = std::make_unique<Tokens>(*database, *store, utc_now, steady_now);
}

std::optional<BackfillSpec> WebStation::State::backfill() const {
  if (!recorder || spec.backfill == Duration{}) return std::nullopt;
  return BackfillSpec{StoreAddress(spec.store->address), spec.backfill};
}

void WebStation::State::open_notifier(const StoreAddress& address) {
  notifier = std::make_unique<Notifier>(*spec.notify, spec.name, address, [this] {
    return steady_now() - Instant{Duration{turned.load()}} < kAliveLimit;
  });
}

void WebStation::State::join_domain() {
  std::function<void(const StationAlarmStatus&)> on_alarm;
  if (notifier) on_alarm = [this](const StationAlarmStatus& alarm) { notifier->on_alarm(alarm); };
  domain = std::make_unique<LiveDomain>(io.context(), spec.sites, spec.name, version, store.get(),
                                        recorder.get(), backfill(), on_alarm);
  std::set<std::string> names;
  for (const DdsSite& one : spec.sites) names.insert(one.name);
  if (spec.stream)
    stream = std::make_unique<StreamReader>(
        *spec.stream, spec.name, std::move(names), domain->inbox(), store.get(),
        spec.store ? StoreAddress(spec.store->address) : StoreAddress(), recorder.get(), on_alarm);
  if (spec.stream && spec.stream_commands)
    domain->set_stream(
        stream->allow_commands([this](std::uint64_t id, const StationOutcome& outcome) {
          domain->commands().on_outcome(id, outcome);
        }));
  servers_from = steady_now() + kServersReply;
}

LoginCheck WebStation::State::login_check() {
  LoginCheck check;
  check.random = random_secret;
  if (!logins) return check;
  check.by_password = [this](LoginAttempt attempt, std::function<void(LoginVerdict)> done) {
    logins->authenticate(std::move(attempt), [this, done = std::move(done)](LoginResult result) {
      post([done, result] {
        if (!result) return done(tl::make_unexpected(result.error()));
        done(LoginGrant{.user = result->name,
                        .role = result->role,
                        .credential_created_at = result->created_at});
      });
    });
  };
  check.by_token = [this](std::string token, const std::string& peer,
                          std::function<void(LoginVerdict)> done) {
    tokens->check(std::move(token), peer, std::move(done));
  };
  return check;
}

UserWatch::Ask WebStation::State::ask_users() {
  if (!database) return {};
  return [this](std::function<void(UserWatch::Users)> done) {
    tokens->list([this](const std::optional<std::vector<Token>>& valid) {
      if (valid && site) site->book().tokens_are(*valid);
    });
    database->query_urgent<std::vector<User>>(
        [](SqlConnection& connection) { return UserTable(connection).list(); },
        [done = std::move(done)](tl::expected<std::vector<User>, DatabaseFault> found) {
          done(found ? UserWatch::Users(*std::move(found)) : std::nullopt);
        });
  };
}

tl::expected<std::unique_ptr<TlsServer>, std::string> WebStation::State::tls_server() const {
  if (spec.web.certificate.empty()) return nullptr;
  return TlsServer::make({.certificate = spec.web.certificate, .key = spec.web.key});
}

// REQUIRES: the listener is open.
void WebStation::State::open_site(std::unique_ptr<TlsServer> tls) {
  SiteSpec site_spec;
  site_spec.listen = {spec.web.listen.host, listener->port()};
  site_spec.tls = tls != nullptr;
  site_spec.hosts = spec.web.hosts;
  site_spec.embed = spec.web.embed;
  site_spec.version = version;
  site_spec.store = store != nullptr;
  site =
      std::make_unique<Site>(std::move(site_spec), SiteClock{steady_now, utc_now}, login_check());
  server = std::make_unique<StationServer>(io.context(), *site, domain->make_protocol());
  server->http().serve(std::move(tls));
  users = std::make_unique<UserWatch>(io.context(), spec, *site, ask_users());
  users->look();
  add_page_routes(site->routes(), page_files());
  add_routes(site->routes(),
             {.model = &domain->model(),
              .commands = &domain->commands(),
              .configurations = &domain->configurations(),
              .database = database.get(),
              .store = store.get(),
              .recorder = recorder.get(),
              .audit = store.get(),
              .notifier = notifier.get(),
              .reports = &spec.reports,
              .now = utc_now,
              .metrics = [this] { return metrics_of(*domain, stream.get(), *server); }});
}

void WebStation::State::tell_servers() {
  std::vector<std::string> now = domain->missing_servers();
  if (now == missing_servers) return;
  missing_servers = std::move(now);
  for (const DdsSite& one : spec.sites) {
    const std::vector<std::string>& named = one.dds.discovery_servers;
    std::vector<std::string> absent;
    std::copy_if(named.begin(), named.end(), std::back_inserter(absent),
                 [this](const auto& address) {
                   return std::count(missing_servers.begin(), missing_servers.end(), address) != 0;
                 });
    const std::string of = one.name.empty() ? "" : "site " + one.name + ": ";
    if (const auto remark = servers_remark(named, absent)) log_warning("dds", of + *remark);
  }
  if (missing_servers.empty()) log_info("dds", "every discovery server responds");
}

void WebStation::State::turn() {
  turned = steady_now().time_since_epoch().count();
  if (domain && steady_now() > servers_from) tell_servers();
  turning->expires_after(kTurn);
  turning->async_wait([this](error_code cancelled) {
    // A timer that expired just before the stop has no error code.
    if (!cancelled && turning) turn();
  });
}

WebStation::WebStation(StationSpec spec, std::string version)
    : state_(std::make_unique<State>(std::move(spec), std::move(version))) {}
WebStation::~WebStation() { stop(); }

tl::expected<void, WebStation::Fault> WebStation::start() {
  State& s = *state_;
  auto tls = s.tls_server();
  if (!tls) return tl::make_unexpected(Fault{true, tls.error()});
  s.started = true;
  s.open_store();
  tl::expected<void, std::string> listening;
  s.io.run([&] {
    s.turning = std::make_unique<asio::steady_timer>(s.io.context());
    s.turn();
    s.listener = std::make_unique<Listener>(s.io.context(), [&s](asio::ip::tcp::socket socket) {
      if (s.server) s.server->http().accept(std::move(socket));
    });
    listening = s.listener->open(s.spec.web.listen);
  });
  if (!listening) return tl::make_unexpected(Fault{false, listening.error()});
  s.io.run([&] {
    s.join_domain();
    s.open_site(*std::move(tls));
  });
  s.busy = "running";
  return {};
}

std::string WebStation::address() const {
  const WebSpec& web = state_->spec.web;
  const bool v6 = web.listen.host.find(':') != std::string::npos;
  return fmt::format("{}://{}:{}/", web.certificate.empty() ? "http" : "https",
                     v6 ? '[' + web.listen.host + ']' : web.listen.host, state_->listener->port());
}

tl::expected<void, std::string> WebStation::renew_certificate() {
  auto tls = state_->tls_server();
  if (!tls) return tl::make_unexpected(tls.error());
  state_->io.run([&] { state_->server->http().serve(*std::move(tls)); });
  return {};
}

std::vector<BusTurn> WebStation::turns() const {
  return {{"web", Instant{Duration{state_->turned.load()}}}};
}

std::string WebStation::busy_with() const { return state_->busy.load(); }

void WebStation::stop() {
  State& s = *state_;
  if (!std::exchange(s.started, false)) return;
  s.busy = "telling the pages";
  std::promise<void> told;
  s.io.run([&] {
    if (s.listener) s.listener->close();
    s.turning.reset();
    s.users.reset();
    if (!s.server) return told.set_value();
    s.server->close([&told] { told.set_value(); });
  });
  (void)told.get_future().wait_for(kStopLimit);
  s.busy = "waiting for the store's questions";
  s.logins.reset();
  s.database.reset();
  s.busy = "leaving the stream";
  if (s.stream) s.io.run([&] { s.domain->commands().close(); });
  s.stream.reset();
  s.busy = "leaving the DDS domain";
  s.io.run([&] {
    s.server.reset();
    s.site.reset();
    s.domain.reset();
    s.listener.reset();
  });
  s.io.run([] {});  // waits for tasks posted before
  s.busy = "making a report";
  s.reporter.reset();
  s.busy = "sending a notification";
  s.notifier.reset();
  s.busy = "writing to the store";
  s.recorder.reset();
  if (s.store) (void)s.store->flush(kFlushLimit);
  s.store.reset();
}

}  // namespace fieldcast::web
