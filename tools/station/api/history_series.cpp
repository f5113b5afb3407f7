#include "tools/station/api/history_series.hpp"

#include "core/base/cause.hpp"
#include "core/base/json.hpp"

namespace fieldcast::web {
namespace {

template <class Rows, class Append>
void column(JsonObject& object, std::string_view name, const Rows& rows, Append append) {
  object.add_json(name, json_array(rows, append));
}

// Writes null if the bucket has no good sample.
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

}  // namespace fieldcast::web
