#include "tools/forward/forwarder.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"
#include "tools/forward/make_outlet.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

namespace {

// Records that wait while the queue cannot be written, for example because the disk is full.
constexpr std::size_t kMostWaiting = 10'000;

Record record_of(const std::string& site, const DeviceCatalogue& catalogue) {
  return {.kind = RecordKind::kCatalogue,
          .bus = catalogue.bus,
          .device = catalogue.device,
          .identity = identity_of(catalogue),
          .body = encode(site, catalogue)};
}

Record record_of(const SampleBatch& batch) {
  return {.kind = RecordKind::kSamples,
          .bus = batch.bus,
          .device = batch.device,
          .epoch = batch.epoch,
          .identity = identity_of(batch),
          .samples = static_cast<std::uint32_t>(batch.samples.size()),
          .body = encode(batch)};
}

Record record_of(const std::string& site, const StationAlarmStatus& alarm,
                 const Position& position) {
  return {.kind = RecordKind::kAlarm,
          .bus = alarm.alarm.bus,
          .device = alarm.alarm.device,
          .epoch = position.epoch,
          .identity = position.sequence,
          .body = encode(site, alarm)};
}

Record record_of(const std::string& site, const AuditReport& entry) {
  return {.kind = RecordKind::kAudit,
          .bus = entry.bridge,
          .epoch = entry.epoch,
          .identity = identity_of(entry),
          .body = encode(site, entry)};
}

// Names of channels contain no space.
std::string position_name_of(const AuditReport& entry) { return entry.bridge + " audit"; }

}  // namespace

Forwarder::Forwarder(const ForwardSpec& spec)
    : spec_(spec), queue_(spec.queue), sender_(spec.send, queue_), gatherer_(spec.gather) {
  for (const NamedPosition& position : queue_.positions()) {
    // The name of an alarm ends with its limit: "bus/device/channel high"; see position_name_of().
    if (position.name.find(' ') != std::string::npos) {
      alarm_positions_[position.name] = position.position;
    } else {
      gatherer_.restore(position);
    }
  }
  for (const Gap& gap : queue_.gaps()) (void)open_gaps_.add(gap, steady_now());
}

std::uint64_t needed_space(std::uint64_t max_bytes, std::uint64_t bytes) {
  constexpr std::uint64_t kLog = 100'000'000;  // of SQLite, beside the records
  return kLog + (bytes < max_bytes ? max_bytes - bytes : 0);
}

void Forwarder::check_disk() const {
  std::error_code error;
  const auto folder = std::filesystem::absolute(spec_.queue.path, error).parent_path();
  const auto space = std::filesystem::space(folder, error);
  const std::uint64_t needed = needed_space(spec_.queue.max_bytes, queue_.counters().bytes);
  if (error || space.available >= needed) return;
  log_warning("queue",
              fmt::format("{} has {} MB free, and the queue may need {} MB; free the disk, or "
                          "configure a smaller max-size",
                          folder.string(), space.available / 1'000'000, needed / 1'000'000));
}

void Forwarder::start() {
  check_disk();
  worker_.emplace("gather", 1, [this](BoundedQueue<int>& commands) { gather(commands); });
  station_ = std::make_unique<Station>(spec_.dds, "fieldcast-forward-" + spec_.site);
  subscribe();
  if (spec_.commands)
    commands_ =
        std::make_unique<CommandService>(*spec_.commands, spec_.queue.path + "-commands",
                                         [this](const CommandRequest& request, Duration lifespan) {
                                           return execute(request, lifespan);
                                         });
  sender_.start(make_outlet(
      spec_.outlet,
      {.site = spec_.site,
       .payload = spec_.payload,
       .catalogue = [this](std::uint64_t identity) { return queue_.catalogue(identity); },
       .in_flight = spec_.send.in_flight,
       .wake = [this] { sender_.wake(); },
       .count_connection = [this] { return queue_.count_up("outlet connections"); },
       .is_announced =
           [this](const std::string& bus, const std::string& device) {
             const std::lock_guard lock(mutex_);
             return gatherer_.has(bus, device);
           },
       .on_command = commands_ ? std::function([this](CentreRequest request) {
         commands_->on_request(std::move(request));
       })
                               : nullptr}));
  fetcher_.emplace("fetch", 1, [this](BoundedQueue<int>& commands) { fetch(commands); });
}

