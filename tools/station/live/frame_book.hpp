// Frames for the clients of /live, encoded once for all that want the same: the same channels, from
// the same version on, at about the same time. Pure; one owner, on the io thread.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/base/time.hpp"
#include "tools/station/live/live_model.hpp"
#include "tools/station/live/subscription.hpp"

namespace fieldcast::web {

struct LiveFrame {
  std::shared_ptr<const std::string> binary;
  std::shared_ptr<const std::string> texts;  // null: none
  std::size_t channels = 0;
  std::uint64_t version = 0;  // of the model, up to which it tells everything
};

class FrameBook {
 public:
  // Of one frame: 278 kB. What is beyond them comes with the next one.
  static constexpr std::size_t kMaxChannels = 16'384;
  // For so long a frame stands for all.
  static constexpr Duration kLife = std::chrono::milliseconds{4};

  explicit FrameBook(const LiveModel& model) : model_(model) {}

  // What changed since that version of the model.
  [[nodiscard]] LiveFrame frame(std::uint64_t version, const LiveSubscription& subscription,
                                Instant now);

  // Drops frames that are too old for every client. To be called once a second.
  void expire(Instant now);
  [[nodiscard]] std::size_t kept() const { return kept_.size(); }

  struct Counters {
    std::uint64_t asked = 0;
    std::uint64_t encoded = 0;
  };
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  const LiveModel& model_;
  // By version and subscription. Emptied when the first of them is too old: never more than clients
  // ask within kLife.
  std::map<std::pair<std::uint64_t, std::string>, LiveFrame> kept_;
  Instant oldest_{};
  Counters counters_;
};

}  // namespace fieldcast::web
