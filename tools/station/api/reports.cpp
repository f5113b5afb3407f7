// Saved reports and the reports by schedule. A saved report is a name and the query of the address
// of the page.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/json.hpp"
#include "core/base/message_text.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/audit_note.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/report/report_table.hpp"

namespace fieldcast::web {
namespace {

constexpr std::size_t kMaxReportName = 64, kMaxReportQuery = 4000;  // bytes
constexpr std::int64_t kNewestRuns = 50;

std::string saved_json(const SavedReport& report) {
  return JsonObject()
      .add("name", report.name)
      .add("query", report.query)
      .add("saved_by", report.saved_by)
      .add("saved_ms", report.saved_at)
      .take();
}

std::string scheduled_json(const ReportSpec& report) {
  return JsonObject()
      .add("name", report.name)
      .add_json("channels", json_array(report.channels,
                                       [](std::string& out, const Pattern& pattern) {
                                         append_json_text(out, pattern.text());
                                       }))
      .add("by", to_text(report.by))
      .add("every", report.monthly ? "month" : "day")
      .add("at", fmt::format("{:02}:{:02}", report.at / 60, report.at % 60))
      .add("to", report.folder)
      .add_json("mail", json_array(report.mail,
                                   [](std::string& out, const std::string& target) {
                                     append_json_text(out, target);
                                   }))
      .take();
}

std::string run_json(const StoredReportRun& run) {
  return JsonObject()
      .add("report", run.report)
      .add("via", run.via)
      .add("period", run.period)
      .add("made_ms", run.made_at)
      .add("result", run.result)
      .take();
}

Checked<std::string> name_in(const nlohmann::json& body) {
  auto name = text_in(body, "name", kMaxReportName);
  if (name && !name->empty() && printable(*name) == *name) return *std::move(name);
  return tl::make_unexpected(
      error_response(400, "name: this is not a name",
                     fmt::format("1 to {} bytes of printable text", kMaxReportName)));
}

Checked<std::string> query_in(const nlohmann::json& body) {
  auto query = text_in(body, "query", kMaxReportQuery);
  const auto plain = [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("%&=*.-_+~").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (query && !query->empty() && std::ranges::all_of(*query, plain)) return *std::move(query);
  return tl::make_unexpected(
      error_response(400, "query: this is not the query of an address",
                     "such as c=line%2F*&by=day&span=7d, with other characters as %XX"));
}

}  // namespace

void list_reports(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  if (auto fault = Parameters(request, {}).fault()) return reply(*std::move(fault));
  const std::vector<ReportSpec> none;
  std::string scheduled =
      json_array(api.reports == nullptr ? none : *api.reports,
                 [](std::string& out, const ReportSpec& report) { out += scheduled_json(report); });
  api.database->respond(
      [scheduled = std::move(scheduled),
       compress = request.accepts_gzip](SqlConnection& connection) {
        const auto saved = [](std::string& out, const SavedReport& each) {
          out += saved_json(each);
        };
        const auto run = [](std::string& out, const StoredReportRun& each) {
          out += run_json(each);
        };
        return json_response(
            JsonObject()
                .add_json("saved", json_array(SavedReportTable(connection).list(), saved))
                .add_json("scheduled", scheduled)
                .add_json("runs", json_array(ReportRunTable(connection).newest(kNewestRuns), run))
                .take(),
            compress);
      },
      reply);
}

void save_report(const Api& api, const HttpRequest& request, const Caller& caller,
                 const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  if (auto fault = unknown_member(*body, {"name", "query"})) return reply(*std::move(fault));
  auto name = name_in(*body);
  if (!name) return reply(std::move(name.error()));
  auto query = query_in(*body);
  if (!query) return reply(std::move(query.error()));
  SavedReport report{*name, *std::move(query), caller.user, api.now()};
  api.database->respond_changing(
      [report = std::move(report)](SqlConnection& connection) {
        if (SavedReportTable(connection).save(report)) return json_response(saved_json(report));
        return error_response(
            409, fmt::format("there are {} reports already", SavedReportTable::kMaxReports),
            "delete one that is not used");
      },
      noting(api, caller, "save report", *name, reply));
}

void delete_report(const Api& api, const HttpRequest& request, const Caller& caller,
                   const Reply& reply) {
  const auto body = body_of(request);
  if (!body) return reply(body.error());
  if (auto fault = unknown_member(*body, {"name"})) return reply(*std::move(fault));
  const auto name = name_in(*body);
  if (!name) return reply(name.error());
  api.database->respond_changing(
      [name = *name](SqlConnection& connection) {
        return SavedReportTable(connection).remove(name)
                   ? json_response(JsonObject().take())
                   : error_response(404, "there is no report of this name",
                                    "GET /api/reports lists them");
      },
      noting(api, caller, "delete report", *name, reply));
}

}  // namespace fieldcast::web
