// Whether a device needs a rest after its answers: some are deaf while they tidy up. Requests that come soon after an answer of the
// same device are compared with those that come later; only when the soon ones alone go unanswered, a pause is learned. Pure value,
// owned by the bus engine.
#pragma once

#include <array>

#include "core/base/time.hpp"

namespace fieldcast {

class PauseLearning {
 public:
  static constexpr std::array<Duration, 4> kPauses{std::chrono::milliseconds{2}, std::chrono::milliseconds{5},
                                                   std::chrono::milliseconds{10}, std::chrono::milliseconds{20}};

  // A request that began `rest` after the device's last answer was answered, or met silence.
  void tried(Duration rest, bool answered) {
    (rest <= kPauses.back() ? soon_ : later_).count(answered);
    if (step_ == kPauses.size() || soon_.tries < kFewest || later_.tries < kFewest) return;
    if (soon_.failures < kOften || later_.failures > kSeldom) return;
    ++step_;
    soon_ = {};
  }
  void forget() { *this = {}; }

  [[nodiscard]] Duration pause() const { return step_ == 0 ? Duration{} : kPauses[step_ - 1]; }

 private:
  static constexpr unsigned kFewest = 8;                   // tries of each kind before anything is concluded
  static constexpr double kOften = 0.25, kSeldom = 0.05;  // shares of failures
  struct Share {
    unsigned tries = 0;
    double failures = 0;
    void count(bool answered) {
      ++tries;
      const double weight = tries < 16 ? 1.0 / tries : 1.0 / 16;
      failures += ((answered ? 0.0 : 1.0) - failures) * weight;
    }
  };
  Share soon_, later_;
  std::size_t step_ = 0;
};

}  // namespace fieldcast
