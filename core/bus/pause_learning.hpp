// Whether a device needs a rest after its answers: some are deaf while they tidy up. Requests are
// sorted by how long after an answer of the same device they came. Where those of one length often
// go unanswered and all longer ones are answered, the pause becomes as long as they are. Pure
// value, owned by the DeviceMonitor, on the bus's thread. Nothing can fail.
//
// Steps are a third to a half apart: a learned pause is hardly ever more than twice what is needed.
// A retry comes after a longer rest than its request. So retries show how longer rests do, and a
// pause is found even on a bus that never rests.
#pragma once

#include <algorithm>
#include <array>

#include "core/base/time.hpp"

namespace fieldcast {

class PauseLearning {
 public:
  static constexpr std::array<Duration, 14> kPauses{
      std::chrono::milliseconds{2},   std::chrono::milliseconds{5},
      std::chrono::milliseconds{10},  std::chrono::milliseconds{20},
      std::chrono::milliseconds{35},  std::chrono::milliseconds{50},
      std::chrono::milliseconds{75},  std::chrono::milliseconds{100},
      std::chrono::milliseconds{150}, std::chrono::milliseconds{200},
      std::chrono::milliseconds{300}, std::chrono::milliseconds{500},
      std::chrono::milliseconds{700}, std::chrono::milliseconds{1000}};

  // A request that began `rest` after the device's last answer was answered, or met silence.
  void tried(Duration rest, bool answered) {
    const auto at = std::upper_bound(kPauses.begin(), kPauses.end(), rest) - kPauses.begin();
    shares_[static_cast<std::size_t>(at)].count(answered);
    Share longer;  // rests longer than the step that is examined
    for (std::size_t i = kPauses.size(); i > step_; --i) {
      longer.add(shares_[i]);
      const Share& share = shares_[i - 1];
      if (share.tries < kFewest || share.failures < kOften) continue;
      if (longer.tries < kFewest || longer.failures > kSeldom) return;
      step_ = i;
      shares_ = {};
      return;
    }
  }
  void forget() { *this = {}; }

  [[nodiscard]] Duration pause() const { return step_ == 0 ? Duration{} : kPauses[step_ - 1]; }

 private:
  static constexpr unsigned kFewest = 12;  // tries of each kind before anything is concluded
  static constexpr unsigned kMemory = 32;  // tries that a share follows
  static constexpr double kOften = 0.5, kSeldom = 0.05;  // shares of failures
  struct Share {
    unsigned tries = 0;
    double failures = 0;
    void count(bool answered) {
      ++tries;
      const double weight = 1.0 / std::min(tries, kMemory);
      failures += ((answered ? 0.0 : 1.0) - failures) * weight;
    }
    void add(const Share& other) {
      if (other.tries == 0) return;
      failures = (failures * tries + other.failures * other.tries) / (tries + other.tries);
      tries += other.tries;
    }
  };
  // Of rests shorter than each pause; the last one: of longer rests.
  std::array<Share, kPauses.size() + 1> shares_{};
  std::size_t step_ = 0;
};

}  // namespace fieldcast
