// Content of HistoryRequest and HistoryBlock as plain values, without DDS types; any thread.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/cause.hpp"
#include "core/base/time.hpp"
#include "core/base/value.hpp"

namespace fieldcast {

// Number of a sample in its channel; ordered as the samples were published. Epoch 0: unknown.
struct SampleNumber {
  std::uint64_t epoch = 0;
  std::uint64_t sequence = 0;
  friend auto operator<=>(const SampleNumber&, const SampleNumber&) = default;
};

// The stored samples of a channel between two others.
struct HistoryRange {
  std::string device, channel;
  UtcTime since;       // published at or after this time
  SampleNumber after;  // epoch 0: only samples at the time `since` are compared, by the sequence
  SampleNumber until;  // the first sample that is not wanted; epoch 0: all are
  friend bool operator==(const HistoryRange&, const HistoryRange&) = default;
};

struct HistoryRequest {
  static constexpr std::uint32_t kMostRows = 1024;
  static constexpr std::size_t kMostChannels = 128;

  std::string requester;
  std::uint64_t request_id = 0;
  std::string bus;
  UtcTime until;  // only samples published before this time
  std::uint32_t rows = kMostRows;
  std::vector<HistoryRange> channels;
};

struct HistoryRow {
  std::uint32_t channel = 0;  // index in HistoryRequest::channels
  SampleNumber number;
  UtcTime published_at, acquired_at;
  Value value;
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  friend bool operator==(const HistoryRow&, const HistoryRow&) = default;
};

// As in the IDL, in this order.
enum class HistoryOutcome : std::uint8_t { kRows, kNoStore, kNotKept, kBusy, kInvalid, kFailed };

struct HistoryResponse {
  HistoryOutcome outcome = HistoryOutcome::kRows;
  std::string reason;          // one line; empty with kRows
  std::uint32_t complete = 0;  // the first so many requested channels have no further samples
  std::vector<HistoryRow> rows;
};

}  // namespace fieldcast
