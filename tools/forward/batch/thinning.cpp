#include "tools/forward/batch/thinning.hpp"

#include <algorithm>

namespace fieldcast::forward {

std::size_t Thinning::thin(SampleBatch& batch) {
  constexpr std::int64_t kMinute = 60'000'000'000;
  if (minutes_.size() > kMaxChannels) minutes_.clear();
  // The catalogue identifies the device, too. After a change of the catalogue, a channel may keep
  // one sample more.
  const std::size_t before = batch.samples.size();
  const auto removed =
      std::remove_if(batch.samples.begin(), batch.samples.end(), [&](const BatchSample& sample) {
        const std::int64_t minute = sample.acquired_at.nanoseconds / kMinute;
        const std::uint64_t channel = (batch.catalogue + sample.channel) * 0x9E3779B97F4A7C15;
        const auto [kept, is_new] = minutes_.try_emplace(channel, minute);
        if (is_new) return false;
        if (kept->second == minute) return true;
        kept->second = minute;
        return false;
      });
  batch.samples.erase(removed, batch.samples.end());
  return before - batch.samples.size();
}

}  // namespace fieldcast::forward
