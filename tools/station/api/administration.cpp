#include "tools/station/api/administration.hpp"

#include <fmt/format.h>

#include "bridge/store/event_table.hpp"
#include "bridge/store/users/authenticator.hpp"
#include "core/access/network.hpp"
#include "core/base/json.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"

namespace fieldcast::web {

std::string metrics_text(const std::vector<Metric>& metrics) {
  std::string text;
  std::string_view described;
  for (const Metric& metric : metrics) {
    if (described != metric.name)
      text += fmt::format("# HELP fieldcast_station_{0} {1}\n# TYPE fieldcast_station_{0} {2}\n",
                          metric.name, metric.help, metric.counter ? "counter" : "gauge");
    described = metric.name;
    std::string label;
    // The escapes of a JSON text are those of a label.
    if (!metric.site.empty()) append_json_text(label, metric.site);
    if (!label.empty()) label = "{site=" + label + '}';
    text += fmt::format("fieldcast_station_{}{} {}\n", metric.name, label, metric.value);
  }
  return text;
}

std::vector<Metric> metrics_of(const Database* database, const Store* store,
                               const Recorder* recorder) {
  std::vector<Metric> all;
  const auto add = [&all](const char* name, bool counter, const char* help, auto value) {
    all.push_back({name, counter, help, static_cast<double>(value)});
  };
  if (database != nullptr) {
    const Database::Counters counters = database->counters();
    add("database_questions_total", true, "Queries to the store that had a response.",
        counters.completed);
    add("database_busy_total", true, "Questions refused since too many waited.", counters.busy);
    add("database_too_slow_total", true, "Questions that took too long.", counters.too_slow);
    add("database_away_total", true, "Queries to which the store did not respond.", counters.away);
    add("database_waiting", false, "Questions that wait.", counters.waiting);
  }
  if (store != nullptr) {
    const StoreCounters counters = store->counters();
    add("stored_samples_total", true, "Samples in committed transactions.", counters.stored);
    add("dropped_samples_total", true, "Samples that the store could not take.", counters.dropped);
    add("quarantined_rows_total", true, "Samples and events that the store's database refused.",
        counters.quarantined);
    add("waiting_samples", false, "Samples that wait to be stored.", counters.waiting);
  }
  if (recorder != nullptr) {
    const Recorder::Counters counters = recorder->counters();
    add("recorded_samples_total", true, "Samples handed to the store.", counters.recorded);
    add("repeated_samples_total", true, "Samples that came once more and were left out.",
        counters.repeated);
    add("unknown_samples_total", true, "Samples of channels beyond the recorder's limit.",
        counters.unknown);
    add("recorded_channels", false, "Channels that the recorder knows.", counters.channels);
  }
  return all;
}

void show_metrics(const Api& api, const HttpRequest&, const Caller&, const Reply& reply) {
  std::vector<Metric> all = metrics_of(api.database, api.store, api.recorder);
  for (const std::vector<Metric>& more : {metrics_of(api.notifier), api.metrics()})
    all.insert(all.end(), more.begin(), more.end());
  HttpResponse response;
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.body = metrics_text(all);
  reply(std::move(response));
}

void show_openapi(const Api&, const HttpRequest&, const Caller&, const Reply& reply) {
  static const auto kText = std::make_shared<const std::string>(openapi_text());
  HttpResponse response;
  response.content_type = "application/yaml";
  response.shared_body = kText;
  reply(std::move(response));
}

namespace {

constexpr std::string_view kWhat = "token";  // replaces the user name in the audit log

LoginVerdict refused(LoginRefused::Why why, Duration wait = {}) {
  return tl::make_unexpected(LoginRefused{why, wait});
}

LoginRefused::Why why_of(DatabaseFault fault) {
  return fault == DatabaseFault::kBusy ? LoginRefused::Why::kBusy : LoginRefused::Why::kUnavailable;
}

void note(Audit& audit, const std::string& name, const std::string& peer,
          const LoginVerdict& verdict) {
  audit.append({.who = (name.empty() ? std::string("a token") : "token " + name) +
                       (peer.empty() ? "" : " from " + peer),
                .what = "login",
                .result = verdict ? "done" : "refused: " + to_text(verdict.error())});
}

}  // namespace

void Tokens::check(std::string token, const std::string& peer,
                   std::function<void(LoginVerdict)> done) {
  const Duration wait = shared_->throttle.wait(kWhat, peer, now_());
  const std::string group = access::address_group(peer);
  if (wait > Duration{} || !looks_like_token(token)) {
    wipe(token);
    const auto verdict = wait > Duration{} ? refused(LoginRefused::Why::kTooSoon, wait)
                                           : refused(LoginRefused::Why::kWrong);
    if (wait <= Duration{}) {
      shared_->throttle.failed(kWhat, peer, now_());
      (void)shared_->throttled.recovered(group);
    }
    if (wait <= Duration{} || shared_->throttled.occurred(group, now_()).log)
      note(audit_, {}, peer, verdict);
    return done(verdict);
  }
  using Found = std::optional<Token>;
  const auto secret = std::make_shared<std::string>(std::move(token));
  database_.query<Found>(
      [secret, at = utc_()](SqlConnection& connection) {
        Found found = TokenTable(connection).find(*secret, at);
        wipe(*secret);
        return found;
      },
      [&audit = audit_, shared = shared_, now = now_, utc = utc_, peer, group,
       done = std::move(done)](const tl::expected<Found, DatabaseFault>& found) {
        LoginVerdict verdict = refused(LoginRefused::Why::kWrong);
        std::string name;
        if (!found) {
          verdict = refused(why_of(found.error()));
        } else if (*found) {
          name = (*found)->name;
          verdict = LoginGrant{.user = name,
                               .role = Role::kViewer,
                               .left = Duration{(*found)->ends_at.nanoseconds - utc().nanoseconds},
                               .by_token = true,
                               .credential_created_at = (*found)->created_at};
          shared->throttle.succeeded(kWhat, peer);
        } else {
          shared->throttle.failed(kWhat, peer, now());
        }
        (void)shared->throttled.recovered(group);
        note(audit, name, peer, verdict);
        done(verdict);
      });
}

void Tokens::list(std::function<void(std::optional<std::vector<Token>>)> done) {
  using List = std::vector<Token>;
  database_.query_urgent<List>(
      [at = utc_()](SqlConnection& connection) {
        List tokens = TokenTable(connection).list();
        std::erase_if(tokens, [at](const Token& each) { return each.ends_at <= at; });
        return tokens;
      },
      [done = std::move(done)](tl::expected<List, DatabaseFault> tokens) {
        done(tokens ? std::optional(*std::move(tokens)) : std::nullopt);
      });
}

namespace {

constexpr std::uint32_t kMostEntries = 10'000;

std::string entry_json(const AuditEntry& entry) {
  return JsonObject()
      .add("at_ms", entry.at)
      .add("who", entry.who)
      .add("what", entry.what)
      .add("target", entry.target)
      .add("bytes_to_device", entry.bytes_to_device)
      .add("bytes_from_device", entry.bytes_from_device)
      .add("result", entry.result)
      .take();
}

std::string user_json(const User& user) {
  return JsonObject()
      .add("user", user.name)
      .add("role", to_text(user.role))
      .add("created_ms", user.created_at)
      .take();
}

template <class Rows, class ToJson>
std::string list_json(std::string_view name, const Rows& rows, ToJson to_json) {
  return JsonObject()
      .add_json(name,
                json_array(rows, [&](std::string& out, const auto& row) { out += to_json(row); }))
      .take();
}

}  // namespace

void show_audit(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  const Parameters parameters(request, {"from", "to", "limit"});
  if (auto fault = parameters.fault()) return reply(*std::move(fault));
  auto span = parameters.span(api.now(), kOneDay);
  if (!span) return reply(std::move(span.error()));
  auto limit = parameters.number("limit", 1, kMostEntries, 1000);
  if (!limit) return reply(std::move(limit.error()));
  api.database->respond(
      [span = *span, limit = *limit, compress = request.accepts_gzip](SqlConnection& connection) {
        std::vector<AuditEntry> entries;
        EventTable(connection)
            .newest_audit(span.from, span.to, limit,
                          [&](const AuditEntry& entry) { entries.push_back(entry); });
        return json_response(list_json("entries", entries, entry_json), compress);
      },
      reply);
}

void show_users(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  api.database->respond(
      [](SqlConnection& connection) {
        return json_response(list_json("users", UserTable(connection).list(), user_json));
      },
      reply);
}

}  // namespace fieldcast::web
