// What `fieldcast watch` knows: the newest sample of each channel that its pattern matches, and how
// often they come. Pure: time comes in.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "bridge/station/station.hpp"
#include "core/base/time.hpp"
#include "core/model/pattern.hpp"
#include "tools/cli/model/catalogue.hpp"

namespace fieldcast::cli {

// Samples in each second, over windows of two.
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

class WatchModel {
 public:
  static constexpr std::size_t kMaxChannels = 200'000;  // more are not shown, but counted

  struct Row {
    StationSample sample;  // NOT_YET_READ until one came
    RateMeter rate;
    bool gone = false;  // its bridge removed it, or is gone
  };

  explicit WatchModel(Pattern pattern) : pattern_(std::move(pattern)) {}

  void on_channel(const StationChannel& channel);
  // False when the pattern does not match: nothing is kept.
  bool on_sample(const StationSample& sample, Instant now);
  void on_gone(const ChannelPath& path);
  // What the station counted so far.
  void on_counters(const Station::BlockCounters& counters) { counters_ = counters; }

  [[nodiscard]] const Pattern& pattern() const { return pattern_; }
  [[nodiscard]] const Catalogue& catalogue() const { return catalogue_; }  // the matching channels
  // Of a pattern that matches nothing: the one that was probably meant, or an empty text.
  [[nodiscard]] std::string meant() const { return others_.meant_further_down(pattern_); }
  [[nodiscard]] const std::map<ChannelPath, Row>& rows() const { return rows_; }
  [[nodiscard]] std::uint64_t samples() const { return samples_; }
  [[nodiscard]] double rate(Instant now) const { return rate_.rate(now); }
  [[nodiscard]] std::size_t good() const;
  [[nodiscard]] std::size_t sampled() const;  // channels of which at least one sample came
  // A bridge is there, with channels or without.
  [[nodiscard]] bool anything_announced() const { return announced_; }
  // Announced channels that promise samples and of which no real one came yet; with an interest of
  // ours every one of them promises.
  [[nodiscard]] std::size_t awaited(bool interested = false) const;

  // A remark about our interest at this refresh, once the bridges had time to read it: why it
  // changes nothing for some channels, or for any. Nothing: it holds for all.
  [[nodiscard]] std::optional<std::string> interest_remark(Duration refresh) const;

  [[nodiscard]] const Station::BlockCounters& counters() const { return counters_; }
  // That this station is slower than the bridges, and what it lost by that. Nothing: it keeps up.
  [[nodiscard]] std::optional<std::string> lag_remark() const;

  // "1234 samples of 100 channels, 98 of them GOOD"
  [[nodiscard]] std::string summary() const;

 private:
  Row* row(const ChannelPath& path);

  Pattern pattern_;
  Catalogue catalogue_;
  Catalogue others_;  // announced before the first that matches, to tell what was meant
  std::map<ChannelPath, Row> rows_;
  RateMeter rate_;
  std::uint64_t samples_ = 0;
  bool announced_ = false;
  Station::BlockCounters counters_;
};

}  // namespace fieldcast::cli
