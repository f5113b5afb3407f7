#include "bridge/store/tiers/sample_days.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "bridge/store/tiers/bucket.hpp"
#include "core/base/time.hpp"

namespace fieldcast {
namespace {

constexpr std::string_view kPrefix = "samples_";

std::string name_of(UtcTime day) {
  const std::chrono::year_month_day date{std::chrono::sys_days{
      std::chrono::floor<std::chrono::days>(std::chrono::nanoseconds{day.nanoseconds})}};
  return fmt::format("{}{:04}{:02}{:02}", kPrefix, static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

std::optional<UtcTime> day_of(std::string_view name) {
  if (!name.starts_with(kPrefix)) return std::nullopt;
  name.remove_prefix(kPrefix.size());
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end != name.data() + name.size()) return std::nullopt;
  const std::chrono::year_month_day date{
      std::chrono::year{number / 10'000},
      std::chrono::month{static_cast<unsigned>(number) / 100 % 100},
      std::chrono::day{static_cast<unsigned>(number) % 100}};
  if (!date.ok()) return std::nullopt;
  const std::chrono::days since{std::chrono::sys_days{date}.time_since_epoch()};
  // The first day in the range of 64 bits begins before the range.
  if (since < std::chrono::floor<std::chrono::days>(Duration::min()) ||
      since > std::chrono::floor<std::chrono::days>(Duration::max()))
    return std::nullopt;
  if (since == std::chrono::floor<std::chrono::days>(Duration::min()))
    return UtcTime{Duration::min().count()};
  return UtcTime{Duration{since}.count()};
}

}  // namespace

std::string SampleDays::table_for(UtcTime at) {
  const UtcTime day = bucket_start(at, kDay);
  std::string name = name_of(day);
  bool there = false;
  connection_.query("select to_regclass($1) is not null", {name}, [&](const SqlRow& row) {
    there = text_at(row, 0) == "t";
    return true;
  });
  if (there) return name;
  // Two bridges may do this simultaneously, so this uses the lock of schema.cpp.
  connection_.script("select pg_advisory_xact_lock(7021133)");
  connection_.script(
      fmt::format("create table if not exists {} (like samples including all, "
                  "check (published_at >= {} and published_at < {})) inherits (samples)",
                  name, day.nanoseconds, saturated_sum(day.nanoseconds, kDay.count())));
  return name;
}

std::vector<UtcTime> SampleDays::all() {
  std::vector<UtcTime> days;
  connection_.query(
      "select c.relname::text from pg_inherits i join pg_class c on c.oid = i.inhrelid "
      "where i.inhparent = to_regclass('samples') order by c.relname",
      {}, [&](const SqlRow& row) {
        if (const auto day = day_of(text_at(row, 0))) days.push_back(*day);
        return true;
      });
  return days;
}

bool SampleDays::drop(UtcTime day) {
  try {
    SqlTransaction transaction(connection_);
    // A statement that waits for a reader would block all later ones.
    connection_.script("set local lock_timeout = '200ms'");
    connection_.script("drop table if exists " + name_of(day));
    transaction.commit();
    return true;
  } catch (const StoreError&) { return false; }
}

bool SampleDays::has_undated() {
  bool found = false;
  connection_.query("select 1 from only samples limit 1", {}, [&](const SqlRow&) {
    found = true;
    return true;
  });
  return found;
}

std::uint64_t SampleDays::bytes() {
  std::uint64_t sum = 0;
  connection_.query(
      "select coalesce(sum(pg_total_relation_size(inhrelid)), 0)::bigint from pg_inherits "
      "where inhparent = to_regclass('samples')",
      {}, [&](const SqlRow& row) {
        sum = static_cast<std::uint64_t>(integer_at(row, 0));
        return true;
      });
  return sum;
}

}  // namespace fieldcast