// A bridge that is known already has the whole life span.
StationOutcome Forwarder::execute(const CommandRequest& request, Duration lifespan) {
  StationOutcome outcome = execute(request, CommandTimes{{}, lifespan});
  if (outcome || outcome.error() != StationFault::kNoBridge) return outcome;
  return execute(request, times_within(lifespan));
}

StationOutcome Forwarder::execute(const CommandRequest& request, const CommandTimes& times) {
  constexpr Duration kResult = std::chrono::seconds{3};
  const ChannelPath& path = request.channel;
  if (const auto kind = alarm_action_of(request.action))
    return station_->execute(
        AlarmAction{.kind = *kind,
                    .alarm = {path.bus, path.device, path.channel, request.limit},
                    .by = request.user,
                    .note = request.note,
                    .duration = std::chrono::minutes{request.minutes},
                    .raised_at = request.raised_at},
        times.finding, times.lifespan + kResult);
  StationCommand command{.bus = path.bus,
                         .command = {.device = path.device, .target = ChannelTarget{path.channel}},
                         .lifespan = times.lifespan,
                         .person = request.user};
  if (request.action == CentreAction::kAcquire) {
    command.command.operation = Operation::kAcquire;
  } else {
    command.command.values = {request.value};
    command.command.verify = request.verify;
  }
  return station_->execute(std::move(command), times.finding, kResult);
}

void Forwarder::subscribe() {
  station_->subscribe_channels(
      [this](const StationChannel& channel) {
        const std::lock_guard lock(mutex_);
        gatherer_.on_channel(channel);
      },
      [this](const std::string& bus, const std::string& device, const std::string& channel) {
        const std::lock_guard lock(mutex_);
        gatherer_.on_channel_removed(bus, device, channel);
      });
  station_->subscribe_alarm_status([this](const StationAlarmStatus& alarm) { on_alarm(alarm); });
  station_->subscribe<AuditReport>([this](const AuditReport& entry) { on_audit(entry); });
  station_->subscribe_samples([this](const StationSample& sample) {
    const Instant now = steady_now();
    const std::lock_guard lock(mutex_);
    gatherer_.on_sample(sample, now);
  });
}

void Forwarder::on_alarm(const StationAlarmStatus& alarm) {
  const std::lock_guard lock(mutex_);
  const std::string name = to_text(alarm.alarm);
  const auto known = alarm_positions_.find(name);
  const bool is_known = known != alarm_positions_.end();
  const auto position = next_position(is_known ? known->second : Position{}, alarm);
  if (!position) return;
  if (alarms_.size() >= kMaxAlarms || (!is_known && alarm_positions_.size() >= kMaxKnownAlarms)) {
    ++lost_alarms_;
    return;
  }
  alarm_positions_[name] = *position;
  alarms_.push_back({alarm, *position});
}

void Forwarder::on_audit(const AuditReport& entry) {
  const Position position{entry.epoch, entry.number};
  const std::lock_guard lock(mutex_);
  const std::string name = position_name_of(entry);
  const auto known = alarm_positions_.find(name);
  const bool is_new = known == alarm_positions_.end();
  if (!is_new && is_known(known->second, entry)) return;
  if (audit_.size() >= kMaxAlarms || (is_new && alarm_positions_.size() >= kMaxKnownAlarms)) {
    ++lost_alarms_;
    return;
  }
  alarm_positions_[name] = position;
  audit_.push_back(entry);
}

void Forwarder::stop() {
  // The outlet ends after the commands, whose responses it sends.
  if (commands_) commands_->close();
  fetcher_.reset();
  station_.reset();
  worker_.reset();
  sender_.stop();
}

