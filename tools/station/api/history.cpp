#include "tools/station/api/history.hpp"

#include "bridge/store/tiers/tier_table.hpp"
#include "core/base/cause.hpp"
#include "core/base/json.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"

namespace fieldcast::web {

namespace {

template <class Rows, class Append>
void column(JsonObject& object, std::string_view name, const Rows& rows, Append append) {
  object.add_json(name, json_array(rows, append));
}

auto number(double Bucket::*member) {
  return [member](std::string& out, const Bucket& bucket) {
    if (bucket.count == 0)
      out += "null";
    else
      append_json_number(out, bucket.*member);
  };
}

void add_numbers(JsonObject& object, const std::vector<Bucket>& rows) {
  column(object, "t", rows,
         [](std::string& out, const Bucket& row) { append_json_number(out, unix_ms(row.start)); });
  column(object, "min", rows, number(&Bucket::min));
  column(object, "max", rows, number(&Bucket::max));
  column(object, "average", rows, [](std::string& out, const Bucket& row) {
    if (const auto average = row.average())
      append_json_number(out, *average);
    else
      out += "null";
  });
  column(object, "last", rows, number(&Bucket::last));
  column(object, "count", rows,
         [](std::string& out, const Bucket& row) { out += std::to_string(row.count); });
  column(object, "bad", rows,
         [](std::string& out, const Bucket& row) { out += std::to_string(row.bad); });
}

void add_texts(JsonObject& object, const HistorySeries& series) {
  using Text = HistorySeries::Text;
  column(object, "t", series.texts,
         [](std::string& out, const Text& row) { append_json_number(out, unix_ms(row.at)); });
  column(object, "text", series.texts,
         [](std::string& out, const Text& row) { append_json_text(out, row.text); });
  column(object, "quality", series.texts,
         [](std::string& out, const Text& row) { append_json_text(out, to_text(row.quality)); });
  object.add("cut", series.cut);
}

std::string series_json(const HistorySeries& series) {
  const StoredChannel& channel = series.channel;
  JsonObject object;
  object.add("channel", channel.bus + '/' + channel.device + '/' + channel.channel)
      .add("known", series.known)
      .add("unit", channel.unit)
      .add("type", channel.type)
      .add("tier", series.tier)
      .add("bucket_ms", milliseconds(series.bucket));
  if (channel.type == to_text(ValueType::kString))
    add_texts(object, series);
  else
    add_numbers(object, series.rows);
  column(object, "late", series.late, [](std::string& out, const LateRange& range) {
    out += JsonObject()
               .add("from_ms", unix_ms(range.from))
               .add("to_ms", unix_ms(range.to))
               .add("samples", range.samples)
               .add("received_ms", range.received_at)
               .take();
  });
  return object.take();
}

}  // namespace

std::string history_json(UtcTime from, UtcTime to, const std::vector<HistorySeries>& series) {
  JsonObject object;
  object.add("from_ms", unix_ms(from)).add("to_ms", unix_ms(to));
  column(object, "series", series,
         [](std::string& out, const HistorySeries& each) { out += series_json(each); });
  return object.take();
}

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
    series.late = LateTable(connection).ranges(path.bus, path.device, question.from, question.to);
    if (is_text(series.channel))
      read_texts(connection, question, series);
    else if (!read_samples(connection, question, series))
      read_buckets(connection, question, series);
  }
  return all;
}

void show_history(const Api& api, const HttpRequest& request, const Caller&, const Reply& reply) {
  const Parameters parameters(request, {"channel", "from", "to", "points"});
  if (auto fault = parameters.fault("channel")) return reply(*std::move(fault));
  auto channels = parameters.channels("channel", kMaxHistoryChannels);
  if (!channels) return reply(std::move(channels.error()));
  auto span = parameters.span(api.now(), std::chrono::hours{1});
  if (!span) return reply(std::move(span.error()));
  auto points = parameters.number("points", 2, kMaxHistoryPoints, 1000);
  if (!points) return reply(std::move(points.error()));
  const HistoryQuestion question{*std::move(channels), span->from, span->to, *points};
  api.database->respond(
      [question, compress = request.accepts_gzip](SqlConnection& connection) {
        return json_response(
            history_json(question.from, question.to, read_history(connection, question)), compress);
      },
      reply);
}

}  // namespace fieldcast::web
