#include "tools/station/record/back_filler.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "bridge/base/clock.hpp"
#include "bridge/log/log.hpp"

namespace fieldcast::web {

namespace {

constexpr int kNiceness = 15;  // lower priority than the store's writer
constexpr Duration kLongestQuery = std::chrono::seconds{5};

std::string time_text(UtcTime time) {
  const auto seconds = static_cast<std::time_t>(time.nanoseconds / 1'000'000'000);
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(seconds));
}

}  // namespace

BackFiller::BackFiller(BackfillSpec spec, Station& station, Recorder& recorder)
    : spec_(std::move(spec)),
      station_(station),
      recorder_(recorder),
      worker_("back-fill", 1, [this](BoundedQueue<int>& commands) { run(commands); }) {
  recorder_.watch_gaps();
}

void BackFiller::run(BoundedQueue<int>& commands) {
  // On Linux, this applies only to this thread.
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNiceness);
  while (!commands.pause(kLook)) {
    look();
    bool has_fetched = false;
    while (!commands.closed()) {
      if (recorder_.is_busy()) {
        (void)commands.pause(kBusy);
      } else if (fetch_part()) {
        has_fetched = true;
      } else {
        break;
      }
    }
    if (has_fetched) station_.end_history();
  }
}

void BackFiller::look() {
  Recorder::Gaps found = recorder_.take_gaps();
  for (Gap& gap : found.gaps) add(std::move(gap));
  std::move(found.first.begin(), found.first.end(), std::back_inserter(first_));
  if (first_.empty()) return;
  try {
    if (!connection_) {
      connection_ = open_store(spec_.store, IfMissing::kFail);
      make_read_only(*connection_);
    }
    while (!first_.empty()) {
      connection_->limit(std::chrono::steady_clock::now() + kLongestQuery);
      open(first_.back());
      first_.pop_back();
    }
  } catch (const StoreError& error) {
    log_counted(LogLevel::kWarning, "back-fill", "looks into the record that failed", error.what());
  }
  connection_.reset();
}

void BackFiller::open(const FirstSample& first) {
  SampleTable table(*connection_);
  const auto path = ChannelPath::parse(first.path);
  const auto channel = path ? table.find(*path) : std::nullopt;
  if (!channel) return;
  // The sample itself may be stored by now.
  const auto stored = table.newest(channel->id, first.published_at);
  if (!stored) return;
  stored_[first.path] = *stored;
  add({first.path, {}, first.number, stored->published_at});
}

void BackFiller::add(Gap gap) {
  const UtcTime oldest{saturated_difference(read_clocks().utc.nanoseconds, spec_.longest.count())};
  gap.since = std::max(gap.since, oldest);
  (void)gaps_.add(gap, steady_now());  // at the limit, the gap stays in the record
}

bool BackFiller::fetch_part() {
  const auto request = gaps_.next(steady_now());
  if (!request) return false;
  auto response = station_.history(*request);
  if (!response) {
    if (response.error() == StationFault::kNoRight && !std::exchange(is_right_reported_, true))
      log_warning("back-fill", Station::kNoHistoryRight);
    gaps_.on_failure(request->bus, steady_now());
    return true;
  }
  GapTable::Progress progress = gaps_.on_response(*request, *std::move(response), steady_now());
  if (!progress.refusal.empty() &&
      std::exchange(refused_[request->bus], progress.refusal) != progress.refusal)
    log_warning("back-fill",
                fmt::format("samples of bus {} stay missing: {}", request->bus, progress.refusal));
  for (const Fetched& fetched : progress.fetched) record(fetched);
  for (const GapChange& change : progress.changes)
    if (change.is_closed) stored_.erase(change.gap.path);
  if (!gaps_.has(request->bus)) report(request->bus);
  return true;
}

void BackFiller::record(const Fetched& fetched) {
  Filled& filled = filled_[fetched.bus];
  for (const auto& [name, row] : fetched.samples) {
    const std::string path = fetched.bus + '/' + fetched.device + '/' + name;
    const auto stored = stored_.find(path);
    // The range begins with the time of the stored sample, which has it by acquisition.
    if (stored != stored_.end() && stored->second.is_same({.acquired_at = row.acquired_at,
                                                           .sequence = row.number.sequence,
                                                           .quality = row.quality}))
      continue;
    filled.from = filled.samples == 0 ? row.published_at : std::min(filled.from, row.published_at);
    filled.to = std::max(filled.to, row.published_at);
    ++filled.samples;
    recorder_.on_fetched(path, row);
  }
}

void BackFiller::report(const std::string& bus) {
  const auto node = filled_.extract(bus);
  if (!node || node.mapped().samples == 0) return;
  const Filled& filled = node.mapped();
  log_info("back-fill",
           fmt::format("back-filled {} samples of bus {}, {} to {} UTC", filled.samples, bus,
                       time_text(filled.from), time_text(filled.to)));
}

}  // namespace fieldcast::web
