// What a station knows of the domain at this moment: the newest value of each channel, and every
// bus, device, alarm, session, bridge and read plan. Pure: no clock, no lock, no DDS entity. One
// owner, on the io thread; pointers and references stay valid until the next call that is not
// const.
//
// A channel that no bridge announces any more keeps its id for kRemembered, then it is forgotten.
// An id is never given to another channel. Channels that changed stand in a list, each once, the
// newest at the end: a client that has seen everything up to a version gets what is newer.
// When it is full (kMaxChannels), channels that nobody announces any more are forgotten, the oldest
// first; if there are none, a new channel is refused and counted.
//
// Versions of the catalogue begin at a number that the owner chooses: with the time of the start,
// a version that another process gave is known as such.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "bridge/dds/topics/topic_values.hpp"
#include "core/model/channel_path.hpp"
#include "tools/station/live/live_objects.hpp"
#include "tools/station/live/path_key.hpp"

namespace fieldcast::web {

struct LiveValue {
  Value value;  // the last good one when the quality is bad
  Quality quality = Quality::kNotYetRead;
  std::uint16_t device_code = 0;
  UtcTime acquired_at;         // 0: never acquired
  std::uint64_t sequence = 0;  // 0: no sample came yet
};

struct LiveChannel {
  std::uint32_t id = 0;
  StationChannel channel;
  LiveValue last;
  Instant arrived{};             // of the value, at this station
  bool gone = false;             // no bridge announces it any more
  std::uint64_t version = 0;     // of the model, when the value changed last
  std::uint64_t catalogued = 0;  // version of the catalogue, when its entry changed last
};

class LiveModel {
 public:
  static constexpr std::size_t kMaxChannels = 200'000;

  explicit LiveModel(std::uint64_t first_version = 0, std::size_t max_channels = kMaxChannels)
      : max_channels_(max_channels), catalogue_version_(first_version), forgotten_(first_version) {}
  LiveModel(const LiveModel&) = delete;
  LiveModel& operator=(const LiveModel&) = delete;

  // ---- what came from the domain

  void on_channel(const StationChannel& channel);
  // A sample of a channel that is not in the catalogue is left out. `now`: when it arrived.
  void on_sample(const PathView& path, LiveValue value, Instant now);
  void on_sample(const StationSample& sample, Instant now = {});
  // Its bridge vanished, or does not have it any more: a good value is uncertain from now on.
  void on_gone(const PathView& path);
  // A good value is uncertain from now on when the next one is overdue: its bridge does not say so
  // any more. Also forgets channels that nobody has announced for kRemembered, at most
  // kMostForgotten of them, so that the thread is not held up. To be called once a second. Returns
  // how many values are uncertain from now on.
  std::size_t expire(Instant now);
  static constexpr Duration kRemembered = std::chrono::seconds{60};
  static constexpr std::size_t kMostForgotten = 20'000;
  // How far a refresh may be exceeded before that: by itself, and by the time that a message takes.
  static constexpr int kPatienceRefreshes = 2;
  static constexpr Duration kPatience = std::chrono::seconds{2};
  void on_bus_status(const StationBusStatus& status) { objects_.put(status); }
  void on_bus_gone(const std::string& bus) { objects_.remove_bus(bus); }
  void on_device_status(const StationDeviceStatus& status) { objects_.put(status); }
  void on_device_gone(const std::string& bus, const std::string& device) {
    objects_.remove_device(bus, device);
  }
  void on_alarm(const LiveAlarm& alarm) { objects_.put(alarm); }
  void on_alarm_gone(const LiveAlarm& alarm) { objects_.remove(alarm); }
  void on_session(const ProgramSessionReport& session) { objects_.put(session); }
  void on_bridge(const StationBridge& bridge) { objects_.put(bridge); }
  void on_bridge_gone(const std::string& bridge) { objects_.remove_bridge(bridge); }
  void on_read_plan(const StationReadPlan& plan) { objects_.put(plan); }
  void on_read_plan_gone(const std::string& bus) { objects_.remove_read_plan(bus); }

  // ---- channels

  // Null: never announced, or forgotten. It may be gone.
  [[nodiscard]] const LiveChannel* find(const PathView& path) const;
  // In the order of their paths; those that are gone are left out. Takes time n log n.
  [[nodiscard]] std::vector<const LiveChannel*> channels() const;
  [[nodiscard]] std::size_t count() const { return rows_.size() - gone_; }
  // With those that are gone and not forgotten yet.
  [[nodiscard]] std::size_t remembered() const { return rows_.size(); }

  // Grows with each value.
  [[nodiscard]] std::uint64_t version() const { return version_; }
  // Those with a value that is newer than `version`, the oldest first, at most `limit`.
  [[nodiscard]] std::vector<const LiveChannel*> changed_since(std::uint64_t version,
                                                              std::size_t limit) const;

  // Grows with each change of the catalogue.
  [[nodiscard]] std::uint64_t catalogue_version() const { return catalogue_version_; }
  struct CatalogueChange {
    bool full = false;  // everything, since what is older than `version` is not known any more
    std::vector<const LiveChannel*> changed;  // the oldest first
    std::vector<std::uint32_t> gone;
  };
  // Version 0: everything.
  [[nodiscard]] CatalogueChange catalogue_since(std::uint64_t version) const;

  // ---- everything else

  [[nodiscard]] const LiveObjects& objects() const { return objects_; }

  struct Counters {
    std::uint64_t samples = 0;  // that changed a channel
    std::uint64_t unknown = 0;  // samples of channels that were not announced
    std::uint64_t refused = 0;  // channels beyond the limit
    std::uint64_t forgotten = 0;
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Row {
    LiveChannel live;
    std::list<Row*>::iterator changed;  // in changed_, once it has a value; else its end()
    std::list<Row*>::iterator catalogued;
    std::optional<Instant> left;  // when expire() first found that it is gone
  };
  void touch_value(Row& row);
  void touch_catalogue(Row& row);
  // False: the model is full.
  [[nodiscard]] bool make_room();
  void forget(Row& row);

  const std::size_t max_channels_;
  std::unordered_map<ChannelPath, std::unique_ptr<Row>, PathHash, PathEqual> rows_;
  std::list<Row*> changed_;     // by version of the value
  std::list<Row*> catalogued_;  // by version of the catalogue
  std::size_t gone_ = 0;        // of rows_
  std::uint32_t next_id_ = 1;
  std::uint64_t version_ = 0, catalogue_version_;
  std::uint64_t forgotten_;  // version of the catalogue of the newest row that was forgotten
  LiveObjects objects_;
  Counters counters_;
};

}  // namespace fieldcast::web
