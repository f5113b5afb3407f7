#include "tools/station/api/history.hpp"

#include "bridge/store/tiers/tier_history.hpp"
#include "tools/station/api/base/parameters.hpp"
#include "tools/station/api/base/response.hpp"

namespace fieldcast::web {
namespace {

constexpr Duration kRaw = kOneDay;  // longer spans are always read as buckets

bool is_text(const StoredChannel& channel) { return channel.type == to_text(ValueType::kString); }

// Returns false if the span exceeds kRaw or has more samples than points.
bool read_samples(SqlConnection& connection, const HistoryQuestion& question,
                  HistorySeries& series) {
  if (question.to.nanoseconds - question.from.nanoseconds > kRaw.count()) return false;
  SampleTable(connection)
      .numbers(series.channel.id, question.from, question.to, std::int64_t{question.points} + 1,
               [&](UtcTime at, Quality quality, const Value& value) {
                 Bucket& row =
                     series.rows.emplace_back(Bucket{.channel = series.channel.id, .start = at});
                 row.add(quality, value);
                 return true;
               });
  if (series.rows.size() <= question.points) return true;
  series.rows.clear();
  return false;
}

void read_buckets(SqlConnection& connection, const HistoryQuestion& question,
                  HistorySeries& series) {
  const Duration span{question.to.nanoseconds - question.from.nanoseconds};
  series.bucket = width_for(span, question.points);
  const auto tier = tier_for(series.bucket);
  series.tier = tier ? kTiers[*tier].name : "raw";
  TierHistory(connection, series.bucket)
      .read(series.channel, question.from, question.to, [&](const Bucket& bucket) {
        series.rows.push_back(bucket);
        return true;
      });
}

void read_texts(SqlConnection& connection, const HistoryQuestion& question, HistorySeries& series) {
  SampleTable::Position after{question.from};
  const auto limit = std::int64_t{question.points};
  const auto count =
      SampleTable(connection)
          .part(series.channel, after, question.to, limit, [&](const StoredSample& sample) {
            const auto* text = std::get_if<std::string>(&sample.value);
            series.texts.push_back(
                {sample.published_at, sample.quality, text == nullptr ? "" : *text});
          });
  series.cut = count == limit;
}

}  // namespace

std::vector<HistorySeries> read_history(SqlConnection& connection,
                                        const HistoryQuestion& question) {
  std::vector<HistorySeries> all;
  for (const ChannelPath& path : question.channels) {
    HistorySeries& series = all.emplace_back();
    series.tier = "raw";
    auto found = SampleTable(connection).find(path);
    series.known = found.has_value();
    series.channel = found.value_or(
        StoredChannel{.bus = path.bus, .device = path.device, .channel = path.channel});
    if (!series.known) continue;
    if (is_text(series.channel))
      read_texts(connection, question, series);
    else if (!read_samples(connection, question, series))
      read_buckets(connection, question, series);
  }
  return all;
}

void add_history_routes(RouteTable& table, Database* database, std::function<UtcTime()> now) {
  const auto handler = [database, now = std::move(now)](const HttpRequest& request, const Caller&,
                                                        Reply reply) {
    if (database == nullptr) return reply(no_store());
    const Parameters parameters(request, {"channel", "from", "to", "points"});
    if (auto fault = parameters.fault("channel")) return reply(*std::move(fault));
    auto channels = parameters.channels("channel", kMaxHistoryChannels);
    if (!channels) return reply(std::move(channels.error()));
    auto span = parameters.span(now(), std::chrono::hours{1});
    if (!span) return reply(std::move(span.error()));
    auto points = parameters.number("points", 2, kMaxHistoryPoints, 1000);
    if (!points) return reply(std::move(points.error()));
    const HistoryQuestion question{*std::move(channels), span->from, span->to, *points};
    database->answer(
        [question, compress = request.accepts_gzip](SqlConnection& connection) {
          return json_response(
              history_json(question.from, question.to, read_history(connection, question)),
              compress);
        },
        std::move(reply));
  };
  table.add({Method::kGet, "/api/history", Access::kViewer, handler});
}

}  // namespace fieldcast::web
