#include "bridge/store/tiers/sample_table.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "bridge/store/tiers/bucket.hpp"
#include "bridge/store/tiers/sample_days.hpp"

namespace fieldcast {
namespace {

constexpr std::size_t kRows = 512;  // per statement

constexpr std::string_view kInsertColumns =
    " (channel, published_at, sequence, acquired_at, quality, device_code, value_kind, "
    "integer_value, real_value, text_value) values ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10) "
    "on conflict do nothing";
enum Column : std::size_t {
  kChannel,
  kPublished,
  kSequence,
  kAcquired,
  kQuality,
  kCode,
  kKind,
  kInteger,
  kReal,
  kText,
  kColumns
};

void fill(const SampleRow& sample, SqlRow& row) {
  row.resize(kColumns);
  row[kChannel] = sample.channel;
  row[kPublished] = sample.published_at.nanoseconds;
  row[kSequence] = static_cast<std::int64_t>(sample.sequence);
  row[kAcquired] = sample.acquired_at.nanoseconds;
  row[kQuality] = static_cast<std::int64_t>(sample.quality);
  row[kCode] = std::int64_t{sample.device_code};
  row[kKind] = static_cast<std::int64_t>(sample.value.index());
  row[kInteger] = row[kReal] = row[kText] = std::monostate{};
  if (const auto* flag = std::get_if<bool>(&sample.value)) row[kInteger] = std::int64_t{*flag};
  if (const auto* integer = std::get_if<std::int64_t>(&sample.value)) row[kInteger] = *integer;
  if (const auto* whole = std::get_if<std::uint64_t>(&sample.value))
    row[kInteger] = std::bit_cast<std::int64_t>(*whole);
  if (const auto* real = std::get_if<double>(&sample.value)) row[kReal] = *real;
  if (const auto* text = std::get_if<std::string>(&sample.value)) row[kText] = *text;
}

// Values that another program wrote must not cause a crash.
Value value_of(std::int64_t kind, const SqlRow& row, std::size_t at) {
  switch (kind) {
    case 0: return integer_at(row, at) != 0;
    case 1: return integer_at(row, at);
    case 2: return std::bit_cast<std::uint64_t>(integer_at(row, at));
    case 3: {
      if (const auto* real = std::get_if<double>(&row.at(at + 1))) return *real;
      return std::numeric_limits<double>::quiet_NaN();  // SQLite cannot store NaN
    }
    default: return text_at(row, at + 2);
  }
}

Quality quality_from(std::int64_t number) {
  const auto last = static_cast<std::int64_t>(Quality::kNotYetRead);
  return number < 0 || number > last ? Quality::kUncertain : static_cast<Quality>(number);
}

StoredSample sample_of(const StoredChannel& channel) {
  return {.bus = channel.bus,
          .device = channel.device,
          .channel = channel.channel,
          .unit = channel.unit,
          .type = channel.type};
}

// published_at, sequence, acquired_at, quality, device_code, value_kind and the value's columns.
void read(const SqlRow& row, StoredSample& sample) {
  sample.published_at.nanoseconds = integer_at(row, 0);
  sample.sequence = static_cast<std::uint64_t>(integer_at(row, 1));
  sample.acquired_at.nanoseconds = integer_at(row, 2);
  sample.quality = quality_from(integer_at(row, 3));
  sample.device_code = static_cast<std::uint16_t>(integer_at(row, 4));
  sample.value = value_of(integer_at(row, 5), row, 6);
}

}  // namespace

std::int64_t SampleTable::channel_id(const std::string& bus, const std::string& device,
                                     const std::string& channel, const std::string& unit,
                                     const std::string& type) {
  std::int64_t id = 0;
  connection_.query(
      "insert into channels (bus, device, channel, unit, type) values ($1, $2, $3, $4, $5) "
      "on conflict (bus, device, channel) do update set unit = excluded.unit, type = excluded.type "
      "returning id",
      {bus, device, channel, unit, type}, [&](const SqlRow& row) {
        id = integer_at(row, 0);
        return true;
      });
  return id;
}

void SampleTable::insert(std::span<const SampleRow> samples) {
  if (connection_.dialect() == SqlConnection::Dialect::kSqlite) return insert("samples", samples);
  const auto day = [](const SampleRow& sample) {
    return bucket_start(sample.published_at, SampleDays::kDay);
  };
  while (!samples.empty()) {
    const UtcTime first = day(samples.front());
    const auto other = std::ranges::find_if(
        samples, [&](const SampleRow& sample) { return day(sample) != first; });
    const auto same = static_cast<std::size_t>(other - samples.begin());
    insert(SampleDays(connection_).table_for(first), samples.first(same));
    samples = samples.subspan(same);
  }
}

void SampleTable::insert(std::string_view table, std::span<const SampleRow> samples) {
  const std::string sql = "insert into " + std::string(table) + std::string(kInsertColumns);
  std::vector<SqlRow> rows;
  for (std::size_t begin = 0; begin < samples.size(); begin += kRows) {
    const auto part = samples.subspan(begin, std::min(kRows, samples.size() - begin));
    rows.resize(part.size());
    for (std::size_t i = 0; i < part.size(); ++i) fill(part[i], rows[i]);
    connection_.execute(sql, rows);
  }
}

std::vector<StoredChannel> SampleTable::channels(const Pattern& pattern) {
  std::vector<StoredChannel> found;
  connection_.query(
      "select id, bus, device, channel, unit, type from channels order by bus, device, channel", {},
      [&](const SqlRow& row) {
        StoredChannel channel{integer_at(row, 0), text_at(row, 1), text_at(row, 2),
                              text_at(row, 3),    text_at(row, 4), text_at(row, 5)};
        if (pattern.matches(channel.bus, channel.device, channel.channel))
          found.push_back(std::move(channel));
        return true;
      });
  return found;
}

std::optional<StoredChannel> SampleTable::find(const ChannelPath& path) {
  std::optional<StoredChannel> found;
  connection_.query(
      "select id, unit, type from channels where bus = $1 and device = $2 and channel = $3",
      {path.bus, path.device, path.channel}, [&](const SqlRow& row) {
        found = {integer_at(row, 0), path.bus,        path.device,
                 path.channel,       text_at(row, 1), text_at(row, 2)};
        return false;
      });
  return found;
}

std::size_t SampleTable::history(const Pattern& pattern, UtcTime from, UtcTime to,
                                 const std::function<bool(const StoredSample&)>& on_sample) {
  const std::vector<StoredChannel> found = channels(pattern);
  bool wanted = true;
  for (const StoredChannel& channel : found) {
    if (!wanted) break;
    StoredSample sample = sample_of(channel);
    connection_.query(
        "select published_at, sequence, acquired_at, quality, device_code, value_kind, "
        "integer_value, real_value, text_value "
        "from samples where channel = $1 and published_at >= $2 and published_at < $3 order by "
        "published_at, sequence",
        {channel.id, from.nanoseconds, to.nanoseconds}, [&](const SqlRow& row) {
          read(row, sample);
          return wanted = on_sample(sample);
        });
  }
  return found.size();
}

std::int64_t SampleTable::part(const StoredChannel& channel, Position& after, UtcTime to,
                               std::int64_t limit,
                               const std::function<void(const StoredSample&)>& on_sample) {
  StoredSample sample = sample_of(channel);
  std::int64_t count = 0;
  const Position begin = after;
  connection_.query(
      "select published_at, sequence, acquired_at, quality, device_code, value_kind, "
      "integer_value, real_value, text_value "
      "from samples where channel = $1 and published_at >= $2 and published_at < $3 and "
      "(published_at > $4 or sequence > $5) order by published_at, sequence limit $6",
      {channel.id, begin.published_at.nanoseconds, to.nanoseconds, begin.published_at.nanoseconds,
       begin.sequence, limit},
      [&](const SqlRow& row) {
        read(row, sample);
        after = {sample.published_at, integer_at(row, 1)};
        ++count;
        on_sample(sample);
        return true;
      });
  return count;
}

void SampleTable::between(std::int64_t channel, const Span& span, std::int64_t limit,
                          const std::function<bool(StoredSample& sample)>& on_sample) {
  StoredSample sample;
  connection_.query(
      "select published_at, sequence, acquired_at, quality, device_code, value_kind, "
      "integer_value, real_value, text_value "
      "from samples where channel = $1 and published_at >= $2 and published_at < $3 and "
      "(published_at >= $4 or sequence > $5) and (published_at < $6 or sequence < $7) "
      "order by published_at, sequence limit $8",
      {channel, span.from.nanoseconds, span.to.nanoseconds, span.after_until.nanoseconds,
       static_cast<std::int64_t>(span.after), span.before_from.nanoseconds,
       static_cast<std::int64_t>(span.before), limit},
      [&](const SqlRow& row) {
        read(row, sample);
        return on_sample(sample);
      });
}

std::optional<SampleRow> SampleTable::first(std::int64_t channel, UtcTime from, UtcTime to) {
  std::optional<SampleRow> found;
  connection_.query(
      "select published_at, sequence, acquired_at, quality from samples where channel = $1 and "
      "published_at >= $2 and published_at < $3 order by published_at, sequence limit 1",
      {channel, from.nanoseconds, to.nanoseconds}, [&](const SqlRow& row) {
        found = {.channel = channel,
                 .published_at = {integer_at(row, 0)},
                 .acquired_at = {integer_at(row, 2)},
                 .sequence = static_cast<std::uint64_t>(integer_at(row, 1)),
                 .quality = quality_from(integer_at(row, 3))};
        return false;
      });
  return found;
}

void SampleTable::numbers(std::int64_t channel, UtcTime from, UtcTime to, std::int64_t limit,
                          const OnNumber& on_number) {
  connection_.query(
      "select published_at, quality, value_kind, integer_value, real_value, null from samples "
      "where channel = $1 and published_at >= $2 and published_at < $3 "
      "order by published_at, sequence limit $4",
      {channel, from.nanoseconds, to.nanoseconds, limit}, [&](const SqlRow& row) {
        return on_number(UtcTime{integer_at(row, 0)}, quality_from(integer_at(row, 1)),
                         value_of(integer_at(row, 2), row, 3));
      });
}

std::vector<std::int64_t> SampleTable::channel_ids() {
  std::vector<std::int64_t> ids;
  connection_.query("select id from channels", {}, [&](const SqlRow& row) {
    ids.push_back(integer_at(row, 0));
    return true;
  });
  return ids;
}

std::uint64_t SampleTable::remove_before(std::int64_t channel, UtcTime before,
                                         std::uint64_t limit) {
  return connection_.execute(
      "delete from samples where channel = $1 and published_at < $2 and published_at <= coalesce("
      "(select published_at from samples where channel = $3 order by published_at limit 1 offset "
      "$4), $5)",
      SqlRow{channel, before.nanoseconds, channel, static_cast<std::int64_t>(limit),
             before.nanoseconds});
}

std::optional<UtcTime> SampleTable::oldest(std::int64_t channel) {
  std::optional<UtcTime> found;
  connection_.query(
      "select published_at from samples where channel = $1 order by published_at limit 1",
      {channel}, [&](const SqlRow& row) {
        found = UtcTime{integer_at(row, 0)};
        return false;
      });
  return found;
}

std::optional<SampleRow> SampleTable::newest(std::int64_t channel, UtcTime before) {
  std::optional<SampleRow> found;
  connection_.query(
      "select published_at, sequence, acquired_at, quality from samples where channel = $1 and "
      "published_at < $2 order by published_at desc, sequence desc limit 1",
      {channel, before.nanoseconds}, [&](const SqlRow& row) {
        found = {.channel = channel,
                 .published_at = {integer_at(row, 0)},
                 .acquired_at = {integer_at(row, 2)},
                 .sequence = static_cast<std::uint64_t>(integer_at(row, 1)),
                 .quality = quality_from(integer_at(row, 3))};
        return false;
      });
  return found;
}

}  // namespace fieldcast
