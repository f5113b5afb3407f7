// Estimates a device's response time as TCP estimates round trips (RFC 6298), and the timeout from
// it. Plain value, owned by DeviceMonitor, on the bus's thread.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/time.hpp"
#include "core/protocol/protocol.hpp"

namespace fieldcast {

class ResponseTime {
 public:
  // `configured`: longest timeout. `allowance`: delays of the operating system and of adapters.
  ResponseTime(Duration configured, Duration allowance)
      : configured_(configured), allowance_(allowance) {}

  // `measured`: end of the request to the computed start of the response; negative counts as zero.
  void learn(Duration measured);
  // Adds a response that arrived after its timeout.
  void late(Duration measured);
  // Doubles the timeout until the next response.
  void timed_out();
  void forget();

  // At most the configured timeout, at least the longest recent response time.
  [[nodiscard]] Duration timeout() const;
  // Longest of at least the last kWindow responses, late responses included.
  [[nodiscard]] Duration longest() const { return std::max(longest_, longest_before_); }
  // Shortest recent response time. The earliest measurement is ignored, because it may be wrong.
  // Empty before enough responses, and on a line that does not keep its baud rate.
  [[nodiscard]] std::optional<Duration> earliest(Duration character) const {
    const Duration second = std::min(second_, second_before_);
    if (in_window_ + windows_ * kWindow < kWindow / 16 || second <= -character) return std::nullopt;
    return second;
  }
  // Returns true if the response began earlier than any response of this device so far: it belongs
  // to another request.
  [[nodiscard]] bool too_early(Duration measured, Duration character) const {
    return measured < -2 * character && earliest(character);
  }
  // Almost every response takes at most this time. While few responses are known, the longest one
  // with `margin`.
  [[nodiscard]] Duration usual(Duration margin) const {
    if (in_window_ + windows_ * kWindow < kWindow / 4) return longest() + margin;
    return std::min(longest(), mean_ + 4 * spread_);
  }
  [[nodiscard]] Duration mean() const { return mean_; }  // zero before the first response
  [[nodiscard]] Duration spread() const { return spread_; }
  [[nodiscard]] bool known() const { return known_; }

 private:
  static constexpr unsigned kWindow = 256;  // responses per window; extremes cover two windows
  void measure(Duration measured);

  Duration configured_;
  Duration allowance_;
  Duration mean_{};
  Duration spread_{};
  bool known_ = false;
  unsigned doublings_ = 0;
  unsigned in_window_ = 0, windows_ = 0;
  Duration longest_{}, longest_before_{};
  Duration soonest_ = Duration::max();
  Duration second_ = Duration::max(), second_before_ = Duration::max();  // second earliest response
};

// Learns the pause that a device needs after its responses: some cannot receive for a while.
// Requests are classified by the time since the device's last response. If requests after a short
// rest often fail and all after longer rests succeed, the pause becomes that long. Steps are a
// third to a half apart, so it rarely exceeds twice the need. A retry follows a longer rest than
// its request, so the pause is found even on a fully loaded bus.
//
// Retries of a device that fails now and then look the same. So a learned pause is tested after
// some responses, with a shorter rest for some requests. If they succeed, the pause becomes that
// short and a greater step is tested. The second request without a response fails the test. After a
// request without a response the whole pause is kept for a while. Tests of a needed pause become
// ever rarer. Pure value, owned by DeviceMonitor, on the bus's thread.
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
  void tried(Duration rest, bool responded);
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
    void count(bool responded);
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
  void shorten(std::size_t step, bool responded);
  void begin_trial(std::size_t less);
  void end_trial(bool held);

  // For rests shorter than each pause; the last one is for longer rests.
  std::array<Share, kPauses.size() + 1> shares_{};
  std::size_t step_ = 0;
  std::optional<Trial> trial_;
  unsigned whole_pauses_ = 0;  // responses before the test continues
  unsigned responses_ = 0;     // since the last test
  unsigned next_trial_ = kFirstTrial;
};

// Learns from refusals the longest block that one area of a device accepts, and gaps that no block
// may bridge. The scheduler halves a refused block until each bad address is isolated. If smaller
// blocks read every point, the device refused a gap, or, if no item was left out, the length. Pure
// value, owned by ReadPath, on the bus's thread.
class BlockLearning {
 public:
  static constexpr std::size_t kMostOpen = 16;
  static constexpr std::size_t kMostGaps = 64;
  static constexpr Duration kRemember = std::chrono::hours{1};

  // `wanted`: points read by the refused block.
  void refused(const Range& block, std::vector<Range> wanted);
  // Closes the searches that contain this point: a single refused point explains them.
  void bad(const Range& point);
  // Returns true if the longest block changed.
  bool read(const Range& block, Instant now);
  bool expire(Instant now);
  // The device may have been replaced. Returns true if the longest block was known.
  bool forget();

  [[nodiscard]] std::uint32_t largest_read() const { return largest_; }
  // Longest accepted block in items, once a longer one was refused; 0 if unknown.
  [[nodiscard]] std::uint32_t longest() const { return longest_; }
  [[nodiscard]] const std::vector<Range>& gaps() const { return gaps_; }

 private:
  struct Search {
    Range block;
    std::vector<Range> wanted;
    std::vector<bool> seen;  // items of the block that were read
  };
  [[nodiscard]] bool conclude(const Search& search, Instant now);
  void note_gap(const Range& gap);

  std::vector<Search> open_;
  std::vector<Range> gaps_;
  std::uint32_t largest_ = 0, longest_ = 0;
  Instant learned_ = kLongAgo;
};

}  // namespace fieldcast
