#include "tools/station/api/audit.hpp"

#include "bridge/store/event_table.hpp"
#include "bridge/store/users/user_table.hpp"
#include "core/base/json.hpp"
#include "tools/station/api/base/parameters.hpp"
#include "tools/station/api/base/response.hpp"

namespace fieldcast::web {
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

void add_audit_routes(RouteTable& table, Database* database, std::function<UtcTime()> now) {
  const auto handler = [database, now = std::move(now)](const HttpRequest& request, const Caller&,
                                                        Reply reply) {
    if (database == nullptr) return reply(no_store());
    const Parameters parameters(request, {"from", "to", "limit"});
    if (auto fault = parameters.fault()) return reply(*std::move(fault));
    auto span = parameters.span(now(), kOneDay);
    if (!span) return reply(std::move(span.error()));
    auto limit = parameters.number("limit", 1, kMostEntries, 1000);
    if (!limit) return reply(std::move(limit.error()));
    database->answer(
        [span = *span, limit = *limit, compress = request.accepts_gzip](SqlConnection& connection) {
          std::vector<AuditEntry> entries;
          EventTable(connection)
              .newest_audit(span.from, span.to, limit,
                            [&](const AuditEntry& entry) { entries.push_back(entry); });
          return json_response(list_json("entries", entries, entry_json), compress);
        },
        std::move(reply));
  };
  table.add({Method::kGet, "/api/audit", Access::kOperator, handler});
}

void add_user_routes(RouteTable& table, Database* database) {
  const auto handler = [database](const HttpRequest& request, const Caller&, Reply reply) {
    if (database == nullptr) return reply(no_store());
    if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
    database->answer(
        [](SqlConnection& connection) {
          return json_response(list_json("users", UserTable(connection).list(), user_json));
        },
        std::move(reply));
  };
  table.add({Method::kGet, "/api/users", Access::kOperator, handler});
}

}  // namespace fieldcast::web
