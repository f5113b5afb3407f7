#include "tools/station/stream/site_registry.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

namespace fieldcast::web {

namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kSchema = 1;

// 0 for a member that is missing or not a whole number of 63 bits.
std::uint64_t number_in(const Json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number_unsigned()) return 0;
  constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
  return std::min(found->get<std::uint64_t>(), kMost);
}

UtcTime time_in(const Json& object, const char* name) {
  return {static_cast<std::int64_t>(number_in(object, name))};
}

}  // namespace

std::optional<SiteReport> site_report_from(std::string_view text) {
  const Json report = Json::parse(text, nullptr, false);
  if (!report.is_object() || number_in(report, "schema") != kSchema) return std::nullopt;
  return SiteReport{.at = time_in(report, "at"),
                    .oldest_at = time_in(report, "oldest_at"),
                    .backlog_records = number_in(report, "backlog_records"),
                    .backlog_bytes = number_in(report, "backlog_bytes"),
                    .samples = number_in(report, "samples"),
                    .late_samples = number_in(report, "late_samples"),
                    .lost_samples = number_in(report, "lost_samples")};
}

SiteRegistry::Entry* SiteRegistry::entry_of(const std::string& site) {
  const auto known = entries_.find(site);
  if (known != entries_.end()) return &known->second;
  if (entries_.size() >= kMaxSites || is_reserved(site)) return nullptr;
  Entry& entry = entries_[site];
  entry.site.site = site;
  return &entry;
}

void SiteRegistry::heard(const std::string& site, UtcTime stored_at) {
  const std::lock_guard lock(mutex_);
  Entry* const entry = entry_of(site);
  if (entry != nullptr) entry->site.heard_at = std::max(entry->site.heard_at, stored_at);
}

void SiteRegistry::reported(const std::string& site, const SiteReport& report, UtcTime stored_at) {
  const std::lock_guard lock(mutex_);
  Entry* const entry = entry_of(site);
  if (entry == nullptr) return;
  LiveSite& to = entry->site;
  to.heard_at = std::max(to.heard_at, stored_at);
  to.reported_at = stored_at;
  to.clock_ahead = Duration{saturated_difference(stored_at.nanoseconds, report.at.nanoseconds)};
  to.backlog_records = report.backlog_records;
  to.backlog_bytes = report.backlog_bytes;
  to.oldest_at = report.oldest_at;
  to.samples = report.samples;
  to.late_samples = report.late_samples;
  to.lost_samples = report.lost_samples;
}

void SiteRegistry::refused(const std::string& site) {
  const std::lock_guard lock(mutex_);
  if (Entry* const entry = entry_of(site); entry != nullptr) ++entry->site.refused;
}

SiteRegistry::News SiteRegistry::news(UtcTime now) {
  const std::lock_guard lock(mutex_);
  News news;
  for (auto& [name, entry] : entries_) {
    LiveSite& site = entry.site;
    const Duration age{saturated_difference(now.nanoseconds, site.heard_at.nanoseconds)};
    site.connected = site.heard_at.nanoseconds != 0 && age < kSilent;
    if (entry.reported) {
      LiveSite same = *entry.reported;
      const Duration passed{
          saturated_difference(site.heard_at.nanoseconds, same.heard_at.nanoseconds)};
      if (passed < kHeardPeriod) same.heard_at = site.heard_at;
      if (same == site) continue;
    }
    if (!site.connected && (!entry.reported || entry.reported->connected))
      news.silent.push_back(name);
    entry.reported = site;
    news.changed.push_back(site);
  }
  return news;
}

}  // namespace fieldcast::web
