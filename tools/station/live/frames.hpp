#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/time.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

class LiveSubscription {
 public:
  static constexpr std::size_t kMaxPatterns = 16;

  // Returns true if further channels may match now. REQUIRES: has_room().
  bool add(const Pattern& pattern);
  bool remove(const Pattern& pattern);
  [[nodiscard]] bool has(const Pattern& pattern) const {
    return patterns_.contains(pattern.text());
  }
  [[nodiscard]] bool has_room() const { return patterns_.size() < kMaxPatterns; }
  [[nodiscard]] bool empty() const { return patterns_.empty(); }

  [[nodiscard]] bool matches(const StationChannel& channel) const;
  // Equal for clients with the same patterns.
  [[nodiscard]] const std::string& key() const { return key_; }

 private:
  static constexpr const char* kEverything = "*/*/*";
  void make_key();

  std::map<std::string, Pattern> patterns_;
  std::string key_;
};

// Merges the clients' interests: each pattern has the shortest requested refresh on DDS and is
// withdrawn with its last client. Pure; on the io thread.
class ClientInterests {
 public:
  static constexpr std::size_t kMaxPatterns = 1024;

  // Called at each change with the new refresh; 0: withdrawn.
  using Declare = std::function<void(const std::string& pattern, Duration refresh)>;
  explicit ClientInterests(Declare declare) : declare_(std::move(declare)) {}

  [[nodiscard]] bool add(const std::string& pattern, Duration refresh);
  // REQUIRES: add() succeeded with this refresh.
  void remove(const std::string& pattern, Duration refresh);

  [[nodiscard]] std::size_t count() const { return wished_.size(); }

 private:
  const Declare declare_;
  std::map<std::string, std::multiset<Duration>> wished_;
};

inline constexpr std::uint32_t kNoAge = 0xFFFFFFFF;  // never acquired, or more than 49 days ago
inline constexpr std::size_t kFrameHeader = 16;      // bytes
inline constexpr std::size_t kFrameRow = 17;         // bytes of one channel

using Channels = std::vector<const LiveChannel*>;

[[nodiscard]] bool needs_text(const Value& value);

// Encodes channel values as frames of /live. Pure functions.
//
//     binary, little-endian    u8 1 | u8 0 | u16 0 | u32 n | f64 base_ms | f64 value[n] | u32 id[n]
//                              | u32 age_ms[n] | u8 quality[n]
//     text                     {"kind":"values", "id":[], "value":[texts], "acquired_ms":[],
//                              "quality":[]}
//
// A value was acquired at base_ms - age_ms (Unix milliseconds). Its quality is the number of the
// topic's enumerator. A bool is 0 or 1. NaN means never acquired, or a value in the text message: a
// string, or an integer beyond 2^53.
// `channels` may be empty; the frame then reports no change.
[[nodiscard]] std::string binary_frame(const Channels& channels);
// Returns an empty text if no channel needs it.
[[nodiscard]] std::string values_message(const Channels& channels);

struct LiveFrame {
  std::shared_ptr<const std::string> binary;
  std::shared_ptr<const std::string> texts;  // null: none
  std::size_t channels = 0;
  std::uint64_t version = 0;  // version of the model that the client has after this frame
};

// Caches frames of /live for clients with the same channels and version. Pure; on the io thread.
class FrameCache {
 public:
  // Channels of one frame: 278 kB. The rest is sent in the next frame.
  static constexpr std::size_t kMaxChannels = 16'384;
  static constexpr Duration kLife = std::chrono::milliseconds{4};

  explicit FrameCache(const LiveModel& model) : model_(model) {}

  [[nodiscard]] LiveFrame frame(std::uint64_t version, const LiveSubscription& subscription,
                                Instant now);

  // Drops expired frames. Call it once a second.
  void expire(Instant now);
  [[nodiscard]] std::size_t kept() const { return kept_.size(); }

  struct Counters {
    std::uint64_t asked = 0;
    std::uint64_t encoded = 0;
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  const LiveModel& model_;
  std::map<std::pair<std::uint64_t, std::string>, LiveFrame> kept_;
  Instant oldest_{};
  Counters counters_;
};

}  // namespace fieldcast::web
