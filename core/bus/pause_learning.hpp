// Whether a device needs a rest after its answers: some are deaf while they tidy up. Requests are
// sorted by how long after an answer of the same device they came. Where those of one length often
// go unanswered and all longer ones are answered, the pause becomes as long as they are. Pure
// value, owned by the DeviceMonitor, on the bus's thread. Nothing can fail.
//
// Steps are a third to a half apart: a learned pause is hardly ever more than twice what is needed.
// A retry comes after a longer rest than its request. So retries show how longer rests do, and a
// pause is found even on a bus that never rests.
//
// Retries of a device that dies now and then look like that too. So a learned pause is put on trial
// after some answers: some requests come after a shorter rest, and if they are answered, the pause
// becomes that short and the next trial begins, with a greater step. A trial fails by its second
// request without an answer. After a request that failed, the whole pause is kept for a while. A
// pause that is needed is put on trial ever more rarely.
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
  // Answers before the pause is put on trial: at first, and at most. Each time twice as many.
  static constexpr unsigned kFirstTrial = 64, kRarestTrial = 8192;

  // A request that began `rest` after the device's last answer was answered, or met silence.
  void tried(Duration rest, bool answered);
  void forget() { *this = {}; }

  // What was learned.
  [[nodiscard]] Duration pause() const { return of_step(step_); }
  // Before the next request: the pause, or the shorter one that is on trial.
  [[nodiscard]] Duration next_pause() const {
    return of_step(trial_ && whole_pauses_ == 0 ? trial_->step : step_);
  }

 private:
  static constexpr unsigned kFewest = 12;  // tries of each kind before anything is concluded
  static constexpr unsigned kMemory = 32;  // tries that a share follows
  static constexpr double kOften = 0.5, kSeldom = 0.05;  // shares of failures
  static constexpr unsigned kAfterFailure = 8;  // answers after the whole pause, in a trial
  struct Share {
    unsigned tries = 0;
    double failures = 0;
    void count(bool answered);
    void add(const Share& other);
  };
  struct Trial {
    std::size_t step = 0;  // on trial
    std::size_t less = 1;  // than the pause in force, in steps
    unsigned tries = 0, failures = 0;
  };
  [[nodiscard]] static Duration of_step(std::size_t step) {
    return step == 0 ? Duration{} : kPauses[step - 1];
  }
  void lengthen();
  void shorten(std::size_t step, bool answered);
  void begin_trial(std::size_t less);
  void end_trial(bool held);

  // Of rests shorter than each pause; the last one: of longer rests.
  std::array<Share, kPauses.size() + 1> shares_{};
  std::size_t step_ = 0;
  std::optional<Trial> trial_;
  unsigned whole_pauses_ = 0;  // answers to come before the trial goes on
  unsigned answers_ = 0;       // since the last trial
  unsigned next_trial_ = kFirstTrial;
};

}  // namespace fieldcast
