// Collects samples and the catalogue of all devices, and makes batches of them. Removes samples
// that were accepted before: after a restart DDS delivers the last values again. Pure; one owner.
//
// A batch ends when its time has passed, when it has enough samples or texts, when the epoch of its
// bus changes, or when the device loses its last channel.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tools/backfill/gap_table.hpp"
#include "tools/forward/batch/sample_batch.hpp"

namespace fieldcast::forward {

struct GatherSpec {
  Duration time = std::chrono::seconds{1};  // from the first sample of a batch
  std::uint32_t samples = 1000;             // of one batch
  friend bool operator==(const GatherSpec&, const GatherSpec&) = default;
};

struct Gathered {
  // The catalogue of the batch, if it was not passed on since the start.
  std::optional<DeviceCatalogue> catalogue;
  SampleBatch batch;
  std::vector<NamedPosition> positions;  // of the batch's channels, after the batch
  std::vector<Gap> gaps;                 // before samples of the batch
  bool is_late = false;                  // fetched from a store
};

class Gatherer {
 public:
  // Samples that were not taken yet. Further samples are refused and counted.
  static constexpr std::size_t kMaxPending = 400'000;
  // Bytes of the text values of a batch, so that its message is smaller than 1 MiB in any form.
  static constexpr std::size_t kMaxTexts = 64 * 1024;
  // Further channels and their samples are ignored.
  static constexpr std::size_t kMaxChannels = 200'000;

  explicit Gatherer(const GatherSpec& spec) : spec_(spec) {}

  // Positions of an earlier run. Call before all others.
  void restore(const NamedPosition& position) { positions_[position.name] = position.position; }

  void on_channel(const StationChannel& channel);
  void on_channel_removed(const std::string& bus, const std::string& device,
                          const std::string& channel);
  void on_sample(const StationSample& sample, Instant now);

  // Makes a batch of samples that were fetched from a store. Ignores samples of channels that were
  // removed.
  void on_fetched(Fetched fetched);

  // Returns the batches that have ended; with `all`, also those that have not. A catalogue is with
  // the first batch that needs it.
  [[nodiscard]] std::vector<Gathered> take(Instant now, bool all = false);

  struct Counters {
    std::uint64_t accepted = 0;
    std::uint64_t repeated = 0;  // accepted before
    std::uint64_t refused = 0;   // beyond kMaxPending
    std::uint64_t unknown = 0;   // without a channel
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t devices() const { return devices_.size(); }
  // Whether a channel of the device is announced.
  [[nodiscard]] bool has(const std::string& bus, const std::string& device) const {
    return devices_.contains(bus + '/' + device);
  }
  // Whether a channel of the bus is announced.
  [[nodiscard]] bool has_bus(const std::string& bus) const;

 private:
  struct Channel {
    StationChannel entry;
    std::string path;
    Position* position = nullptr;
    bool removed = false;
  };
  struct Device {
    std::vector<Channel> channels;
    std::unordered_map<std::string, std::uint32_t> index;  // by the channel's name
    [[nodiscard]] std::optional<std::uint32_t> find(const std::string& channel) const;
    bool is_published = false;    // the present catalogue
    std::uint64_t catalogue = 0;  // its identity, if is_published
    SampleBatch pending;
    std::vector<Gap> gaps;  // before its samples
    std::size_t texts = 0;  // bytes of its text values
    Instant began{};        // arrival of the first pending sample
  };

  [[nodiscard]] Device* device_of(const std::string& bus, const std::string& device);
  void end_batch(Device& device);
  // Returns the batch, with the device's catalogue if that is not published yet.
  [[nodiscard]] Gathered gathered(Device& device, SampleBatch batch) const;

  const GatherSpec spec_;
  std::map<std::string, Device> devices_;  // by "bus/device"
  Device* last_ = nullptr;                 // of the last sample
  std::unordered_map<std::string, Position> positions_;
  std::vector<Gathered> ended_;
  std::size_t pending_ = 0;  // samples of all devices and of ended_
  Counters counters_;
};

}  // namespace fieldcast::forward
