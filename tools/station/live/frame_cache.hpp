// Caches frames of /live for clients with the same channels and version. Pure; on the io thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/base/time.hpp"
#include "tools/station/live/subscription.hpp"
#include "tools/station/model/live_model.hpp"

namespace fieldcast::web {

struct LiveFrame {
  std::shared_ptr<const std::string> binary;
  std::shared_ptr<const std::string> texts;  // null: none
  std::size_t channels = 0;
  std::uint64_t version = 0;  // version of the model that the client has after this frame
};

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
  // Cleared when the oldest frame expires.
  std::map<std::pair<std::uint64_t, std::string>, LiveFrame> kept_;
  Instant oldest_{};
  Counters counters_;
};

}  // namespace fieldcast::web
