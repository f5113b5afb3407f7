// Reports of the store: totals of channels by shift, day or month, as JSON, CSV or XLSX.
#include <fmt/format.h>

#include "bridge/log/log.hpp"
#include "core/base/json.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/report/report_reader.hpp"
#include "tools/station/report/report_xlsx.hpp"

namespace fieldcast::web {
namespace {

constexpr Duration kUsualSpan = kOneDay * 7;
constexpr Duration kLongestSpan = kOneDay * 430;  // its minutes of a channel need 50 MB
constexpr std::string_view kXlsxType =
    "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet";

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

enum class Format : std::uint8_t { kJson, kCsv, kXlsx };

Checked<Format> format_of(const HttpRequest& request) {
  const std::string text = request.parameter("format").value_or("json");
  if (text == "json") return Format::kJson;
  if (text == "csv") return Format::kCsv;
  if (text == "xlsx") return Format::kXlsx;
  return tl::make_unexpected(
      error_response(400, "format: this is not a format", "give json, csv or xlsx"));
}

// Each `channel` is a channel or a pattern.
Checked<std::vector<Pattern>> patterns_of(const HttpRequest& request) {
  std::vector<Pattern> patterns;
  for (const std::string& text : request.parameters("channel")) {
    auto pattern = Pattern::parse(text);
    if (!pattern)
      return tl::make_unexpected(error_response(400, "channel: " + pattern.error(),
                                                "give BUS/DEVICE/CHANNEL, with * for a pattern"));
    patterns.push_back(*std::move(pattern));
  }
  if (!patterns.empty() && patterns.size() <= kMaxReported) return patterns;
  return tl::make_unexpected(error_response(
      400, fmt::format("channel came {} times", patterns.size()),
      fmt::format("give channel=BUS/DEVICE/CHANNEL once to {} times", kMaxReported)));
}

HttpResponse file_response(std::string body, std::string_view type, std::string_view end) {
  HttpResponse response;
  response.content_type = type;
  response.headers.emplace_back("content-disposition",
                                fmt::format("attachment; filename=\"report.{}\"", end));
  response.body = std::move(body);
  return response;
}

HttpResponse xlsx_response(const std::vector<ReportTable>& tables) {
  auto bytes = report_xlsx(tables);
  if (bytes) return file_response(*std::move(bytes), kXlsxType, "xlsx");
  log_error("report", "the spreadsheet cannot be made: " + bytes.error());
  return error_response(500, "the spreadsheet cannot be made",
                        "the log of the station has the reason; format=csv needs no memory for it");
}

HttpResponse json_tables(const std::vector<ReportTable>& tables, bool compress) {
  const auto append = [](std::string& out, const ReportTable& table) { out += table_json(table); };
  return json_response(JsonObject().add_json("tables", json_array(tables, append)).take(),
                       compress);
}

HttpResponse too_many_channels(std::size_t count) {
  return error_response(400, fmt::format("channel: the patterns match {} channels", count),
                        fmt::format("give patterns of at most {} channels", kMaxReported));
}

// Reads one channel in each query, so that other queries do not wait for the whole report.
class ReportJob {
 public:
  ReportJob(Database& database, std::vector<ReportPeriod> periods, Format format, bool compress,
            Reply reply)
      : database_(database),
        periods_(std::move(periods)),
        format_(format),
        compress_(compress),
        reply_(std::move(reply)) {}

  static void start(const std::shared_ptr<ReportJob>& job, std::vector<Pattern> patterns) {
    using Channels = std::vector<ChannelPath>;
    job->database_.query<Channels>(
        [patterns = std::move(patterns)](SqlConnection& connection) {
          return channels_of(connection, patterns);
        },
        [job](tl::expected<Channels, DatabaseFault> found) {
          if (!found) return job->reply_(response_of(found.error()));
          if (found->size() > kMaxReported) return job->reply_(too_many_channels(found->size()));
          job->channels_ = *std::move(found);
          next(job);
        });
  }

 private:
  using Made = std::optional<HttpResponse>;  // empty: channels are left

  static void next(const std::shared_ptr<ReportJob>& job) {
    job->database_.query_further<Made>(
        [job](SqlConnection& connection) { return job->step(connection); },
        [job](tl::expected<Made, DatabaseFault> made) {
          if (!made) return job->reply_(response_of(made.error()));
          if (!*made) return next(job);
          job->reply_(**std::move(made));
        });
  }

  // On the database thread.
  [[nodiscard]] Made step(SqlConnection& connection) {
    if (tables_.size() < channels_.size()) {
      tables_.push_back(read_table(connection, channels_[tables_.size()], periods_));
      if (tables_.size() < channels_.size()) return std::nullopt;
    }
    switch (format_) {
      case Format::kCsv:
        return file_response(report_csv(tables_), "text/csv; charset=utf-8", "csv");
      case Format::kXlsx: return xlsx_response(tables_);
      case Format::kJson: break;
    }
    return json_tables(tables_, compress_);
  }

  Database& database_;
  const std::vector<ReportPeriod> periods_;
  const Format format_;
  const bool compress_;
  const Reply reply_;
  std::vector<ChannelPath> channels_;
  std::vector<ReportTable> tables_;  // of the first channels
};

}  // namespace

void show_report(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  const Parameters parameters(request, {"channel", "from", "to", "by", "shifts", "format"});
  if (auto fault = parameters.fault("channel")) return reply(*std::move(fault));
  auto patterns = patterns_of(request);
  if (!patterns) return reply(std::move(patterns.error()));
  auto span = parameters.span(api.now(), kUsualSpan);
  if (!span) return reply(std::move(span.error()));
  auto format = format_of(request);
  if (!format) return reply(std::move(format.error()));
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
  ReportJob::start(std::make_shared<ReportJob>(*api.database, std::move(periods), *format,
                                               request.accepts_gzip, reply),
                   *std::move(patterns));
}

}  // namespace fieldcast::web
