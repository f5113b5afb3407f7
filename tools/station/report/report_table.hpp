// Saved reports, and the runs of scheduled ones, in the store. Throws StoreError. One owner, the
// thread of the connection.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "bridge/store/sql/sql.hpp"
#include "core/base/time.hpp"

namespace fieldcast::web {

struct SavedReport {
  std::string name;
  std::string query;  // of the address of the page: "c=line%2F*&by=day&span=7d"
  std::string saved_by;
  UtcTime saved_at;
};

class SavedReportTable {
 public:
  static constexpr std::size_t kMaxReports = 200;

  explicit SavedReportTable(SqlConnection& connection) : connection_(connection) {}

  [[nodiscard]] std::vector<SavedReport> list();  // sorted by name
  // Replaces a report of this name. Returns false if the name is new and there are kMaxReports.
  [[nodiscard]] bool save(const SavedReport& report);
  [[nodiscard]] bool remove(const std::string& name);  // false: there is none

 private:
  SqlConnection& connection_;
};

struct StoredReportRun {
  std::string report;
  std::string via;     // "folder" or "mail"
  std::string period;  // of the report: "2026-11-28" or "2026-11"
  UtcTime made_at;
  std::string result;  // the file, or the number of mails
};

class ReportRunTable {
 public:
  static constexpr Duration kKept = std::chrono::hours{24 * 400};

  explicit ReportRunTable(SqlConnection& connection) : connection_(connection) {}

  // The last period of the same kind as `like`, which is "2026-11-28" or "2026-11". Empty if none.
  [[nodiscard]] std::string last(const std::string& report, std::string_view via,
                                 std::string_view like);
  // Also removes runs older than kKept. A known run is ignored.
  void put(const StoredReportRun& run);
  [[nodiscard]] std::vector<StoredReportRun> newest(std::int64_t limit);

 private:
  SqlConnection& connection_;
};

}  // namespace fieldcast::web
