// Key for looking up a channel path without allocation. Pure values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/station/model/live_objects.hpp"

namespace fieldcast::web {

struct PathView {
  PathView(std::string_view of_bus, std::string_view of_device, std::string_view of_channel)
      : bus(of_bus), device(of_device), channel(of_channel) {}
  PathView(const ChannelPath& path)  // NOLINT: a path is a view of itself
      : bus(path.bus), device(path.device), channel(path.channel) {}

  [[nodiscard]] ChannelPath owned() const {
    return {std::string(bus), std::string(device), std::string(channel)};
  }

  std::string_view bus, device, channel;
};

struct PathHash {
  using is_transparent = void;
  std::size_t operator()(const PathView& path) const {
    const std::hash<std::string_view> hash;
    return (hash(path.bus) * 31 + hash(path.device)) * 31 + hash(path.channel);
  }
};

struct PathEqual {
  using is_transparent = void;
  bool operator()(const PathView& a, const PathView& b) const {
    return a.channel == b.channel && a.device == b.device && a.bus == b.bus;
  }
};

struct LiveValue {
  Value value;  // the last good value if the quality is bad
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  UtcTime acquired_at;         // 0: never acquired
  std::uint64_t sequence = 0;  // 0: no sample received
};

// From where a channel is received.
enum class Origin : std::uint8_t {
  kDds,
  kStream,  // of a site that is read from the stream: it cannot be written
};

struct LiveChannel {
  std::uint32_t id = 0;
  Origin origin = Origin::kDds;
  StationChannel channel;
  LiveValue last;
  Instant arrived{};             // arrival of the value at this station
  bool gone = false;             // no bridge announces it
  std::uint64_t version = 0;     // model version of the last change of the value
  std::uint64_t catalogued = 0;  // catalogue version of the last change of the entry
};

// Current state of the domain. Pure; used on the io thread. Pointers and references are valid until
// the next non-const call.
//
// A channel that no bridge announces keeps its id for kRemembered and is then forgotten. Ids are
// never reused. A full model (kMaxChannels) forgets such channels earlier, or refuses and counts
// new ones.
//
// Changed channels are in a list, newest last: a client with version N gets the entries after N.
// The first catalogue version should be the start time, so that versions of a previous process are
// recognized.
class LiveModel {
 public:
  static constexpr std::size_t kMaxChannels = 200'000;

  explicit LiveModel(std::uint64_t first_version = 0, std::size_t max_channels = kMaxChannels)
      : max_channels_(max_channels), catalogue_version_(first_version), forgotten_(first_version) {}
  LiveModel(const LiveModel&) = delete;
  LiveModel& operator=(const LiveModel&) = delete;

  void on_channel(const StationChannel& channel, Origin origin = Origin::kDds);
  // Ignores a sample of a channel outside the catalogue. `now`: its arrival.
  void on_sample(const PathView& path, LiveValue value, Instant now);
  void on_sample(const StationSample& sample, Instant now = {});
  // A good value becomes uncertain.
  void on_gone(const PathView& path);
  // Good values of a site of the stream become uncertain: it was not heard for a while.
  void on_silent(const std::string& site);
  // Makes overdue good values uncertain and forgets at most kMostForgotten old channels. Call it
  // once a second. Returns the number of values that became uncertain.
  std::size_t expire(Instant now);
  static constexpr Duration kRemembered = std::chrono::seconds{60};
  static constexpr std::size_t kMostForgotten = 20'000;
  // A value is overdue after this many refreshes, and at least after this time for the transport.
  static constexpr int kPatienceRefreshes = 2;
  static constexpr Duration kPatience = std::chrono::seconds{2};
  // Of the stream: a forwarder gathers samples and may be reconnecting.
  static constexpr Duration kStreamPatience = std::chrono::seconds{30};
  void put(LiveObject object) { objects_.put(std::move(object)); }
  void remove(const LiveObject& object) { objects_.remove(object); }

  // Null if never announced or forgotten. The channel may have been removed.
  [[nodiscard]] const LiveChannel* find(const PathView& path) const;
  // Sorted by path, without removed channels. O(n log n).
  [[nodiscard]] std::vector<const LiveChannel*> channels() const;
  [[nodiscard]] std::size_t count() const { return rows_.size() - gone_; }
  [[nodiscard]] std::size_t remembered() const { return rows_.size(); }

  [[nodiscard]] std::uint64_t version() const { return version_; }
  // Channels with a value newer than `version`, oldest first.
  [[nodiscard]] std::vector<const LiveChannel*> changed_since(std::uint64_t version,
                                                              std::size_t limit) const;

  [[nodiscard]] std::uint64_t catalogue_version() const { return catalogue_version_; }
  struct CatalogueChange {
    bool full = false;  // all channels, because changes since `version` are no longer stored
    std::vector<const LiveChannel*> changed;  // oldest first
    std::vector<std::uint32_t> gone;
  };
  [[nodiscard]] CatalogueChange catalogue_since(std::uint64_t version) const;

  [[nodiscard]] const LiveObjects& objects() const { return objects_; }

  struct Counters {
    std::uint64_t samples = 0;  // samples that changed a channel
    std::uint64_t unknown = 0;  // samples of channels that were not announced
    std::uint64_t refused = 0;  // channels beyond the limit
    std::uint64_t forgotten = 0;
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Row {
    LiveChannel live;
    std::list<Row*>::iterator changed;  // in changed_ once it has a value, else its end()
    std::list<Row*>::iterator catalogued;
    std::optional<Instant> left;  // when expire() first found it removed
  };
  void touch_value(Row& row);
  void touch_catalogue(Row& row);
  [[nodiscard]] bool make_room();
  void forget(Row& row);

  const std::size_t max_channels_;
  std::unordered_map<ChannelPath, std::unique_ptr<Row>, PathHash, PathEqual> rows_;
  std::list<Row*> changed_;     // by version of the value
  std::list<Row*> catalogued_;  // by version of the catalogue
  std::size_t gone_ = 0;        // number in rows_
  std::uint32_t next_id_ = 1;
  std::uint64_t version_ = 0, catalogue_version_;
  std::uint64_t forgotten_;  // catalogue version of the newest forgotten row
  LiveObjects objects_;
  Counters counters_;
};

}  // namespace fieldcast::web
