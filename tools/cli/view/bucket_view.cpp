#include "tools/cli/view/bucket_view.hpp"

#include <fmt/format.h>

#include "core/base/value.hpp"
#include "tools/cli/model/sample_text.hpp"
#include "tools/cli/view/record_view.hpp"

namespace fieldcast::cli {
namespace {

// Statistics of the good samples with all digits; `none` if there are none.
struct Numbers {
  std::string min, max, average;
};
Numbers numbers_of(const StoredChannel& channel, const Bucket& bucket, const std::string& none) {
  if (bucket.count == 0) return {none, none, none};
  return {value_text(bucket.min, channel.type), value_text(bucket.max, channel.type),
          number_text(*bucket.average())};
}

std::string columns(std::string_view time, std::size_t time_width, std::string_view min,
                    std::string_view max, std::string_view average, std::string_view count,
                    std::string_view bad, std::string_view channel) {
  return fmt::format("{:<{}}  {:>12}  {:>12}  {:>12}  {:>6}  {:>5}  {}", time, time_width, min, max,
                     average, count, bad, channel);
}

std::size_t width_of_time(Zone zone) { return zone == Zone::kUtc ? 24 : 29; }

}  // namespace

std::string bucket_head(Zone zone) {
  return columns("time", width_of_time(zone), "min", "max", "average", "count", "bad", "channel");
}

std::string bucket_line(const StoredChannel& channel, const Bucket& bucket, Zone zone) {
  Numbers numbers = numbers_of(channel, bucket, "-");
  // A mean has more digits than are useful.
  if (bucket.count > 0) numbers.average = fmt::format("{:.7g}", *bucket.average());
  std::string path = channel.bus + '/' + channel.device + '/' + channel.channel;
  if (!channel.unit.empty()) path += " (" + channel.unit + ')';
  return printable(columns(time_text(bucket.start, zone), width_of_time(zone), numbers.min,
                           numbers.max, numbers.average, std::to_string(bucket.count),
                           std::to_string(bucket.bad), path));
}

std::string bucket_csv_head() { return "time,min,max,average,count,bad,bus,device,channel,unit"; }

std::string bucket_csv(const StoredChannel& channel, const Bucket& bucket, Zone zone) {
  const Numbers numbers = numbers_of(channel, bucket, "");
  return fmt::format("{},{},{},{},{},{},{},{},{},{}", time_text(bucket.start, zone), numbers.min,
                     numbers.max, numbers.average, bucket.count, bucket.bad, csv_field(channel.bus),
                     csv_field(channel.device), csv_field(channel.channel),
                     csv_field(channel.unit));
}

Json bucket_json(const StoredChannel& channel, const Bucket& bucket) {
  const auto number = [&](double value) { return bucket.count == 0 ? Json() : Json(value); };
  return {{"bus", channel.bus},
          {"device", channel.device},
          {"channel", channel.channel},
          {"time", bucket.start.nanoseconds},
          {"min", number(bucket.min)},
          {"max", number(bucket.max)},
          {"average", number(bucket.average().value_or(0))},
          {"count", bucket.count},
          {"bad", bucket.bad}};
}

}  // namespace fieldcast::cli
