#include "bridge/dds/topics/history.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "bridge/dds/topics/block.hpp"
#include "bridge/dds/topics/columns.hpp"
#include "bridge/dds/topics/conversion.hpp"

namespace fieldcast {

namespace {

constexpr std::size_t kHistoryRequester = 128, kHistoryReason = 256;
// Bytes of a block without rows, and of a row in all columns except texts.
constexpr std::size_t kEmptyHistory = 512, kHistoryRow = 48, kHistoryText = 8;

bool is_time(std::int64_t nanoseconds) { return nanoseconds >= 0; }

void clear_rows(idl::HistoryBlock& block) {
  clear_columns(block);
  block.published_at().clear();
  block.epochs().clear();
}

void add_row(const HistoryRow& row, const LastValue& value, idl::HistoryBlock& block) {
  add_columns(row.channel, value, block);
  block.published_at().push_back(row.published_at.nanoseconds);
  block.epochs().push_back(row.number.epoch);
}

bool has_whole_rows(const idl::HistoryBlock& block) {
  const std::size_t rows = block.channels().size();
  const auto fits = [rows](const auto& column) { return column.size() == rows; };
  return has_whole_columns(block) && fits(block.acquired_at()) && fits(block.published_at()) &&
         fits(block.epochs());
}

std::optional<HistoryRow> row_of(const idl::HistoryBlock& block, std::size_t row) {
  HistoryRow out{.channel = block.channels()[row],
                 .number = {block.epochs()[row], block.sequences()[row]},
                 .published_at = {block.published_at()[row]},
                 .acquired_at = {block.acquired_at()[row]}};
  if (!read_columns(block, row, out)) return std::nullopt;
  return out;
}

}  // namespace

void to_idl(const HistoryRequest& request, idl::HistoryRequest& out) {
  out.requester() = cut_text(request.requester, kHistoryRequester);
  out.request_id(request.request_id);
  out.bus() = cut_text(request.bus, kMaxNameLength);
  out.until(request.until.nanoseconds);
  out.rows(request.rows);
  out.channels().clear();
  for (const HistoryRange& range : request.channels) {
    idl::HistoryChannel channel;
    channel.device() = cut_text(range.device, kMaxNameLength);
    channel.channel() = cut_text(range.channel, kMaxNameLength);
    channel.since(range.since.nanoseconds);
    channel.epoch(range.after.epoch);
    channel.sequence(range.after.sequence);
    channel.until_epoch(range.until.epoch);
    channel.until_sequence(range.until.sequence);
    out.channels().push_back(std::move(channel));
  }
}

tl::expected<HistoryRequest, std::string> from_idl(const idl::HistoryRequest& in) {
  HistoryRequest out{.requester = in.requester().c_str(),
                     .request_id = in.request_id(),
                     .bus = in.bus().c_str(),
                     .until = {in.until()},
                     .rows = in.rows(),
                     .channels = {}};
  if (out.requester.empty()) return tl::unexpected<std::string>("the requester has no name");
  if (out.rows == 0 || out.rows > HistoryRequest::kMostRows)
    return tl::unexpected<std::string>("rows must be from 1 to 1024");
  if (in.channels().empty() || in.channels().size() > HistoryRequest::kMostChannels)
    return tl::unexpected<std::string>("a request must name from 1 to 128 channels");
  for (const idl::HistoryChannel& channel : in.channels()) {
    HistoryRange range{.device = channel.device().c_str(),
                       .channel = channel.channel().c_str(),
                       .since = {channel.since()},
                       .after = {channel.epoch(), channel.sequence()},
                       .until = {channel.until_epoch(), channel.until_sequence()}};
    constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    if (!is_time(channel.since()) || !is_time(in.until()) ||
        std::max({range.after.epoch, range.after.sequence, range.until.epoch,
                  range.until.sequence}) > kMost)
      return tl::unexpected<std::string>("times, epochs and sequences must be less than 2^63");
    out.channels.push_back(std::move(range));
  }
  return out;
}

void to_blocks(const HistoryRequest& request, const HistoryResponse& response,
               std::size_t most_bytes, idl::HistoryBlock& block,
               const std::function<void(idl::HistoryBlock& block)>& write) {
  block.requester() = cut_text(request.requester, kHistoryRequester);
  block.request_id(request.request_id);
  block.bus() = cut_text(request.bus, kMaxNameLength);
  block.outcome(static_cast<idl::HistoryOutcome>(response.outcome));
  block.reason() = cut_text(response.reason, kHistoryReason);
  block.complete(response.complete);
  block.part(0);
  block.last(false);
  clear_rows(block);
  std::size_t bytes = kEmptyHistory;
  LastValue value;
  for (const HistoryRow& row : response.rows) {
    value.quality = to_idl(row.quality);
    value.device_code = row.device_code;
    value.acquired_at = row.acquired_at.nanoseconds;
    value.sequence = row.number.sequence;
    to_last_value(row.value, value);
    const bool is_text = value.kind == idl::ValueKind::VALUE_STRING;
    const std::size_t needed = kHistoryRow + (is_text ? kHistoryText + value.text.size() : 0);
    if (!block.channels().empty() && bytes + needed > most_bytes) {
      write(block);
      block.part(block.part() + 1);
      clear_rows(block);
      bytes = kEmptyHistory;
    }
    bytes += needed;
    add_row(row, value, block);
  }
  block.last(true);
  write(block);
}

HistoryParts::Added HistoryParts::add(const idl::HistoryBlock& block) {
  if (block.part() != next_ || !has_whole_rows(block) || block.complete() > channels_ ||
      response_.rows.size() + block.channels().size() > rows_ ||
      block.outcome() > idl::HistoryOutcome::HISTORY_FAILED)
    return Added::kOther;
  for (std::size_t row = 0; row < block.channels().size(); ++row) {
    std::optional<HistoryRow> read = row_of(block, row);
    if (!read || read->channel >= channels_) return Added::kOther;
    response_.rows.push_back(*std::move(read));
  }
  ++next_;
  response_.outcome = static_cast<HistoryOutcome>(block.outcome());
  response_.reason = block.reason().c_str();
  response_.complete = block.complete();
  return block.last() ? Added::kWhole : Added::kMore;
}

}  // namespace fieldcast
