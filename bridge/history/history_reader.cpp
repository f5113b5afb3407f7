#include "bridge/history/history_reader.hpp"

#include <algorithm>
#include <utility>

#include "bridge/store/tiers/epoch_table.hpp"

namespace fieldcast {

namespace {

constexpr std::size_t kRowBytes = 48;
// Of the first look back for the sample after which a range begins; it grows by the factor.
constexpr Duration kFirstLook = std::chrono::minutes{1};
constexpr int kLookFactor = 4;
// No sample is missed if the clock was set back by at most this within the epoch.
constexpr Duration kLargestStep = std::chrono::minutes{10};

UtcTime as_time(std::uint64_t epoch) { return {static_cast<std::int64_t>(epoch)}; }

}  // namespace

SampleTable::Span span_of(const HistoryRange& range, UtcTime until,
                          const std::vector<std::uint64_t>& epochs) {
  SampleTable::Span span{.from = range.since, .to = until, .after = range.after.sequence};
  if (range.after.epoch != 0) {
    span.from = std::max(range.since, as_time(range.after.epoch));
    span.after_until = end_of_epoch(epochs, range.after.epoch);
  } else {
    span.after_until = {saturated_sum(range.since.nanoseconds, 1)};
  }
  if (range.until.epoch != 0) {
    span.to = std::min(until, end_of_epoch(epochs, range.until.epoch));
    span.before_from = as_time(range.until.epoch);
    span.before = range.until.sequence;
  }
  return span;
}

// A range that begins after a sample would otherwise be read from the begin of its epoch, which may
// be months ago. Sequences increase with the time of publication, so looks further and further back
// from the end find a later begin. After the clock was set back, later samples have earlier times.
UtcTime HistoryReader::begin_of(std::int64_t channel, const SampleTable::Span& span, UtcTime now) {
  const UtcTime end = std::min({span.to, span.after_until, now});
  for (Duration look = kFirstLook;; look *= kLookFactor) {
    const UtcTime begin{saturated_difference(end.nanoseconds, look.count())};
    if (begin <= span.from || look > Duration::max() / kLookFactor) return span.from;
    const auto first = samples_.first(channel, begin, end);
    if (first && first->sequence <= span.after)
      return std::max(span.from, {saturated_difference(begin.nanoseconds, kLargestStep.count())});
  }
}

HistoryResponse HistoryReader::read(const HistoryRequest& request, UtcTime now) {
  HistoryResponse response;
  const auto epochs = EpochTable(connection_).epochs(request.bus);
  std::size_t bytes = 0;
  bool is_full = false;
  for (const HistoryRange& range : request.channels) {
    const auto channel = samples_.find({request.bus, range.device, range.channel});
    if (!channel) {
      ++response.complete;
      continue;
    }
    SampleTable::Span span = span_of(range, request.until, epochs);
    if (range.after.epoch != 0) span.from = begin_of(channel->id, span, now);
    // One more, to detect the end.
    const auto limit = static_cast<std::int64_t>(request.rows - response.rows.size()) + 1;
    const auto index = static_cast<std::uint32_t>(&range - request.channels.data());
    samples_.between(channel->id, span, limit, [&](StoredSample& sample) {
      const auto* text = std::get_if<std::string>(&sample.value);
      bytes += kRowBytes + (text == nullptr ? 0 : text->size());
      is_full =
          response.rows.size() == request.rows || (bytes > kMostBytes && !response.rows.empty());
      if (is_full) return false;
      response.rows.push_back({.channel = index,
                               .number = {epoch_at(epochs, sample.published_at), sample.sequence},
                               .published_at = sample.published_at,
                               .acquired_at = sample.acquired_at,
                               .value = std::move(sample.value),
                               .quality = sample.quality,
                               .device_code = sample.device_code});
      return true;
    });
    if (is_full) return response;
    ++response.complete;
  }
  return response;
}

}  // namespace fieldcast
