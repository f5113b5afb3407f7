#include "tools/station/report/reporter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "bridge/security/file_access.hpp"
#include "bridge/security/pki.hpp"
#include "bridge/store/notification_table.hpp"
#include "core/base/message_text.hpp"
#include "tools/station/notify/message_id.hpp"
#include "tools/station/notify/message_text.hpp"
#include "tools/station/report/report_reader.hpp"
#include "tools/station/report/report_xlsx.hpp"

namespace fieldcast::web {
namespace {

constexpr std::chrono::seconds kTurn{5};
constexpr Duration kPause = std::chrono::minutes{1};         // after a failure
constexpr Duration kLongestQuery = std::chrono::seconds{5};  // of one channel
constexpr mode_t kMode = 0640;
constexpr std::string_view kFolder = "folder", kMail = "mail";

tl::expected<void, std::string> write_file(const std::string& folder, const std::string& name,
                                           const std::string& content) {
  std::error_code ignored;  // the write reports a missing folder
  std::filesystem::create_directory(folder, ignored);
  try {
    security::replace(folder + '/' + name, content, kMode);
  } catch (const security::SecurityError& error) {
    return tl::make_unexpected(std::string(error.what()));
  }
  return {};
}

}  // namespace

ReportMaker::ReportMaker(std::vector<ReportSpec> specs, std::vector<NotifyTarget> targets,
                         std::string station, StoreAddress store)
    : specs_(std::move(specs)),
      targets_(std::move(targets)),
      station_(std::move(station)),
      address_(std::move(store)) {}

void ReportMaker::make_due(UtcTime now, const std::function<bool()>& ended) {
  for (const ReportSpec& spec : specs_) {
    if (!spec.folder.empty()) make_due(spec, kFolder, now, ended);
    if (!spec.mail.empty()) make_due(spec, kMail, now, ended);
  }
}

void ReportMaker::make_due(const ReportSpec& spec, std::string_view via, UtcTime now,
                           const std::function<bool()>& ended) {
  const std::string key = fmt::format("{} by {}", spec.name, via);
  const auto failed = failures_.find(key);
  if (failed != failures_.end() && now < failed->second.again_at) return;
  Result result;
  try {
    if (!connection_) connection_ = open_store(address_, IfMissing::kCreate);
    const std::string like = spec.monthly ? "2026-11" : "2026-11-28";
    const std::string last = ReportRunTable(*connection_).last(spec.name, via, like);
    for (const ReportRun& run : due_runs(spec, last, now)) {
      result = make(spec, run, via, now, ended);
      if (!result || ended()) break;
      log_info("report", fmt::format("{}: {} is made", key, run.period));
    }
  } catch (const StoreError& error) {
    connection_.reset();
    result = tl::make_unexpected(std::string(error.what()));
  }
  if (result) {
    failures_.erase(key);
    return;
  }
  Failure& failure = failures_[key];
  if (std::exchange(failure.what, result.error()) != failure.what)
    log_error("report", fmt::format("{} is not made; the next attempt is in a minute: {}", key,
                                    failure.what));
  failure.again_at = {now.nanoseconds + kPause.count()};
}

ReportMaker::Result ReportMaker::make(const ReportSpec& spec, const ReportRun& run,
                                      std::string_view via, UtcTime now,
                                      const std::function<bool()>& ended) {
  const auto content = content_of(spec, run, ended);
  if (!content) return tl::make_unexpected(content.error());
  if (ended()) return {};
  const std::string name = report_file_name(spec, run);
  StoredReportRun row{spec.name, std::string(via), run.period, now, name};
  // A file that was written before the row was stored is written again, with the same name.
  if (via == kFolder) {
    if (auto written = write_file(spec.folder, name, *content); !written) return written;
  }
  SqlTransaction transaction(*connection_);
  if (via == kMail) queue_mails(spec, run, *content, now);
  ReportRunTable(*connection_).put(row);
  transaction.commit();
  return {};
}

tl::expected<std::string, std::string> ReportMaker::content_of(const ReportSpec& spec,
                                                               const ReportRun& run,
                                                               const std::function<bool()>& ended) {
  const auto limit = [this] {
    connection_->limit(std::chrono::steady_clock::now() + kLongestQuery);
  };
  limit();
  auto channels = channels_of(*connection_, spec.channels);
  if (channels.size() > kMaxReported)
    return tl::make_unexpected(fmt::format("its patterns match {} channels; at most {} are allowed",
                                           channels.size(), kMaxReported));
  const auto periods = periods_of(spec, run);
  std::vector<ReportTable> tables;
  for (const ChannelPath& channel : channels) {
    if (ended()) return std::string();
    limit();
    tables.push_back(read_table(*connection_, channel, periods));
  }
  limit();
  if (spec.csv) return report_csv(tables);
  return report_xlsx(tables);
}

void ReportMaker::queue_mails(const ReportSpec& spec, const ReportRun& run,
                              const std::string& content, UtcTime now) {
  NotificationTable queue(*connection_);
  const std::string name = report_file_name(spec, run), attachment = base64(content);
  for (const NotifyTarget& target : targets_) {
    if (std::ranges::find(spec.mail, target.name) == spec.mail.end()) continue;
    for (const std::string& recipient : target.mail) {
      Notification message;
      message.id = message_id({"report", station_, spec.name, run.period, target.name, recipient});
      message.target = target.name;
      message.recipient = recipient;
      message.made_at = now;
      message.subject =
          fmt::format("Report {} {} of the station {}", spec.name, run.period, station_);
      message.text =
          fmt::format("The report {} of {} is attached: {}\n", spec.name, run.period, name);
      message.attachment_name = name;
      message.attachment = attachment;
      queue.put(message);
    }
  }
}

Reporter::Reporter(std::unique_ptr<ReportMaker> maker)
    : maker_(std::move(maker)), worker_("reports", 1, [this](BoundedQueue<Nothing>& queue) {
        do {
          maker_->make_due(read_clocks().utc, [&queue] { return queue.closed(); });
        } while (!queue.pause(kTurn));
      }) {}

}  // namespace fieldcast::web
