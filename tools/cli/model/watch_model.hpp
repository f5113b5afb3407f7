// Announced channels and reported devices, as far as received; a device may have no channel. Pure.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "bridge/station/station.hpp"
#include "core/base/time.hpp"
#include "core/model/channel_pattern.hpp"

namespace fieldcast::cli {

class Catalogue {
 public:
  void add(const StationChannel& channel);
  bool add_device(const std::string& bus, const std::string& device);
  // No bridge of this site was found: its buses are unknown even if their names are correct.
  void add_silent_site(std::string site) { silent_sites_.insert(std::move(site)); }
  void remove(const ChannelPath& path) { channels_.erase(path); }

  [[nodiscard]] const StationChannel* find(const ChannelPath& path) const;
  [[nodiscard]] const std::map<ChannelPath, StationChannel>& channels() const { return channels_; }
  [[nodiscard]] bool has_device(const std::string& bus, const std::string& device) const;
  [[nodiscard]] bool has_bus(const std::string& bus) const;
  [[nodiscard]] bool empty() const { return devices_.empty(); }  // no bridge has reported
  [[nodiscard]] std::size_t count(const Pattern& pattern) const;

  // Returns a matching pattern at device or channel level ("*/*/voltage" for "voltage"), or an
  // empty text.
  [[nodiscard]] std::string meant_further_down(const Pattern& pattern) const;

  // Explains which part of the path is unknown, and suggests the closest name.
  [[nodiscard]] std::string explain_unknown(const ChannelPath& path) const;

 private:
  std::map<ChannelPath, StationChannel> channels_;
  std::set<std::pair<std::string, std::string>> devices_;  // (bus, device)
  std::set<std::string> silent_sites_;
};

// Measured over two seconds.
class RateMeter {
 public:
  void count(Instant now);
  [[nodiscard]] double rate(Instant now) const;

 private:
  static constexpr Duration kWindow = std::chrono::seconds{2};
  std::optional<Instant> began_;
  std::uint64_t counted_ = 0;
  double last_ = 0;
};

// Newest sample and rate of each matching channel, for `fieldcast watch`. Pure.
class WatchModel {
 public:
  // further channels are not shown, but their samples are counted
  static constexpr std::size_t kMaxChannels = 200'000;

  struct Row {
    StationSample sample;  // NOT_YET_READ before the first sample
    RateMeter rate;
    bool gone = false;  // removed, or its bridge has left
  };

  explicit WatchModel(Pattern pattern) : pattern_(std::move(pattern)) {}

  void on_channel(const StationChannel& channel);
  bool on_sample(const StationSample& sample, Instant now);
  // Returns true if this is new and the channel is shown.
  bool on_gone(const ChannelPath& path);
  void on_counters(const Station::BlockCounters& counters) { counters_ = counters; }

  [[nodiscard]] const Pattern& pattern() const { return pattern_; }
  [[nodiscard]] const Catalogue& catalogue() const { return catalogue_; }  // the matching channels
  // For a pattern without a match: the probably intended one, or an empty text.
  [[nodiscard]] std::string meant() const { return others_.meant_further_down(pattern_); }
  [[nodiscard]] const std::map<ChannelPath, Row>& rows() const { return rows_; }
  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  [[nodiscard]] double rate(Instant now) const { return rate_.rate(now); }
  [[nodiscard]] bool is_gone(const ChannelPath& path) const;
  [[nodiscard]] std::size_t good() const;
  [[nodiscard]] std::size_t sampled() const;  // channels with at least one sample
  // A bridge exists, with or without channels.
  [[nodiscard]] bool anything_announced() const { return announced_; }
  // Announced channels with a refresh but no sample yet; `interested`: also those without one.
  [[nodiscard]] std::size_t awaited(bool interested = false) const;

  // Explains why an interest at this refresh has no effect for some channels. Call it after the
  // bridges had time to receive it.
  [[nodiscard]] std::optional<std::string> interest_remark(Duration refresh) const;

  [[nodiscard]] const Station::BlockCounters& counters() const { return counters_; }
  // Explains that this station is too slow, and its losses; empty if it is fast enough.
  [[nodiscard]] std::optional<std::string> lag_remark() const;

  [[nodiscard]] std::string summary() const;

 private:
  Row* row(const ChannelPath& path);

  Pattern pattern_;
  Catalogue catalogue_;
  Catalogue others_;  // channels announced before the first match, for meant()
  std::map<ChannelPath, Row> rows_;
  RateMeter rate_;
  std::uint64_t samples_ = 0;
  bool announced_ = false;
  Station::BlockCounters counters_;
};

}  // namespace fieldcast::cli
