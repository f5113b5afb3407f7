#include "tools/station/live/frame_cache.hpp"

#include <utility>

#include "tools/station/live/frame_writer.hpp"

namespace fieldcast::web {

void FrameCache::expire(Instant now) {
  if (!kept_.empty() && now - oldest_ > kLife) kept_.clear();
}

LiveFrame FrameCache::frame(std::uint64_t version, const LiveSubscription& subscription,
                            Instant now) {
  ++counters_.asked;
  expire(now);
  const std::pair key{version, subscription.key()};
  if (const auto found = kept_.find(key); found != kept_.end()) return found->second;

  Channels changed = model_.changed_since(version, kMaxChannels);
  LiveFrame frame;
  frame.version = changed.size() < kMaxChannels ? model_.version() : changed.back()->version;
  std::erase_if(
      changed, [&](const LiveChannel* channel) { return !subscription.matches(channel->channel); });
  frame.channels = changed.size();
  frame.binary = std::make_shared<const std::string>(binary_frame(changed));
  if (std::string texts = values_message(changed); !texts.empty())
    frame.texts = std::make_shared<const std::string>(std::move(texts));
  ++counters_.encoded;
  if (kept_.empty()) oldest_ = now;
  kept_.emplace(key, frame);
  return frame;
}

}  // namespace fieldcast::web
