#include "tools/backfill/gap_table.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace fieldcast {

namespace {

std::string bus_of(const std::string& path) { return path.substr(0, path.find('/')); }

std::string path_of(const std::string& bus, const HistoryRange& range) {
  return bus + '/' + range.device + '/' + range.channel;
}

// Nothing can be missing any more. The number of samples of an earlier epoch is not known.
bool is_filled(const SampleNumber& after, const SampleNumber& until) {
  return after.epoch == until.epoch && after.sequence + 1 >= until.sequence;
}

}  // namespace

bool GapTable::add(const Gap& gap, Instant found) {
  if (size_ >= kMaxGaps) return false;
  const auto [open, is_new] = buses_[bus_of(gap.path)].channels[gap.path].insert_or_assign(
      gap.until, Open{gap.after, gap.since, found, found + kSettle});
  size_ += is_new ? 1 : 0;
  return true;
}

std::optional<HistoryRequest> GapTable::next(Instant now) const {
  // The ranges name the ends of the gaps: the clock of this machine may differ from the bridge's.
  constexpr UtcTime kAnyTime{std::numeric_limits<std::int64_t>::max()};
  for (const auto& [name, bus] : buses_) {
    if (bus.due > now) continue;
    HistoryRequest request{.bus = name, .until = kAnyTime};
    for (const auto& [path, gaps] : bus.channels) {
      const auto& [until, open] = *gaps.begin();
      if (open.due > now) continue;
      const std::size_t device = name.size() + 1, slash = path.find('/', device);
      request.channels.push_back({.device = path.substr(device, slash - device),
                                  .channel = path.substr(slash + 1),
                                  .since = open.since,
                                  .after = open.after,
                                  .until = until});
      if (request.channels.size() == HistoryRequest::kMostChannels) break;
    }
    if (!request.channels.empty()) return request;
  }
  return std::nullopt;
}

void GapTable::close(Bus& bus, const std::string& path, const SampleNumber& until) {
  const auto channel = bus.channels.find(path);
  size_ -= channel->second.erase(until);
  if (channel->second.empty()) bus.channels.erase(channel);
}

// A sample of an unknown epoch was stored by an older version. It is in a gap only if the epoch of
// the sample before the gap is unknown too.
bool GapTable::accept(const HistoryRow& row, const SampleNumber& until, Open& open) {
  const SampleNumber& at = row.number;
  if (at.epoch == 0) {
    if (open.after.epoch != 0 ||
        std::pair(row.published_at, at.sequence) <= std::pair(open.since, open.after.sequence))
      return false;
    open.since = row.published_at;
  } else if (at <= open.after || at >= until) {
    return false;
  }
  open.after = at;
  return true;
}

void GapTable::accept(const HistoryRequest& request, std::vector<HistoryRow> rows, Bus& bus,
                      Progress& progress) {
  for (HistoryRow& row : rows) {
    const HistoryRange& range = request.channels[row.channel];
    const auto channel = bus.channels.find(path_of(request.bus, range));
    if (channel == bus.channels.end()) continue;
    const auto open = channel->second.find(range.until);
    if (open == channel->second.end() || !accept(row, range.until, open->second)) continue;
    const std::uint64_t epoch = row.number.epoch;
    if (progress.fetched.empty() || progress.fetched.back().device != range.device ||
        progress.fetched.back().epoch != epoch)
      progress.fetched.push_back({request.bus, range.device, epoch, {}});
    progress.fetched.back().samples.emplace_back(range.channel, std::move(row));
    ++progress.samples;
  }
}

GapTable::Progress GapTable::on_response(const HistoryRequest& request, HistoryResponse response,
                                         Instant now) {
  Progress progress;
  Bus& bus = buses_[request.bus];
  const HistoryOutcome outcome = response.outcome;
  if (outcome == HistoryOutcome::kBusy || outcome == HistoryOutcome::kFailed ||
      (outcome == HistoryOutcome::kRows && response.rows.empty() && response.complete == 0)) {
    on_failure(request.bus, now);
    return progress;
  }
  bus.rest = {};
  const bool is_refused = outcome != HistoryOutcome::kRows;
  if (is_refused) progress.refusal = response.reason;
  accept(request, std::move(response.rows), bus, progress);
  for (std::size_t i = 0; i < request.channels.size(); ++i) {
    const HistoryRange& range = request.channels[i];
    const std::string path = path_of(request.bus, range);
    const auto channel = bus.channels.find(path);
    if (channel == bus.channels.end()) continue;
    const auto open = channel->second.find(range.until);
    if (open == channel->second.end()) continue;
    const SampleNumber after = open->second.after;
    const bool has_ended = i < response.complete;
    const bool is_closed = is_refused || is_filled(after, range.until) ||
                           (has_ended && now - open->second.found >= kPatience);
    if (has_ended && !is_closed) open->second.due = now + kSettle;
    if (is_closed || after != range.after)
      progress.changes.push_back({{path, after, range.until, open->second.since}, is_closed});
    if (is_closed) close(bus, path, range.until);
  }
  if (bus.channels.empty()) buses_.erase(request.bus);
  return progress;
}

void GapTable::on_failure(const std::string& bus, Instant now) {
  const auto found = buses_.find(bus);
  if (found == buses_.end()) return;
  Bus& of = found->second;
  of.rest = of.rest == Duration{} ? kRest : std::min(2 * of.rest, kMostRest);
  of.due = now + of.rest;
}

}  // namespace fieldcast
