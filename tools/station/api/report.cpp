// Reports of the store: totals of channels by shift, day or month, as JSON or CSV.
#include "tools/station/report/report.hpp"

#include "bridge/store/tiers/sample_table.hpp"
#include "bridge/store/tiers/tier_table.hpp"
#include "core/base/json.hpp"
#include "core/base/value.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"

namespace fieldcast::web {
namespace {

constexpr std::size_t kMaxReported = 32;  // channels
constexpr std::size_t kMaxPeriods = 400;
constexpr Duration kUsualSpan = kOneDay * 7;
constexpr Duration kLongestSpan = kOneDay * 430;  // its minutes of a channel need 50 MB

void add_optional(JsonObject& json, std::string_view name, const std::optional<double>& number) {
  if (number)
    json.add(name, *number);
  else
    json.add_json(name, "null");
}

std::string row_json(const ReportRow& row) {
  JsonObject json;
  json.add("from_ms", row.period.from).add("to_ms", row.period.to).add("covered", row.covered);
  add_optional(json, "min", row.min);
  add_optional(json, "mean", row.mean);
  add_optional(json, "max", row.max);
  add_optional(json, "integral", row.integral);
  return json.take();
}

std::string table_json(const ReportTable& table) {
  return JsonObject()
      .add("channel", table.channel)
      .add("known", table.known)
      .add("unit", table.unit)
      .add_json("rows", json_array(table.rows, [](std::string& out,
                                                  const ReportRow& row) { out += row_json(row); }))
      .take();
}

ReportTable read_table(SqlConnection& connection, const ChannelPath& path,
                       const std::vector<ReportPeriod>& periods) {
  ReportTable table{.channel = path.text()};
  const auto channel = SampleTable(connection).find(path);
  table.known = channel.has_value();
  if (!channel || periods.empty()) return table;
  table.unit = channel->unit;
  std::vector<Bucket> minutes;
  if (channel->type != to_text(ValueType::kString))
    TierHistory(connection, kReportMinute)
        .read(*channel, periods.front().from, periods.back().to, [&](const Bucket& bucket) {
          minutes.push_back(bucket);
          return true;
        });
  table.rows = report_rows(minutes, periods);
  return table;
}

HttpResponse csv_response(const std::vector<ReportTable>& tables) {
  HttpResponse response;
  response.content_type = "text/csv; charset=utf-8";
  response.headers.emplace_back("content-disposition", "attachment; filename=\"report.csv\"");
  response.body = report_csv(tables);
  return response;
}

}  // namespace

void show_report(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  const Parameters parameters(request, {"channel", "from", "to", "by", "shifts", "format"});
  if (auto fault = parameters.fault("channel")) return reply(*std::move(fault));
  auto channels = parameters.channels("channel", kMaxReported);
  if (!channels) return reply(std::move(channels.error()));
  auto span = parameters.span(api.now(), kUsualSpan);
  if (!span) return reply(std::move(span.error()));
  auto csv = parameters.chosen("format", "json", "csv");
  if (!csv) return reply(std::move(csv.error()));
  const auto by = report_by(request.parameter("by").value_or("day"));
  if (!by)
    return reply(error_response(400, "by: this is not a period", "give shift, day or month"));
  const auto shifts = shifts_from(request.parameter("shifts").value_or("06:00,14:00,22:00"));
  if (shifts.empty())
    return reply(error_response(400, "shifts: expected the times at which shifts begin",
                                "give 1 to 12 times in order, such as 06:00,14:00,22:00"));
  auto periods = periods_of(span->from, span->to, *by, shifts, kMaxPeriods + 1);
  if (periods.size() > kMaxPeriods ||
      Duration{span->to.nanoseconds - span->from.nanoseconds} > kLongestSpan)
    return reply(error_response(400, "the time range is longer than 400 periods or 430 days",
                                "choose a shorter time range or a longer period"));
  api.database->respond(
      [channels = *std::move(channels), periods = std::move(periods), csv = *csv,
       compress = request.accepts_gzip](SqlConnection& connection) {
        std::vector<ReportTable> tables;
        for (const ChannelPath& path : channels)
          tables.push_back(read_table(connection, path, periods));
        if (csv) return csv_response(tables);
        return json_response(
            JsonObject()
                .add_json("tables", json_array(tables,
                                               [](std::string& out, const ReportTable& table) {
                                                 out += table_json(table);
                                               }))
                .take(),
            compress);
      },
      reply);
}

}  // namespace fieldcast::web
