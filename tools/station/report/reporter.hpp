// Makes the scheduled reports: files in a folder, and mails in the queue of the notifications. Each
// run is stored, so that none is repeated after a restart, and missed ones are made up.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "bridge/base/worker.hpp"
#include "bridge/store/sql/sql.hpp"
#include "tools/station/notify/notify_spec.hpp"
#include "tools/station/report/report_schedule.hpp"
#include "tools/station/report/report_table.hpp"

namespace fieldcast::web {

// Makes what is due. Stateless except for the connection; used by one thread.
class ReportMaker {
 public:
  // `station`: its name, in mails.
  ReportMaker(std::vector<ReportSpec> specs, std::vector<NotifyTarget> targets, std::string station,
              StoreAddress store);

  // `ended` is polled between two channels: true ends the work.
  void make_due(UtcTime now, const std::function<bool()>& ended);

 private:
  // Both fail with one line.
  using Result = tl::expected<void, std::string>;
  void make_due(const ReportSpec& spec, std::string_view via, UtcTime now,
                const std::function<bool()>& ended);
  [[nodiscard]] Result make(const ReportSpec& spec, const ReportRun& run, std::string_view via,
                            UtcTime now, const std::function<bool()>& ended);
  [[nodiscard]] tl::expected<std::string, std::string> content_of(
      const ReportSpec& spec, const ReportRun& run, const std::function<bool()>& ended);
  void queue_mails(const ReportSpec& spec, const ReportRun& run, const std::string& content,
                   UtcTime now);

  const std::vector<ReportSpec> specs_;
  const std::vector<NotifyTarget> targets_;
  const std::string station_;
  const StoreAddress address_;
  std::unique_ptr<SqlConnection> connection_;  // null: not open
  // Of a report and its way, after a failure.
  struct Failure {
    std::string what;
    UtcTime again_at;
  };
  std::map<std::string, Failure> failures_;
};

// Runs the maker on a thread of its own.
class Reporter {
 public:
  explicit Reporter(std::unique_ptr<ReportMaker> maker);

 private:
  struct Nothing {};
  const std::unique_ptr<ReportMaker> maker_;
  Worker<Nothing> worker_;  // last: its thread uses the maker
};

}  // namespace fieldcast::web
