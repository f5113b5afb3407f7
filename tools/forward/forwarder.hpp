// The parts of a forwarder, and the order in which they start and stop: the queue, the sender, then
// the DDS domain. Samples pass from the threads of DDS by a lock to the thread `gather`, which
// appends batches to the queue; the thread `sender` publishes them.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridge/base/clock.hpp"
#include "bridge/base/worker.hpp"
#include "bridge/service/service.hpp"
#include "bridge/station/station.hpp"
#include "tools/backfill/gap_table.hpp"
#include "tools/forward/batch/gatherer.hpp"
#include "tools/forward/clock_steps.hpp"
#include "tools/forward/command/command_service.hpp"
#include "tools/forward/send/sender.hpp"
#include "tools/forward/settings/configuration.hpp"

namespace fieldcast::forward {

class Forwarder {
 public:
  // Opens the queue. Throws StoreError.
  explicit Forwarder(const ForwardSpec& spec);
  ~Forwarder() { stop(); }
  Forwarder(const Forwarder&) = delete;
  Forwarder& operator=(const Forwarder&) = delete;

  // Joins the domain. Throws DdsError.
  void start();
  // Leaves the domain and appends what was received. Records without an acknowledgement stay in the
  // queue. May be called twice.
  void stop();

  // Any thread. Throws StoreError.
  [[nodiscard]] SiteStatus status();
  // Passes the state to the engine, and logs what was removed or refused since the last call.
  void report();
  // Last turns of the threads, for the watchdog.
  [[nodiscard]] std::vector<BusTurn> turns() const;

 private:
  // Between two looks for batches that have ended.
  static constexpr Duration kLook = std::chrono::milliseconds{50};
  // The same while the queue cannot be written.
  static constexpr Duration kLookAfterFault = std::chrono::seconds{1};
  static constexpr Duration kClean = std::chrono::minutes{1};
  // Between two looks for samples that must be fetched, and responses that wait to be appended.
  static constexpr Duration kFetch = std::chrono::seconds{1};
  static constexpr std::size_t kMaxFetched = 8;
  // Alarms that wait for the thread `gather`, and known alarms. Further ones are dropped and
  // counted.
  static constexpr std::size_t kMaxAlarms = 20'000, kMaxKnownAlarms = 100'000;

  struct NumberedAlarm {
    StationAlarmStatus alarm;
    Position position;
  };

  void subscribe();
  [[nodiscard]] StationOutcome execute(const CommandRequest& request, Duration lifespan);
  [[nodiscard]] StationOutcome execute(const CommandRequest& request, const CommandTimes& times);
  void check_disk() const;
  void on_alarm(const StationAlarmStatus& alarm);
  void on_audit(const AuditReport& entry);
  void gather(BoundedQueue<int>& commands);
  void check_clock();
  // Appends what has ended; keeps it for the next call if the queue cannot be written.
  void append(bool all);
  void collect(bool all);
  void fetch(BoundedQueue<int>& commands);
  // Returns false if no request is due.
  [[nodiscard]] bool fetch_part();
  // As many responses as possible wait for the thread `gather`.
  [[nodiscard]] bool is_full() const;
  void open(Gap gap);

  const ForwardSpec spec_;
  Queue queue_;
  Sender sender_;

  mutable std::mutex mutex_;  // protects the members below, to lost_alarms_
  GapTable open_gaps_;
  // Of each response whose samples wait for the thread `gather`.
  std::vector<std::vector<GapChange>> fetched_;
  std::uint64_t refused_gaps_ = 0;     // since the last report
  std::uint64_t fetched_samples_ = 0;  // since the last report
  bool is_right_reported_ = false;     // that this program may not fetch samples
  Gatherer gatherer_;
  std::vector<NumberedAlarm> alarms_;
  std::vector<AuditReport> audit_;
  std::map<std::string, Position, std::less<>> alarm_positions_;  // and of the audits
  std::uint64_t lost_alarms_ = 0;                                 // since the last report

  // Of the thread `gather`.
  std::vector<Record> records_;  // not appended yet
  std::vector<NamedPosition> positions_;
  std::vector<GapChange> gaps_;
  ClockSteps clock_steps_;

  const UtcTime started_at_ = read_clocks().utc;
  std::atomic<Instant> turned_{steady_now()};  // of the thread `gather`
  SiteStatus logged_;

  std::unique_ptr<Station> station_;
  std::unique_ptr<CommandService> commands_;  // null: not accepted
  std::optional<Worker<int>> worker_, fetcher_;
};

// Free bytes of the disk that a queue with `bytes` needs. It has more than `max_bytes` if
// `queue.max-size` was reduced, until the first append.
[[nodiscard]] std::uint64_t needed_space(std::uint64_t max_bytes, std::uint64_t bytes);

// One line: "connected, 12 messages wait (3.1 kB), 12000 samples acknowledged, ..".
[[nodiscard]] std::string to_text(const SiteStatus& status);

}  // namespace fieldcast::forward
