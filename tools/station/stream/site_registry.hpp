// The state of each site of the stream, as reported by its forwarder. Any thread.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/station/model/live_objects.hpp"

namespace fieldcast::web {

// An entry of the bucket of sites (tools/forward/outlet/site_status.hpp). Empty for a text that is
// no such report, or of another version. Untrusted.
struct SiteReport {
  UtcTime at;         // by the clock of the site
  UtcTime oldest_at;  // 0: the backlog is empty
  std::uint64_t backlog_records = 0, backlog_bytes = 0;
  std::uint64_t samples = 0, late_samples = 0, lost_samples = 0;
};
[[nodiscard]] std::optional<SiteReport> site_report_from(std::string_view text);

class SiteRegistry {
 public:
  static constexpr std::size_t kMaxSites = 4096;  // further sites are left out
  static constexpr Duration kSilent = std::chrono::seconds{30};
  // A change of `heard_at` alone is reported after this time.
  static constexpr Duration kHeardPeriod = std::chrono::seconds{5};

  // Names of sites that this station reads from DDS: the stream must not change them. Call it
  // before all others.
  void reserve(std::set<std::string> names) { reserved_ = std::move(names); }
  [[nodiscard]] bool is_reserved(const std::string& site) const { return reserved_.contains(site); }

  // `stored_at`: of a message of the site, by the clock of the server.
  void heard(const std::string& site, UtcTime stored_at);
  void reported(const std::string& site, const SiteReport& report, UtcTime stored_at);
  void refused(const std::string& site);

  struct News {
    std::vector<LiveSite> changed;
    std::vector<std::string> silent;  // sites that became silent
  };
  // `now`: by the clock of this station.
  [[nodiscard]] News news(UtcTime now);

 private:
  struct Entry {
    LiveSite site;
    std::optional<LiveSite> reported;  // by the last news
  };
  // Returns null for a further or a reserved site. REQUIRES: mutex_ is held.
  Entry* entry_of(const std::string& site);

  std::set<std::string> reserved_;
  std::mutex mutex_;  // of the member below
  std::map<std::string, Entry> entries_;
};

}  // namespace fieldcast::web
