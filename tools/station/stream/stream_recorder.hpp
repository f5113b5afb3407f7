// Records samples of the stream in the store. The time of a good sample is that of its acquisition,
// so that a repeated or late sample gets the same row. Used by one thread. The store must outlive
// it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "bridge/store/store.hpp"
#include "bridge/store/tiers/late_table.hpp"
#include "tools/station/stream/received_sequences.hpp"
#include "tools/station/stream/stream_batch.hpp"

namespace fieldcast::web {

// The time of each sample in the store. A bad sample has none of its own: it gets the time directly
// before the next good sample of its channel in this batch. Without one, it gets the newest time of
// a good sample in the batch. Without any, it gets the time at which the server has stored the
// message, or for a late batch the newest time in it. An acquisition more
// than kMaxAhead after that is not believed.
inline constexpr Duration kMaxAhead = std::chrono::minutes{10};
[[nodiscard]] std::vector<UtcTime> stored_times(const StreamBatch& batch);

class StreamRecorder {
 public:
  // Further channels are ignored; their samples count as unknown.
  static constexpr std::size_t kMaxChannels = 200'000;

  explicit StreamRecorder(Store& store) : store_(store) {}
  StreamRecorder(const StreamRecorder&) = delete;
  StreamRecorder& operator=(const StreamRecorder&) = delete;

  // Returns the number of rows that were put into the queue of the store.
  std::size_t record(const StreamBatch& batch);

  // The late samples that were recorded since the last call.
  struct Late {
    std::string bus, device;
    LateRange range;
  };
  [[nodiscard]] std::vector<Late> take_late() { return std::exchange(late_, {}); }

  struct Counters {
    std::uint64_t recorded = 0;
    std::uint64_t repeated = 0;  // duplicates
    std::uint64_t unknown = 0;   // samples of channels beyond kMaxChannels
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Channel {
    std::optional<std::int64_t> number;  // in the store; empty: matches no pattern
    ReceivedSequences received;
  };
  struct Device {
    std::uint64_t catalogue = 0;
    std::vector<Channel*> by_index;  // null beyond kMaxChannels
    std::unordered_map<std::string, Channel> channels;
  };
  Device& device_of(const StreamBatch& batch);
  void add_late(const StreamBatch& batch, const std::vector<SampleRow>& rows);

  Store& store_;
  std::unordered_map<std::string, Device> devices_;  // by "SITE:BUS/DEVICE"
  std::size_t channels_ = 0;
  std::vector<Late> late_;  // at most one for each batch that was recorded since take_late()
  Counters counters_;
};

}  // namespace fieldcast::web
