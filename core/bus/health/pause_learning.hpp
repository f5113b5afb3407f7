// Learns the pause that a device needs after its responses: some cannot receive for a while.
// Requests are classified by the time since the last response of the device. If requests after a
// short rest often fail and all after longer rests succeed, the pause becomes that long. Pure
// value, owned by DeviceMonitor, on the bus's thread.
//
// Steps are a third to a half apart: a learned pause rarely exceeds twice the need. A retry follows
// a longer rest than its request, so the pause is found even on a fully loaded bus.
//
// Retries of a device that fails now and then look the same. So a learned pause is tested after
// some responses: some requests follow a shorter rest. If they succeed, the pause becomes that
// short and a test with a greater step begins. The second request without a response fails the
// test. After a request without a response the whole pause is kept for a while. Tests of a needed
// pause become ever rarer.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

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
  // Responses before a test: at first, and at most. The number doubles each time.
  static constexpr unsigned kFirstTrial = 64, kRarestTrial = 8192;

  // `rest`: since the device's last response.
  void tried(Duration rest, bool answered);
  void forget() { *this = {}; }

  [[nodiscard]] Duration pause() const { return of_step(step_); }
  // The learned pause, or the shorter one in test.
  [[nodiscard]] Duration next_pause() const {
    return of_step(trial_ && whole_pauses_ == 0 ? trial_->step : step_);
  }

 private:
  static constexpr unsigned kFewest = 12;  // minimum tries of each kind for a conclusion
  static constexpr unsigned kMemory = 32;  // tries that a share averages
  static constexpr double kOften = 0.5, kSeldom = 0.05;  // shares of failures
  static constexpr unsigned kAfterFailure = 8;  // responses after the whole pause, in a test
  struct Share {
    unsigned tries = 0;
    double failures = 0;
    void count(bool answered);
    void add(const Share& other);
  };
  struct Trial {
    std::size_t step = 0;
    std::size_t less = 1;  // steps below the current pause
    unsigned tries = 0, failures = 0;
  };
  [[nodiscard]] static Duration of_step(std::size_t step) {
    return step == 0 ? Duration{} : kPauses[step - 1];
  }
  void lengthen();
  void shorten(std::size_t step, bool answered);
  void begin_trial(std::size_t less);
  void end_trial(bool held);

  // For rests shorter than each pause; the last one is for longer rests.
  std::array<Share, kPauses.size() + 1> shares_{};
  std::size_t step_ = 0;
  std::optional<Trial> trial_;
  unsigned whole_pauses_ = 0;  // responses before the test continues
  unsigned answers_ = 0;       // since the last test
  unsigned next_trial_ = kFirstTrial;
};

}  // namespace fieldcast