void Forwarder::gather(BoundedQueue<int>& commands) {
  Instant cleaned = steady_now();
  while (!commands.pause(records_.empty() ? kLook : kLookAfterFault)) {
    check_clock();
    append(false);
    turned_ = steady_now();
    if (steady_now() - cleaned < kClean) continue;
    cleaned = steady_now();
    try {
      queue_.clean(read_clocks().utc);
    } catch (const StoreError& error) {
      log_counted(LogLevel::kError, "queue", "faults of the queue", error.what());
    }
  }
  append(true);
  if (!records_.empty())
    log_error("queue",
              fmt::format("{} messages could not be stored and are lost", records_.size()));
}

// Order and repetitions do not depend on the clock, but the ages of waiting messages do.
void Forwarder::check_clock() {
  const Duration step = clock_steps_.on_reading(read_clocks());
  if (step == Duration{}) return;
  const bool is_back = step < Duration{};
  const bool is_too_early = !is_back && spec_.queue.keep != Duration{};
  const Duration size = std::chrono::round<std::chrono::seconds>(is_back ? -step : step);
  log_warning(
      "clock",
      fmt::format("the clock of this machine was set {} by {}: the ages of waiting messages "
                  "are wrong by as much{}",
                  is_back ? "back" : "forward", fieldcast::to_text(size),
                  is_too_early ? ", and queue.keep may remove them too early" : ""));
}

void Forwarder::append(bool all) {
  if (records_.size() < kMostWaiting) collect(all);
  if (records_.empty() && gaps_.empty()) return;
  try {
    queue_.append(records_, positions_, read_clocks().utc, gaps_);
  } catch (const StoreError& error) {
    log_counted(LogLevel::kError, "queue", "faults of the queue",
                fmt::format("{}; {} messages wait in memory", error.what(), records_.size()));
    return;
  }
  records_.clear();
  positions_.clear();
  gaps_.clear();
  sender_.wake();
}

void Forwarder::collect(bool all) {
  std::vector<Gathered> batches;
  std::vector<NumberedAlarm> alarms;
  std::vector<AuditReport> audit;
  std::vector<std::vector<GapChange>> fetched;
  {
    const std::lock_guard lock(mutex_);
    batches = gatherer_.take(steady_now(), all);
    alarms = std::exchange(alarms_, {});
    audit = std::exchange(audit_, {});
    fetched = std::exchange(fetched_, {});
  }
  for (Gathered& gathered : batches) {
    for (Gap& gap : gathered.gaps) open(std::move(gap));
    if (gathered.catalogue) records_.push_back(record_of(spec_.site, *gathered.catalogue));
    records_.push_back(record_of(gathered.batch));
    records_.back().is_late = gathered.is_late;
    std::move(gathered.positions.begin(), gathered.positions.end(), std::back_inserter(positions_));
  }
  for (std::vector<GapChange>& changes : fetched)
    std::move(changes.begin(), changes.end(), std::back_inserter(gaps_));
  for (const auto& [alarm, position] : alarms) {
    records_.push_back(record_of(spec_.site, alarm, position));
    positions_.push_back({to_text(alarm.alarm), position});
  }
  for (const AuditReport& entry : audit) {
    records_.push_back(record_of(spec_.site, entry));
    positions_.push_back({position_name_of(entry), {entry.epoch, entry.number}});
  }
}

void Forwarder::open(Gap gap) {
  const std::lock_guard lock(mutex_);
  if (open_gaps_.add(gap, steady_now())) {
    gaps_.push_back({std::move(gap)});
  } else {
    ++refused_gaps_;
  }
}

void Forwarder::fetch(BoundedQueue<int>& commands) {
  while (!commands.pause(kFetch)) {
    bool has_fetched = false;
    while (!commands.closed() && fetch_part()) {
      has_fetched = true;
      while (is_full() && !commands.pause(kLook)) {}
    }
    if (has_fetched) station_->end_history();
  }
}

bool Forwarder::is_full() const {
  const std::lock_guard lock(mutex_);
  return fetched_.size() >= kMaxFetched;
}

