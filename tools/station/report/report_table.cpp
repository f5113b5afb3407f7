#include "tools/station/report/report_table.hpp"

namespace fieldcast::web {

std::vector<SavedReport> SavedReportTable::list() {
  std::vector<SavedReport> found;
  connection_.query("select name, query, saved_by, saved_at from reports order by name", {},
                    [&](const SqlRow& row) {
                      found.push_back({text_at(row, 0), text_at(row, 1), text_at(row, 2),
                                       UtcTime{integer_at(row, 3)}});
                      return true;
                    });
  return found;
}

bool SavedReportTable::save(const SavedReport& report) {
  return connection_.execute(
             "insert into reports (name, query, saved_by, saved_at) select cast($1 as text), "
             "cast($2 as text), cast($3 as text), cast($4 as bigint) where exists (select 1 from "
             "reports where name = $1) or (select count(*) from reports) < $5 on conflict (name) "
             "do update set query = excluded.query, saved_by = excluded.saved_by, saved_at = "
             "excluded.saved_at",
             SqlRow{report.name, report.query, report.saved_by, report.saved_at.nanoseconds,
                    static_cast<std::int64_t>(kMaxReports)}) > 0;
}

bool SavedReportTable::remove(const std::string& name) {
  return connection_.execute("delete from reports where name = $1", SqlRow{name}) == 1;
}

std::string ReportRunTable::last(const std::string& report, std::string_view via,
                                 std::string_view like) {
  std::string period;
  connection_.query(
      "select coalesce(max(period), '') from report_runs where report = $1 and via = $2 and "
      "length(period) = $3",
      {report, std::string(via), static_cast<std::int64_t>(like.size())}, [&](const SqlRow& row) {
        period = text_at(row, 0);
        return false;
      });
  return period;
}

void ReportRunTable::put(const StoredReportRun& run) {
  connection_.execute(
      "insert into report_runs (report, via, period, made_at, result) values ($1, $2, $3, $4, $5) "
      "on conflict do nothing",
      SqlRow{run.report, run.via, run.period, run.made_at.nanoseconds, run.result});
  connection_.execute("delete from report_runs where made_at < $1",
                      SqlRow{run.made_at.nanoseconds - kKept.count()});
}

std::vector<StoredReportRun> ReportRunTable::newest(std::int64_t limit) {
  std::vector<StoredReportRun> found;
  connection_.query(
      "select report, via, period, made_at, result from report_runs order by made_at desc, report, "
      "via limit $1",
      {limit}, [&](const SqlRow& row) {
        found.push_back({text_at(row, 0), text_at(row, 1), text_at(row, 2),
                         UtcTime{integer_at(row, 3)}, text_at(row, 4)});
        return true;
      });
  return found;
}

}  // namespace fieldcast::web
