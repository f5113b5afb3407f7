#include "tools/bench/support/store_history.hpp"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <vector>

#include "bridge/store/tiers/tier_table.hpp"
#include "bridge/store/tiers/tier_writer.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::bench {
namespace {

using namespace std::chrono_literals;

constexpr int kDays = 30;
constexpr std::int64_t kKnown = 100;  // channels
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kDay = 86'400;
constexpr UtcTime kBegin{1'699'920'000 * kSecond};  // 2023-11-14, midnight
constexpr UtcTime kEnd{kBegin.nanoseconds + kDays * kDay * kSecond};
constexpr std::uint32_t kPoints = 1000;

double seconds_of(const auto& work) {
  const auto began = Clock::now();
  work();
  return seconds_since(began);
}

// The best of several runs, because other processes share the machine.
double best_of(int runs, const auto& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int run = 0; run < runs; ++run) best = std::min(best, seconds_of(work));
  return best;
}

// Day by day, to stay within a server's statement timeout.
void insert_samples(SqlConnection& connection, std::int64_t channel) {
  StepProgress progress("making samples", kDays);
  for (std::int64_t day = 0; day < kDays; ++day, progress.step()) {
    connection.execute(
        "with recursive n(i) as (select 0 union all select i + 1 from n where i < 86399) insert "
        "into samples (channel, published_at, sequence, acquired_at, quality, device_code, "
        "value_kind, real_value) select $1, cast($2 as bigint) + i * cast(1000000000 as bigint), "
        "i, cast($3 as bigint) + i * cast(1000000000 as bigint), case when i % 1000 = 0 then 3 "
        "else 0 end, 0, 3, 20 + (i % 997) * 0.01 from n",
        SqlRow{channel, kBegin.nanoseconds + day * kDay * kSecond,
               kBegin.nanoseconds + day * kDay * kSecond});
  }
}

void copy_tiers(SqlConnection& connection, std::int64_t from, std::int64_t to) {
  connection.execute(
      "insert into tiers select width, $1, start, count, bad, min, max, sum, first, last from "
      "tiers where channel = $2",
      SqlRow{to, from});
}

struct Read {
  std::size_t points = 0, good = 0;
};
Read read(const StoreAddress& address, const std::vector<StoredChannel>& channels, Duration every) {
  const auto connection = open_store(address, IfMissing::kFail);
  TierHistory history(*connection, every);
  Read result;
  for (const StoredChannel& channel : channels) {
    history.read(channel, kBegin, kEnd, [&](const Bucket& bucket) {
      ++result.points;
      result.good += bucket.count;
      return true;
    });
  }
  return result;
}

}  // namespace

void fill_thirty_days(const StoreAddress& address) {
  const auto connection = open_store(address, IfMissing::kCreate);
  SampleTable samples(*connection);
  std::vector<std::int64_t> ids;
  for (std::int64_t i = 0; i < kKnown; ++i) {
    ids.push_back(samples.channel_id("history", "device", "c" + std::to_string(i), "", "float64"));
  }
  const double made = seconds_of([&] { insert_samples(*connection, ids[0]); });
  print_figure("  samples of one channel", kDays * kDay);
  print_figure("  making them", made, "s");
  connection->execute("insert into untiered values ($1, 0)", SqlRow{ids[0]});
  TierWriter tiers;
  double longest = 0;
  bool more = true;
  const double tiered = seconds_of([&] {
    // Steps over the samples; the few steps of coarser tiers follow.
    StepProgress progress("making tiers", kDays * kDay / TierWriter::kSamplesAtOnce);
    for (; more; progress.step())
      longest = std::max(longest, seconds_of([&] { more = tiers.step(*connection, kEnd); }));
  });
  print_figure("  their tiers, as for a store of an older version", tiered, "s");
  print_figure("  the longest step of it", 1e3 * longest, "ms");
  StepProgress progress("copying tiers", ids.size());
  for (std::size_t i = 1; i < ids.size(); ++i, progress.step())
    copy_tiers(*connection, ids[0], ids[i]);
}

void read_thirty_days(const StoreAddress& address) {
  std::printf("30 days of samples once a second, read as %u points\n", kPoints);
  fill_thirty_days(address);
  const Duration span{kEnd.nanoseconds - kBegin.nanoseconds};
  const Duration every = width_for(span, kPoints);
  auto channels = [&] {
    const auto connection = open_store(address, IfMissing::kFail);
    return SampleTable(*connection).channels(*Pattern::parse("history"));
  }();
  const std::vector<StoredChannel> one(channels.begin(), channels.begin() + 1);
  Read seen;
  const double single = best_of(5, [&] { seen = read(address, one, every); });
  print_figure("  points of one channel", seen.points, "", "up to 1 000");
  print_figure("  one channel, from minutes", 1e3 * single, "ms", "below 100");
  const double all = best_of(3, [&] { seen = read(address, channels, every); });
  print_figure("  points of 100 channels", seen.points);
  print_figure("  100 channels, from minutes", all, "s", "below 5");
  // No tier fits this width, which is a second less.
  const double raw = best_of(2, [&] { seen = read(address, one, every - 1s); });
  print_figure("  one channel, from its samples", 1e3 * raw, "ms");
  const double day = best_of(3, [&] { seen = read(address, channels, 24h); });
  print_figure("  100 channels by the day, from hours", 1e3 * day, "ms");
  if (!address.is_server()) {
    print_figure("  the file",
                 static_cast<double>(std::filesystem::file_size(address.text())) / 1e6, "MB");
  }
}

}  // namespace fieldcast::bench