bool Forwarder::fetch_part() {
  std::optional<HistoryRequest> request;
  {
    const std::lock_guard lock(mutex_);
    request = open_gaps_.next(steady_now());
  }
  if (!request) return false;
  auto response = station_->history(*request);
  const std::lock_guard lock(mutex_);
  // A bus may be removed while the response is sent, for example by a reload. Its samples have no
  // channels until it is announced again.
  if (!response || !gatherer_.has_bus(request->bus)) {
    if (!response && response.error() == StationFault::kNoRight &&
        !std::exchange(is_right_reported_, true))
      log_warning("fetch", Station::kNoHistoryRight);
    open_gaps_.on_failure(request->bus, steady_now());
    return true;
  }
  GapTable::Progress progress =
      open_gaps_.on_response(*request, *std::move(response), steady_now());
  if (!progress.refusal.empty()) {
    log_counted(LogLevel::kWarning, request->bus, "samples that the bridge cannot deliver again",
                fmt::format("samples are missing: {}", progress.refusal));
  }
  fetched_samples_ += progress.samples;
  if (open_gaps_.size() == 0 && fetched_samples_ != 0) {
    log_info("fetch", fmt::format("{} missing samples were fetched from the stores of bridges",
                                  std::exchange(fetched_samples_, 0)));
  }
  for (Fetched& part : progress.fetched) gatherer_.on_fetched(std::move(part));
  fetched_.push_back(std::move(progress.changes));
  return true;
}

SiteStatus Forwarder::status() {
  const Queue::Counters queue = queue_.counters();
  const Sender::Counters sent = sender_.counters();
  SiteStatus status{.site = spec_.site,
                    .at = read_clocks().utc,
                    .started_at = started_at_,
                    .is_connected = sent.is_ready,
                    .backlog_records = queue.records,
                    .backlog_bytes = queue.bytes,
                    .oldest_at = queue_.oldest(),
                    .thinned_samples = queue.thinned,
                    .dropped_samples = queue.dropped_samples,
                    .dropped_records = queue.dropped_records,
                    .acknowledged_samples = sent.samples,
                    .late_samples = sent.late,
                    .acknowledged_messages = sent.messages,
                    .acknowledged_bytes = sent.bytes,
                    .repeated_messages = sent.repeated,
                    .refused_messages = sent.refused};
  const std::lock_guard lock(mutex_);
  status.lost_samples = gatherer_.counters().refused;
  status.devices = gatherer_.devices();
  status.open_gaps = open_gaps_.size();
  return status;
}

std::vector<BusTurn> Forwarder::turns() const {
  return {{"queue", turned_.load()}, {"sender", sender_.counters().turned}};
}

void Forwarder::report() {
  const SiteStatus now = status();
  sender_.report(now);
  if (now.thinned_samples != logged_.thinned_samples ||
      now.dropped_records != logged_.dropped_records) {
    log_warning("queue",
                fmt::format("the queue is full or too old: {} samples thinned out, {} messages "
                            "with {} samples dropped since the last report",
                            now.thinned_samples - logged_.thinned_samples,
                            now.dropped_records - logged_.dropped_records,
                            now.dropped_samples - logged_.dropped_samples));
  }
  std::uint64_t lost_alarms = 0, refused_gaps = 0;
  {
    const std::lock_guard lock(mutex_);
    refused_gaps = std::exchange(refused_gaps_, 0);
    lost_alarms = std::exchange(lost_alarms_, 0);
  }
  if (now.lost_samples != logged_.lost_samples || lost_alarms != 0) {
    log_warning("gather",
                fmt::format("the queue cannot be written fast enough: {} samples and {} alarms "
                            "or audit entries lost since the last report",
                            now.lost_samples - logged_.lost_samples, lost_alarms));
  }
  if (refused_gaps != 0) {
    log_warning("fetch", fmt::format("{} gaps of channels are not filled: more than {} are open",
                                     refused_gaps, GapTable::kMaxGaps));
  }
  logged_ = now;
}

std::string to_text(const SiteStatus& status) {
  return fmt::format(
      "{}, {} messages wait ({:.1f} kB), {} samples ({} late) in {} messages acknowledged, {} "
      "messages repeated, {} refused, {} gaps open",
      status.is_connected ? "connected" : "not connected", status.backlog_records,
      static_cast<double>(status.backlog_bytes) / 1e3, status.acknowledged_samples,
      status.late_samples, status.acknowledged_messages, status.repeated_messages,
      status.refused_messages, status.open_gaps);
}

}  // namespace fieldcast::forward
